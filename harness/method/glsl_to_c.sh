#!/usr/bin/env bash
# A shader as C text, to include: my-method.glsl becomes `static const char my_method_glsl[]`.  glsl_to_c.sh FILE
name=$(basename "$1" .glsl)
echo "static const char ${name//-/_}_glsl[] = {"
od -An -v -tx1 "$1" | sed 's/ \(..\)/0x\1,/g'
echo '0};'
