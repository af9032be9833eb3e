# Sourced by the tests that call treeline as a user does: a folder of its own, counts, and what may be asked of a call.
# The script's first argument is the program; without it, the release build.
cd "$(dirname "$0")/.." || exit 1
binary=$(realpath "${1:-build/release-gcc/treeline}")
plugins=$(dirname "$binary")/plugins
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export TREELINE_CACHE="$work/cache" TREELINE_DATA="$PWD"
passed=0 failed=0 skipped=0

ok() { passed=$((passed + 1)); printf 'ok      %s\n' "$1"; }
bad() { failed=$((failed + 1)); printf 'FAILED  %s\n' "$1"; shift; printf '        %s\n' "$@"; }
# is NAME CONDITION...: a test(1) expression
is() { local name=$1; shift; if test "$@"; then ok "$name"; else bad "$name" "not: $*"; fi; }

# try: runs treeline; leaves rc, $work/out and $work/err
try() { "$binary" "$@" >"$work/out" 2>"$work/err"; rc=$?; }

# refuses NAME CODE PATTERN ARGUMENT...: that exit code, nothing on stdout, one line on stderr that matches
# (getopt's own line is followed by one that names --help)
refuses() {
  local name=$1 code=$2 pattern=$3 lines
  shift 3
  try "$@"
  lines=$(grep -cv '^Try ' "$work/err")
  if [ $rc -eq "$code" ] && [ ! -s "$work/out" ] && [ "$lines" -eq 1 ] && grep -qE -- "$pattern" "$work/err"; then
    ok "$name"
  else
    bad "$name" "treeline $*" "exit code $rc, wanted $code; stderr: $(head -c 300 "$work/err")"
  fi
}
# prints NAME PATTERN ARGUMENT...: exit code 0, stdout matches, stderr empty
prints() {
  local name=$1 pattern=$2
  shift 2
  try "$@"
  if [ $rc -eq 0 ] && [ ! -s "$work/err" ] && grep -qE -- "$pattern" "$work/out"; then
    ok "$name"
  else
    bad "$name" "treeline $*" "exit code $rc; stdout: $(head -c 200 "$work/out"); stderr: $(head -c 200 "$work/err")"
  fi
}
lines() { wc -l <"$1"; }
# told FILE: lines of a run that are not on its references
told() { grep -vc '"kind":"treeline-reference"' "$1"; }
