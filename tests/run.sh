#!/usr/bin/env bash
# Runs test programs one after the other and adds up their cases.  tests/run.sh PROGRAM...
# A program that dies without naming a failed case is one failure.
set -u
passed=0 failed=0 skipped=0
log=$(mktemp)
trap 'rm -f "$log"' EXIT
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
for program in "$@"; do
  started=$(date +%s)
  timeout -k 5 "${TEST_TIMEOUT:-300}" "$program" >"$log" 2>&1
  rc=$?
  p=$(grep -c '^\[       OK \]' "$log")
  # cmocka names each failed or skipped case twice: as it happens, and in its closing list.
  f=$(grep '^\[  FAILED  \] test' "$log" | sort -u | wc -l)
  s=$(grep '^\[  SKIPPED \] test' "$log" | sort -u | wc -l)
  [ $rc -ne 0 ] && [ "$f" -eq 0 ] && f=1
  passed=$((passed + p)) failed=$((failed + f)) skipped=$((skipped + s))
  printf '%-44s %3d passed %s%s(%d s)\n' "$(basename "$program")" "$p" \
    "$([ "$f" -gt 0 ] && echo "$f FAILED ")" "$([ "$s" -gt 0 ] && echo "$s skipped ")" $(($(date +%s) - started))
  if [ $rc -ne 0 ]; then
    grep -v '^\[ RUN      \]\|^\[       OK \]' "$log" | head -60
    echo "  (exit code $rc)"
  fi
done
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
