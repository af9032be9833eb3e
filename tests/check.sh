#!/usr/bin/env bash
# Everything that `make check` runs, part by part; adds up the parts' closing counts.  tests/check.sh [PART...]
set -u
cd "$(dirname "$0")/.." || exit 1
unset MAKEFLAGS MAKELEVEL MFLAGS
jobs=$(nproc)
export TREELINE_CACHE="${TREELINE_CACHE:-$PWD/build/cache}"
passed=0 failed=0 skipped=0 failures=()

# part NAME COMMAND...: the command's last line is "N passed, N failed, N skipped"; without it, its exit code counts.
part() {
  local name=$1 log started rc last
  shift
  if [ ${#only[@]} -gt 0 ] && [[ " ${only[*]} " != *" $name "* ]]; then return; fi
  started=$(date +%s)
  log=build/check-$name.log
  mkdir -p build
  printf '== %s\n' "$name"
  "$@" 2>&1 | tee "$log" | grep -v '^\(gcc\|clang\|g++\|clang++\) '
  rc=${PIPESTATUS[0]}
  last=$(grep -E '^[0-9]+ passed, [0-9]+ failed, [0-9]+ skipped$' "$log" | tail -1)
  if [ -n "$last" ]; then
    read -r p _ f _ s _ <<<"${last//,/}"
  else
    p=0 f=0 s=0
  fi
  [ "$rc" -ne 0 ] && [ "$f" -eq 0 ] && f=1
  [ "$rc" -eq 0 ] && [ -z "$last" ] && p=1
  passed=$((passed + p)) failed=$((failed + f)) skipped=$((skipped + s))
  [ "$f" -gt 0 ] && failures+=("$name")
  printf '== %s: %d passed, %d failed, %d skipped (%d s)\n\n' "$name" "$p" "$f" "$s" $(($(date +%s) - started))
}

build() { make -s -j"$jobs" "$@"; }

only=("$@")
part gcc build all
part architecture tests/architecture.sh
part units make -s -j"$jobs" test
part sanitize make -s -j"$jobs" CC=clang config=sanitize test
part threads make -s -j"$jobs" CC=clang config=thread test T="test_metrics test_reference test_reference_noise"
part clang build CC=clang all
part egl make -s -j"$jobs" gl=egl test T="test_gl test_conform"
build all >/dev/null # ./treeline is the release again, whatever was built last
part cli tests/cli.sh
part bad-input tests/bad_input.sh
part fuzz make -s -j"$jobs" fuzz FUZZ_SECONDS=60
part smoke tests/smoke.sh
part page tests/page.sh
part plugins tests/plugins.sh
part documents tests/documents.sh
part conform tests/conform.sh

[ ${#failures[@]} -gt 0 ] && echo "failed parts: ${failures[*]}; their logs are build/check-PART.log"
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
