#!/usr/bin/env bash
# Fuzzes the loaders: libFuzzer with the address and undefined-behaviour sanitizers, every target of
# tests/fuzz/targets.h for an equal share of the time, on all cores.  tests/fuzz.sh [SECONDS [TARGET...]]
# Starts from tests/fuzz/seeds, the inputs that once failed (tests/fuzz/regress) and the scenes; what it learns
# stays in build/fuzz/corpus for the next run. What breaks a rule is left in build/fuzz/broken: copy it to
# tests/fuzz/regress/TARGET and mend the code, and `make test T=test_fuzz` holds it.
set -u
cd "$(dirname "$0")/.." || exit 1
seconds=${1:-60}
[ $# -gt 0 ] && shift
program=$PWD/build/fuzz-clang/fuzz
targets=("$@")
[ $# -gt 0 ] || mapfile -t targets < <(sed -nE 's/^    \{"([a-z]+)", "[a-z/]+", (true|false), fuzz_.*/\1/p' tests/fuzz/targets.h)
jobs=$(nproc)
export SHARE=$((seconds * jobs / ${#targets[@]}))
[ "$SHARE" -gt 0 ] || SHARE=1
export TREELINE_CACHE=off TREELINE_DATA=$PWD OMP_NUM_THREADS=1 program
# 86: a sanitizer's report, told from the ways in which assimp leaves.
export ASAN_OPTIONS=exitcode=86:handle_segv=1:allocator_may_return_null=1:detect_stack_use_after_return=0
export UBSAN_OPTIONS=exitcode=86 LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0
mkdir -p build/fuzz/broken

fuzz() { # fuzz TARGET
  local target=$1 more=() log=build/fuzz/$1.log rc
  mkdir -p "build/fuzz/corpus/$target"
  for folder in "$(sed -nE "s/^    \{\"$target\", \"([a-z/]+)\".*/\1/p" tests/fuzz/targets.h)" "tests/fuzz/regress/$target"; do
    [ -d "$folder" ] && more+=("$folder")
  done
  FUZZ_TARGET=$target "$program" -max_total_time="$SHARE" -timeout=60 -rss_limit_mb=3000 -max_len=20000 -print_final_stats=1 \
    -use_value_profile=1 -artifact_prefix="build/fuzz/broken/$target-" "build/fuzz/corpus/$target" "${more[@]}" >"$log" 2>&1
  rc=$?
  printf '%s %s %s runs, %s edges\n' "$([ $rc -eq 0 ] && echo 'ok     ' || echo 'BROKEN ')" "$target" \
    "$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")" "$(grep -oE 'cov: [0-9]+' "$log" | tail -1 | tr -dc 0-9)"
  [ $rc -eq 0 ] || grep -aE '^fuzz: broken|ERROR: |runtime error|SUMMARY|Test unit written' "$log" | head -5 | sed 's/^/    /'
  return $rc
}
export -f fuzz
printf '%s\n' "${targets[@]}" | xargs -P "$jobs" -I{} bash -c 'fuzz {}' | tee build/fuzz/summary.log
passed=$(grep -c '^ok ' build/fuzz/summary.log)
echo "$passed passed, $((${#targets[@]} - passed)) failed, 0 skipped"
[ "$passed" -eq ${#targets[@]} ]
