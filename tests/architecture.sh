#!/usr/bin/env bash
# The house rules that a machine can hold: who may include what, no typedefs for structs, no #ifdef, no mutable
# globals, every test registered, every file says what lives there.  tests/architecture.sh
set -u
cd "$(dirname "$0")/.." || exit 1
passed=0 failed=0
words=$(mktemp)
trap 'rm -f "$words"' EXIT
check() { # check NAME OFFENDERS
  if [ -z "$2" ]; then
    passed=$((passed + 1))
  else
    failed=$((failed + 1))
    printf 'FAILED %s:\n%s\n' "$1" "$(sed 's/^/  /' <<<"$2" | head -20)"
  fi
}
sources=$(git ls-files --cached --others --exclude-standard 'harness/*.c' 'harness/*.h' 'methods/*.c' | sort)
headers=$(grep '\.h$' <<<"$sources")

# 1. A foreign library stands behind one file of the wall (the GL back ends are two).
foreign() { # foreign NAME PATTERN ALLOWED
  check "$1 is included only by $3" "$(grep -lE "#include <($2)" $sources harness/wall/*.cpp | grep -vE "^($3)\$")"
}
foreign Embree 'embree[34]/' 'harness/wall/embree[a-z0-9_]*\.[ch]'
foreign OpenImageIO 'OpenImageIO/' 'harness/wall/oiio\.cpp'
foreign cJSON 'cjson/|cJSON' 'harness/wall/json\.c'
foreign OSMesa 'GL/osmesa' 'harness/wall/gl_osmesa\.c'
foreign EGL 'EGL/' 'harness/wall/gl_egl\.c'
foreign OpenGL 'GL/' 'harness/wall/gl[a-z_]*\.[ch]'
foreign assimp 'assimp/' 'harness/wall/mesh_import[a-z_]*\.c'
foreign meshoptimizer 'meshoptimizer' 'harness/wall/simplify\.c'
foreign xxHash 'xxhash' 'harness/base/hash\.c'

