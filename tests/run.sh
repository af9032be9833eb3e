#!/usr/bin/env bash
# Runs test programs, as many at once as there are cores, and adds up their cases.  tests/run.sh PROGRAM...
# A program that dies without naming a failed case is one failure.
set -u
passed=0 failed=0 skipped=0
logs=$(mktemp -d)
trap 'rm -rf "$logs"' EXIT
here=$(cd "$(dirname "$0")" && pwd)
export LSAN_OPTIONS="suppressions=$here/lsan.supp:print_suppressions=0"
# The leak check of clang 14 keeps a record of where libraries loaded later have their thread-local storage; in
# test_report it held addresses that are none, and the check died reading there. It does without.
export ASAN_OPTIONS="intercept_tls_get_addr=0"
export OMP_WAIT_POLICY=passive # threads that spin take the cores of whatever runs beside
export UBSAN_OPTIONS="print_stacktrace=1"
# Embree, OpenImageIO and Mesa are not built for the thread sanitizer; libomp tells it of our own threads.
export TSAN_OPTIONS="ignore_noninstrumented_modules=1"
export TREELINE_DATA="${TREELINE_DATA:-$(dirname "$here")}"
# run PROGRAM LOG: its exit code and its seconds go to LOG.rc.
run() {
  local started rc
  started=$(date +%s)
  timeout -k 5 "${TEST_TIMEOUT:-600}" "$1" >"$2" 2>&1
  rc=$?
  echo "$rc $(($(date +%s) - started))" >"$2.rc.part"
  mv "$2.rc.part" "$2.rc"
}

# tell PROGRAM LOG: its line and, where it failed, what it said.
tell() {
  local rc seconds p f s
  read -r rc seconds <"$2.rc"
  p=$(grep -c '^\[       OK \]' "$2")
  # cmocka names each failed or skipped case twice: as it happens, and in its closing list.
  f=$(grep '^\[  FAILED  \] test' "$2" | sort -u | wc -l)
  s=$(grep '^\[  SKIPPED \] test' "$2" | sort -u | wc -l)
  [ "$rc" -ne 0 ] && [ "$f" -eq 0 ] && f=1
  passed=$((passed + p)) failed=$((failed + f)) skipped=$((skipped + s))
  printf '%-44s %3d passed %s%s(%d s)\n' "$(basename "$1")" "$p" \
    "$([ "$f" -gt 0 ] && echo "$f FAILED ")" "$([ "$s" -gt 0 ] && echo "$s skipped ")" "$seconds"
  if [ "$rc" -ne 0 ]; then
    grep -v '^\[ RUN      \]\|^\[       OK \]' "$2" | head -60
    echo "  (exit code $rc)"
  fi
}

programs=("$@") told=0
for i in "${!programs[@]}"; do
  while [ "$(jobs -rp | wc -l)" -ge "$(nproc)" ]; do wait -n; done
  run "${programs[i]}" "$logs/$i" &
  while [ -e "$logs/$told.rc" ]; do # in order, as soon as it is known
    tell "${programs[told]}" "$logs/$told"
    told=$((told + 1))
  done
done
wait
for ((; told < $#; told++)); do tell "${programs[told]}" "$logs/$told"; done
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
