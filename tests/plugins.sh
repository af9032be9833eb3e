#!/usr/bin/env bash
# A method from nothing: `make new-method`, in the tree and out of it against an installation.  tests/plugins.sh
set -u
cd "$(dirname "$0")/.." || exit 1
unset MAKEFLAGS MAKELEVEL MFLAGS NAME
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export TREELINE_CACHE="$work/cache"
passed=0 failed=0
# check NAME COMMAND...: the command succeeds
check() {
  local name=$1
  shift
  if "$@" >"$work/log" 2>&1; then
    passed=$((passed + 1)); printf 'ok      %s\n' "$name"
  else
    failed=$((failed + 1)); printf 'FAILED  %s\n' "$name"; tail -5 "$work/log" | sed 's/^/        /'
  fi
}
# refuses NAME PATTERN ARGUMENT...: make new-method fails with that line and writes nothing
refuses() {
  local name=$1 pattern=$2 before after
  shift 2
  before=$(find methods tests | sort | md5sum)
  check "$name" bash -c '! make -s new-method "$@" 2>'"'$work/err'" _ "$@"
  after=$(find methods tests | sort | md5sum)
  check "$name, in a clear line" grep -qE -- "^new-method: $pattern" "$work/err"
  check "$name, and nothing is written" test "$before" = "$after"
}

# A copy of the checkout with what is built already, so that nothing is written into this one.
mkdir "$work/tree"
git ls-files -z --cached --others --exclude-standard | xargs -0 cp -a --parents -t "$work/tree" 2>/dev/null
mkdir -p "$work/tree/build"
cp -a build/release-gcc "$work/tree/build/"
cd "$work/tree" || exit 1

refuses 'no name is refused' 'which name'
refuses 'a capital letter is refused' "'Trees': allowed are" NAME=Trees
refuses 'a path is refused' "'../trees': allowed are" NAME=../trees
refuses 'a quote is refused' "'it's': allowed are" "NAME=it's"
refuses 'a name that is taken is refused' 'methods/null.c exists' NAME=null

check 'make new-method writes a method' make -s new-method NAME=my-trees
check 'with its test' test -s tests/test_my_trees.c
cp methods/my-trees.c "$work/before.c"
refuses 'a second one of that name is refused' '[a-z/_.-]* exists' NAME=my-trees
check 'and the first is left as it was' cmp methods/my-trees.c "$work/before.c"
check 'it builds, and its test passes' make -s test T=test_my_trees
check 'the house rules hold for it' bash -c 'git init -q . && tests/architecture.sh'
check 'it is listed' bash -c './treeline list methods | grep -q "^my-trees "'
check 'its test fails when it draws other cones' bash -c '
  sed -i "s/radius_m = mesh->radius_m;/radius_m = 2 * mesh->radius_m;/" methods/my-trees.c &&
  ! make -s test T=test_my_trees && cp '"'$work/before.c'"' methods/my-trees.c && make -s'
check 'it stands in the report beside null' bash -c 'grep -q my-trees "$(./treeline run --scene tiny --method null \
  --method my-trees --trees 1 --rounds 1 --frame-seconds 0.02 --views 1 --reference-samples 16 --out "$0" --report -q | tail -1)"' \
  "$work/run"
check 'it keeps the contract' ./treeline conform my-trees
./treeline render --scene tiny --method my-trees --size 64x48 -o "$work/in.png" -q

# Out of the tree: the headers, the program and the rule of the installation alone.
check 'an installation is made' make -s install PREFIX="$work/prefix"
mkdir "$work/out"
cp methods/my-trees.c methods/my-trees.glsl methods/null.c "$work/out"
cd "$work/out" && rm -rf "$work/tree"
export PKG_CONFIG_PATH="$work/prefix/lib/pkgconfig" PATH="$work/prefix/bin:$PATH"
abi=$(sed -n 's/^#define METHOD_ABI \([0-9]*\).*/\1/p' "$work/prefix"/include/treeline/method/method.h)
check 'pkg-config knows the contract' test "$(pkg-config --modversion treeline)" = "${abi:-none}"
check 'the same files build outside' make -s -f "$(pkg-config --variable=makefile treeline)" my-trees.so
check 'a method without a shader builds by one line' bash -c 'cc -shared -fPIC $(pkg-config --cflags treeline) -o null.so null.c'
check 'help explains the plugin' bash -c 'treeline help ./my-trees.so | grep -q sides'
check 'list lists the plugin' bash -c 'treeline list methods --plugin ./my-trees.so | grep -q "^my-trees "'
check 'the plugin keeps the contract' treeline conform --check '^(load|description|bytes|one-tree|effects)$' ./my-trees.so
check 'render takes the plugin' treeline render --scene tiny --method ./my-trees.so --size 64x48 -o "$work/out.png" -q
check 'and draws what it draws within' cmp "$work/in.png" "$work/out.png"
check 'run takes the plugin' treeline run --scene tiny --method ./my-trees.so:sides=3,9 --trees 1 --rounds 1 \
  --frame-seconds 0.02 --views 1 --reference-samples 16 --out "$work/run2" -q

echo "$passed passed, $failed failed, 0 skipped"
[ "$failed" -eq 0 ]