# 2. Includes go down only. plant/mesh.h is plain data and may be seen from the wall.
rank() {
  case $1 in base) echo 0 ;; wall) echo 1 ;; stats) echo 1 ;; plant) echo 2 ;; scene) echo 3 ;; calibrate) echo 3 ;; truth) echo 4 ;;
    method) echo 4 ;; bake) echo 5 ;; plan) echo 5 ;; results) echo 6 ;; cell) echo 7 ;; report) echo 7 ;;
    conform) echo 8 ;; cli) echo 9 ;; *) echo 99 ;; esac
}
offenders=$(for f in $(grep '^harness/' <<<"$sources"); do
  room=$(cut -d/ -f2 <<<"$f")
  grep -oE '#include "[a-z]+/[a-z_0-9]+\.h"' "$f" | cut -d'"' -f2 | while read -r h; do
    other=${h%%/*}
    [ "$h" = plant/mesh.h ] && continue
    [ "$other" = "$room" ] && continue
    [ "$(rank "$other")" -lt "$(rank "$room")" ] || echo "$f includes $h"
  done
done)
check 'includes go down only' "$offenders"

# 3. A method sees the contract, the scene, bake, GL and base; never another method.
check 'a method includes only what the contract lets it see' "$(grep -nE '#include "' methods/*.c 2>/dev/null |
  grep -vE '"(method/method|scene/[a-z_]+|plant/[a-z_]+|bake/[a-z_]+|base/[a-z_]+|wall/gl|wall/simplify)\.h"|"[a-z_-]+\.glsl\.h"')"
check 'a shader is included by its own method' "$(for f in methods/*.c; do
  grep -oE '"[a-z_-]+\.glsl\.h"' "$f" | tr -d '"' | grep -v "^$(basename "$f" .c)\.glsl\.h\$" | sed "s|^|$f: |"
done)"
check "a method's name is its file's" "$(for f in methods/*.c; do
  grep -qF ".name = \"$(basename "$f" .c)\"," "$f" || echo "$f: $(grep -oE '\.name = "[^"]*"' "$f" || echo 'no .name')"
done)"

# 4. The language: no typedefs for structs, no conditional compilation, no mutable globals.
check 'no typedefs for structs' "$(grep -nE '^\s*typedef\s+struct' $sources)"
check 'no #ifdef in C' "$(grep -nE '^\s*#\s*(ifdef|if |elif)' $sources)"
check '#ifndef only guards a header' "$(for f in $headers; do
  [ "$(grep -c '#ifndef' "$f")" -eq 1 ] || echo "$f"
done)"
build=$(ls -d build/release-gcc 2>/dev/null)
if [ -n "$build" ]; then
  # d, b: writable data; per-thread ones (.tbss, .tdata) and the signal flags that a handler must see are allowed.
  check 'no mutable globals' "$(find "$build/harness" "$build/methods" -name '*.o' 2>/dev/null | sort | while read -r o; do
    objdump -t "$o" | awk -v o="${o#"$build"/}" '/ O \.(data|bss)(\.[^r][^ ]*)?[ \t]/ {print o ": " $NF}'
  done | grep -vE ': (__|\.)|: [a-z_]*signal[a-z_]*(\.[0-9]+)?$|DW\.ref')"
fi

# 5. A file says what lives there; names of rooms and tests.
check 'the first line says what lives in the file' "$(for f in $sources; do
  head -1 "$f" | grep -qE '^/\* .{10,}' || echo "$f"
done)"
check 'every test is registered' "$(for f in tests/test_*.c; do
  diff <(grep -oE '^static void test_[A-Za-z0-9_]+' "$f" | awk '{print $3}' | sort -u) \
    <(grep -oE 'cmocka_unit_test[a-z_]*\( *test_[A-Za-z0-9_]+' "$f" | sed 's/.*( *//' | sort -u) | grep '^[<>]' | sed "s|^|$f |"
done)"
check 'test names are sentences' "$(grep -nE '^static void test_' tests/test_*.c | grep -vE 'test_[a-z0-9_]+__[a-z0-9_]+\(')"
check 'no file is too long to read' "$(wc -l $sources tests/*.c | awk '$2 != "total" && $1 > 700 {print $2 ": " $1 " lines"}')"
check 'no line is longer than 100 columns in C' "$(grep -nE '^.{121,}' $sources)"
check 'every function fits a screen (60 lines)' "$(for f in $sources; do
  awk -v f="$f" '$0 == "{" {start = FNR} $0 == "}" && start {if (FNR - start > 60) print f ":" start ": " FNR - start " lines"; start = 0}' "$f"
done)"
check 'every function of a header is used by another file' "$(
  # A name needs three files: its header, its own file, its user. error_write is used through its header's macro.
  awk '{gsub(/"[^"]*"/, ""); n = split($0, w, /[^A-Za-z0-9_]+/); for (i = 1; i <= n; i++) if (!((w[i], FILENAME) in seen)) {seen[w[i], FILENAME]; files[w[i]]++}}
    END {for (word in files) print word, files[word]}' $sources tests/*.c tests/*.h tests/plugins/*.c harness/wall/*.cpp >"$words"
  for h in $headers; do
    grep -ohE '^[a-z][A-Za-z0-9_ ]* \**[a-z][a-z0-9_]+\(' "$h" | grep -vE '^(typedef|return|static|extern "C")' |
      sed -E 's/.*[ *]([a-z0-9_]+)\($/\1/' | sed "s|\$| $h|"
  done | grep -v '^error_write ' | awk 'NR == FNR {files[$1] = $2; next} files[$1] < 3 {print $2 ": " $1}' "$words" - | sort -u)"
check 'no header is included twice' "$(for f in $sources; do
  grep -oE '^#include [<"][^>"]+[>"]' "$f" | sort | uniq -d | sed "s|^|$f: |"
done)"
check 'no unfinished work is marked' "$(grep -nwE 'TODO|FIXME|XXX|HACK' $sources tests/*.c tests/*.sh scenes/*.json Makefile | grep -v '^tests/architecture.sh')"

echo "$passed passed, $failed failed, 0 skipped"
[ "$failed" -eq 0 ]
