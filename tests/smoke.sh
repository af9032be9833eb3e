#!/usr/bin/env bash
# A smoke benchmark: the smallest plan from the command to the page, and what must hold of its results. No clock is
# judged.  tests/smoke.sh
set -u
cd "$(dirname "$0")/.." || exit 1
passed=0 failed=0
check() { # check NAME COMMAND...
  local name=$1
  shift
  if "$@" >"$folder/log" 2>&1; then
    passed=$((passed + 1))
  else
    failed=$((failed + 1))
    echo "FAILED $name"
    head -20 "$folder/log" | sed 's/^/  /'
  fi
}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
run=$folder/run page=$folder/page

check 'the smoke plan runs' ./treeline run smoke --quiet --out "$run"
lines=$(wc -l <"$run/cells.jsonl")
check 'resume finds nothing left to do' ./treeline run smoke --quiet --out "$run" --resume
check 'resume adds no line' test "$(wc -l <"$run/cells.jsonl")" -eq "$lines"
check 'the report is written' ./treeline report "$run" --out "$page"
check 'the page is there' test -s "$page/index.html"
check 'the page asks nothing of the network' bash -c "! grep -E '(src|href)=\"(https?:)?//' '$page/index.html'"
check 'an installation is made' make -s install PREFIX="$folder/prefix"
# There, no checkout is in reach: scenes, page templates, image shim and manual come from the installation.
away() { (cd / && env -u TREELINE_DATA "$folder/prefix/bin/treeline" "$@"); }
check 'an installation finds its scenes' away list scenes
check 'an installation writes a picture' away render --scene tiny --method null --output "$folder/away.png"
check 'an installation writes a page' away report "$run" --out "$folder/away"
check 'an installation has its manual' grep -q '^.SH VERBS' "$folder/prefix/share/man/man1/treeline.1"
check 'methods/README.md says what the program says (make docs)' bash -c './treeline help methods | diff - methods/README.md'
check 'no NaN is shown' bash -c "! grep -wE 'nan|-nan|NaN' '$page'/tables/*"
# Half of Europe writes 0,5: neither what is read nor what is written may follow.
localedef -i de_DE -f UTF-8 "$folder/de_DE.UTF-8" 2>/dev/null
commas() { env LOCPATH="$folder" LC_ALL=de_DE.UTF-8 "$@"; }
check 'there is a locale with decimal commas' bash -c "[ \"\$(LOCPATH='$folder' LC_ALL=de_DE.UTF-8 bash -c 'printf %.1f 0,5')\" = 0,5 ]"
check 'a report is written in it' commas ./treeline report "$run" --out "$folder/commas"
check 'it is the same report' diff -r "$page" "$folder/commas"
still=(render --scene tiny --method polygons:error_px=1.5 --quiet --output)
check 'a picture is drawn' ./treeline "${still[@]}" "$folder/points.exr"
check 'a picture is drawn in it' commas ./treeline "${still[@]}" "$folder/commas.exr"
check 'it is the same picture' cmp "$folder/points.exr" "$folder/commas.exr"
check 'the results make sense' python3 - "$run/cells.jsonl" <<'PY'
import json, sys
lines = [json.loads(line) for line in open(sys.argv[1])]
head, cells = lines[0], [line for line in lines[1:] if "cell" in line]
assert sum(line["kind"] == "treeline-calibration" for line in lines[1:] if "kind" in line) == 1
assert head["kind"] == "treeline-run" and head["cores"] >= 1
assert cells and all(c["status"] == "ok" and c["message"] == "" for c in cells), [c["message"] for c in cells]
first = {c["method"]: c for c in cells if c["repetition"] == 0}
for c in cells:  # every repetition draws the same picture
    assert c["views"][0]["picture_hash"] == first[c["method"]]["views"][0]["picture_hash"], c["cell"]
    assert all(t > 0 for t in c["frame_seconds"])
error = {m: c["views"][0]["same"]["value"] for m, c in first.items()}
for m, e in error.items():
    if m == "null":  # draws no tree: its coverage error is the coverage itself, all of one sign
        assert abs(e["coverage"] + e["coverage_bias"]) < 1e-6, e
    else:
        assert e["coverage"] < error["null"]["coverage"], m
        assert e["rmse_box8"] < error["null"]["rmse_box8"], m
for c in first.values():
    assert c["views"][0]["same"]["value"]["rmse"] <= c["views"][0]["full"]["value"]["rmse"] + 0.02
    assert c["harness_seconds_per_frame"] < 0.5 * min(c["frame_seconds"])
assert first["null"]["device_bytes"] < first["polygons"]["device_bytes"]
assert first["null"]["triangles"] < first["billboards"]["triangles"] < first["polygons"]["triangles"]
PY
echo "$passed passed, $failed failed, 0 skipped"
[ "$failed" -eq 0 ]
