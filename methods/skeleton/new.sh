#!/usr/bin/env bash
# Writes a method that works, with its shader and its test, from this folder.  NAME=x methods/skeleton/new.sh
set -u
cd "$(dirname "$0")/../.." || exit 1
name=${NAME:-}
refuse() { echo "new-method: $*" >&2; exit 1; }
[ -n "$name" ] || refuse "which name? make new-method NAME=my-method"
[[ $name =~ ^[a-z][a-z0-9]*(-[a-z0-9]+)*$ && ${#name} -le 40 ]] ||
  refuse "'$name': allowed are at most 40 small letters, digits and single hyphens, a letter first"
id=${name//-/_}
declare -A files=([skeleton.c]=methods/$name.c [skeleton.glsl]=methods/$name.glsl [test_skeleton.c]=tests/test_$id.c)
for file in "${files[@]}"; do [ ! -e "$file" ] || refuse "$file exists; nothing was written"; done
for from in "${!files[@]}"; do
  sed "s/test_skeleton__/test_${id}__/; s/skeleton_/${id}_/g; s/skeleton/$name/g" "methods/skeleton/$from" \
    >"${files[$from]}" || refuse "${files[$from]} cannot be written"
done
echo "methods/$name.c, methods/$name.glsl and tests/test_$id.c are written. Next:"
echo "  make && make test T=test_$id && ./treeline render --scene tiny --method $name -o $name.png"
