#!/usr/bin/env bash
# `treeline conform` from outside: every registered method, every check; tables, JSON and exit codes.  tests/conform.sh
set -u
cd "$(dirname "$0")/.." || exit 1
binary=$(realpath "${1:-build/release-gcc/treeline}")
plugins=$(dirname "$binary")/plugins
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export TREELINE_CACHE="$work/cache" TREELINE_DATA="$PWD"
passed=0 failed=0 skipped=0
make -s -j"$(nproc)" plugins >/dev/null 2>&1

is() { # is NAME CONDITION...: a test(1) expression
  local name=$1
  shift
  if test "$@"; then passed=$((passed + 1)); printf 'ok      %s\n' "$name"; else
    failed=$((failed + 1)); printf 'FAILED  %s\n        not: %s\n        %s\n' "$name" "$*" "$(head -c 300 "$work/err")"; fi
}
try() { "$binary" conform "$@" >"$work/out" 2>"$work/err"; rc=$?; }

# 1. All methods, all checks, as many methods at once as there are cores: each row counts.
mapfile -t names < <("$binary" list methods --json | python3 -c 'import json, sys; [print(m["name"]) for m in json.load(sys.stdin)["methods"]]')
export binary work
printf '%s\n' "${names[@]}" | xargs -P "$(nproc)" -I{} \
  bash -c '"$binary" conform "$1" >"$work/$1.table" 2>>"$work/err"; echo $? >"$work/$1.rc"' - {}
is 'and nothing is said on stderr' ! -s "$work/err"
for name in "${names[@]}"; do sed '1d;$d' "$work/$name.table"; done >"$work/out"
# Defects that are known, METHOD:CHECK: told, and counted as skipped. One that passes again is a failure here.
known=""
for name in "${names[@]}"; do
  [[ " $known" == *" $name:"* ]] && expected=78 || expected=0
  is "$name ends in $expected" "$(cat "$work/$name.rc")" -eq $expected
done
while read -r method check result seconds message; do
  case $result in
    ok | refused) passed=$((passed + 1)) ;;
    skipped) skipped=$((skipped + 1)) ;;
    FAILED)
      if [[ " $known " == *" $method:$check "* ]]; then
        skipped=$((skipped + 1))
        printf 'known   %s %s: %s\n' "$method" "$check" "$message"
      else
        failed=$((failed + 1))
        printf 'FAILED  %s %s (%s s): %s\n' "$method" "$check" "$seconds" "$message"
      fi ;;
  esac
done <"$work/out"
is 'every method is in the table' "$(awk '$2 == "load"' "$work/out" | wc -l)" -eq "$(ls methods/*.c | wc -l)"

# 2. What it says and how it ends.
try --check '^load$' null "$plugins/old.so"
is 'a plugin of another ABI ends in 65' $rc -eq 65
try --check '^load$' "$plugins/crashes-at-load.so"
is 'a plugin that dies at load ends in 76' $rc -eq 76
try --check '^load$' nul
is 'an unknown method ends in 66' $rc -eq 66
is 'and the nearest is named' "$(grep -c "did you mean 'null'" "$work/out")" -eq 1
try --check state "$plugins/leaves-state.so"
is 'a plugin that breaks the contract ends in 78' $rc -eq 78
is 'in a row that says FAILED and why' "$(grep -c 'state  *FAILED .*nonconforming: draw leaves GL_SCISSOR_TEST' "$work/out")" -eq 1
try --json --check '^(load|effects|state)$' null "$plugins/leaves-state.so"
is 'JSON ends in the same code' $rc -eq 78
python3 - "$work/out" <<'P' 2>"$work/err"
import json, sys
text = open(sys.argv[1]).read()
doc = json.loads(text, parse_constant=lambda x: sys.exit("holds " + x))
assert text.count("\n") == 1 and doc["version"] == 1
rows = {(r["method"].split("/")[-1], r["check"]): r for r in doc["checks"]}
assert len(rows) == 6, rows.keys()
assert rows["null", "load"]["result"] == "ok" and rows["null", "effects"]["result"] == "skipped"
bad = rows["leaves-state.so", "state"]
assert bad["result"] == "failed" and bad["status"] == "nonconforming" and bad["seconds"] > 0
assert (doc["passed"], doc["skipped"], doc["refused"], doc["failed"]) == (4, 1, 0, 1)
P
is 'JSON is one object, a line, with each row and the counts' $? -eq 0
try --check '('
is 'a pattern that is none is usage' $rc -eq 64
TREELINE_GL=none try null
is 'an unknown back end is bad input, 65' $rc -eq 65
is 'told in one line' "$(grep -c "'none' is not one of" "$work/err")" -eq 1
try --timeout 0
is 'a limit of nothing is usage' $rc -eq 64
try --help
is 'help lists the checks' "$(grep -c '  million: a million trees' "$work/out")" -eq 1

# 3. Ctrl-C stops it, and nothing is left.
TMPDIR=$work "$binary" conform --check load "$plugins/hangs-at-load.so" >"$work/out" 2>"$work/err" &
pid=$!
sleep 1
kill -INT $pid
wait $pid
is 'SIGINT ends in 130' $? -eq 130
is 'and leaves no scratch folder' -z "$(find "$work" -name 'treeline-conform-*')"

echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
