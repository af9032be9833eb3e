#!/usr/bin/env bash
# Everything that `make check` runs, part by part; adds up the parts' closing counts.  tests/check.sh [PART...]
set -u
cd "$(dirname "$0")/.." || exit 1
unset MAKEFLAGS MAKELEVEL MFLAGS
jobs=$(nproc)
export TREELINE_CACHE="${TREELINE_CACHE:-$PWD/build/cache}"
passed=0 failed=0 skipped=0 failures=() running=()
mkdir -p build

# A part's log is build/check-NAME.log, its exit code and its seconds are in build/check-NAME.rc.
wanted() { [ ${#only[@]} -eq 0 ] || [[ " ${only[*]} " == *" $1 "* ]]; }
run() { # run NAME COMMAND...
  local name=$1 started
  shift
  started=$(date +%s)
  "$@" 2>&1 | tee "build/check-$name.log"
  echo "${PIPESTATUS[0]} $(($(date +%s) - started))" >"build/check-$name.rc"
}

quietly() { grep -v '^\(gcc\|clang\|g++\|clang++\) '; }

# tell NAME: its last line is "N passed, N failed, N skipped"; without it, its exit code counts.
tell() {
  local log=build/check-$1.log rc seconds last
  read -r rc seconds <"build/check-$1.rc"
  last=$(grep -E '^[0-9]+ passed, [0-9]+ failed, [0-9]+ skipped$' "$log" | tail -1)
  if [ -n "$last" ]; then
    read -r p _ f _ s _ <<<"${last//,/}"
  else
    p=0 f=0 s=0
  fi
  [ "$rc" -ne 0 ] && [ "$f" -eq 0 ] && f=1
  [ "$rc" -eq 0 ] && [ -z "$last" ] && p=1
  passed=$((passed + p)) failed=$((failed + f)) skipped=$((skipped + s))
  [ "$f" -gt 0 ] && failures+=("$1")
  printf '== %s: %d passed, %d failed, %d skipped (%d s)\n\n' "$1" "$p" "$f" "$s" "$seconds"
}

# part NAME COMMAND...: after what is before it, on all cores.
part() {
  wanted "$1" || return
  printf '== %s\n' "$1"
  run "$@" | quietly
  tell "$1"
}

# beside NAME COMMAND...: as many at once as there are cores, each of one process at a time; told by beside_tell.
beside() {
  wanted "$1" || return
  while [ "$(jobs -rp | wc -l)" -ge "$jobs" ]; do wait -n; done
  run "$@" >/dev/null &
  running+=("$1")
}
beside_tell() {
  wait
  for name in "${running[@]}"; do
    printf '== %s\n' "$name"
    quietly <"build/check-$name.log"
    tell "$name"
  done
  running=()
}

build() { make -s -j"$jobs" "$@"; }

only=("$@")
part gcc build all
part architecture tests/architecture.sh
part units make -s -j"$jobs" test
part clang build CC=clang config=sanitize all # the same warnings and errors at every level of optimization
part sanitize make -s -j"$jobs" CC=clang config=sanitize test
part threads make -s -j"$jobs" CC=clang config=thread test T="test_metrics test_reference test_reference_noise"
part egl make -s -j"$jobs" gl=egl test T="test_gl test_conform"
build all >/dev/null # ./treeline is the release again, whatever was built last
part fuzz make -s -j"$jobs" fuzz FUZZ_SECONDS=60
beside cli tests/cli.sh
beside page tests/page.sh
beside plugins tests/plugins.sh
beside smoke tests/smoke.sh
beside bad-input tests/bad_input.sh
beside documents tests/documents.sh
beside_tell
part conform tests/conform.sh

[ ${#failures[@]} -gt 0 ] && echo "failed parts: ${failures[*]}; their logs are build/check-PART.log"
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
