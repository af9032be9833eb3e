#!/usr/bin/env bash
# Makes what README.md shows: pictures, the trade plot and a table, all by the program, from two kept runs.
#   reports/readme.sh QUICK GROWTH      folders of runs of the plans quick and growth
set -eu
cd "$(dirname "$0")/.."
quick=$1 growth=$2
out=reports/readme
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$out"

# 1. One forest, traced twice and drawn three ways.
scene=(--scene poplar-forest --trees 200 --size 360x360 --eye 60,45,95 --target 0,5,0)
./treeline reference -q "${scene[@]}" --standard-error 0.005 -o "$work/1.png"
./treeline reference -q "${scene[@]}" --effects two-sided,ambient --standard-error 0.005 -o "$work/2.png"
for m in 3:polygons:samples=4 4:billboards:layout=hemisphere,views=64 5:cross-quads:planes=4; do
  ./treeline render -q "${scene[@]}" --method "${m#*:}" -o "$work/${m%%:*}.png"
done
oiiotool "$work"/[12345].png --mosaic:pad=6 5x1 -o "$out/forest.png"

# 2. The trade plot of the quick run, as the report draws it.
./treeline report -q "$quick" --out "$work/quick"
cp "$work/quick/plots/trade-poplar-forest-1000-flip-same.png" "$out/trade.png"

# 3. The tables: a few columns of the report's CSV.
./treeline report -q "$growth" --out "$work/growth" 
cp "$work"/growth/plots/growth-*.png "$out/growth.png"
python3 - "$quick" "$work/quick/tables/results.csv" "$growth" "$work/growth/tables/results.csv" README.md <<'PY'
import csv, json, re, sys

def rows(path, keep):
    with open(path, newline="") as file:
        return [r for r in csv.DictReader(file) if keep(r)]

def number(text):
    if not text:
        return "-"
    value = float(text)
    return f"{value:,.0f}" if abs(value) >= 100 else f"{value:.3g}"

def ms(text):
    return number(str(1000 * float(text)))

def name(r):
    parts = [r["options"]] if r["options"] else []
    parts += ["lod=" + r["lod"]] if r["lod"] != "auto" else []
    return r["method"] + (" (" + ", ".join(parts) + ")" if parts else "")

def machine(run):
    head = json.loads(open(run + "/cells.jsonl").readline())
    cell = json.loads(open(run + "/cells.jsonl").readlines()[1])
    return f'{head["cpu"]}, {head["cores"]} cores, {cell["renderer"]}, Mesa {cell["gl_version"].split()[-1]}, revision {head["revision"]}'

def table(rows):
    lines = ["| scene | trees | method | frame [ms], 95 % interval | fps | FLIP, same effects | RMSE-8 | FLIP, all effects |",
             "|---|--:|---|--:|--:|--:|--:|--:|"]
    for r in rows:
        if r["status"] != "ok":
            lines.append(f'| {r["scene"]} | {int(r["trees"]):,} | {name(r)} | {r["status"]} | - | - | - | - |')
            continue
        lines.append(f'| {r["scene"]} | {int(r["trees"]):,} | {name(r)} | {ms(r["frame_seconds"])} '
                     f'({ms(r["frame_seconds_low"])} to {ms(r["frame_seconds_high"])}) | {number(r["fps"])} '
                     f'| {number(r["same_flip"])} | {number(r["same_rmse_box8"])} | {number(r["full_flip"])} |')
    return "\n".join(lines)

quick, quick_csv, growth, growth_csv, readme = sys.argv[1:]
def size(rows):
    return f'{rows[0]["width_px"]} x {rows[0]["height_px"]}'

quick_rows = rows(quick_csv, lambda r: r["scene"] == "poplar-forest" and r["trees"] == "1000")
growth_rows = rows(growth_csv, lambda r: r["method"] != "null")
text = f"""<!-- results: made by reports/readme.sh -->
From `{quick}` ({machine(quick)}), 1,000 poplars at {size(quick_rows)}:

{table(quick_rows)}

From `{growth}` ({machine(growth)}), oaks and poplars on hills at {size(growth_rows)}, one tree to a million:

![Frame rate against trees](reports/readme/growth.png)

{table(growth_rows)}
<!-- end of results -->"""
whole = open(readme).read()
whole = re.sub(r"<!-- results:.*<!-- end of results -->", lambda _: text, whole, flags=re.S)
open(readme, "w").write(whole)
PY
