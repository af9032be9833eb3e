#!/usr/bin/env bash
# Makes what README.md shows: pictures, plots and tables, all by the program, from three kept runs.
#   reports/readme.sh QUICK GROWTH PEER      folders of runs of the plans quick, growth and peer
set -eu
cd "$(dirname "$0")/.."
quick=$1 growth=$2 peer=$3
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
./treeline report -q "$peer" --out "$work/peer"
cp "$work"/growth/plots/growth-*.png "$out/growth.png"
python3 - "$work" "$quick" "$growth" "$peer" <<'PY'
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
    records = [json.loads(line) for line in open(run + "/cells.jsonl")]
    head, cell = records[0], next(r for r in records if r.get("status") == "ok" and r.get("gl_version"))
    return f'{head["cpu"]}, {head["cores"]} cores, {cell["renderer"]}, Mesa {cell["gl_version"].split()[-1]}, revision {head["revision"]}'

def fps(r):
    return f'{number(r["fps"])} ({number(str(1 / float(r["frame_seconds_high"])))} to ' \
           f'{number(str(1 / float(r["frame_seconds_low"])))})' if r["status"] == "ok" else r["status"]

def trade_table(rows):
    lines = ["| method | frame [ms], 95 % interval | fps | FLIP, same effects | RMSE-8 | FLIP, all effects |",
             "|---|--:|--:|--:|--:|--:|"]
    for r in rows:
        if r["status"] != "ok":
            lines.append(f'| {name(r)} | {r["status"]} | - | - | - | - |')
            continue
        lines.append(f'| {name(r)} | {ms(r["frame_seconds"])} '
                     f'({ms(r["frame_seconds_low"])} to {ms(r["frame_seconds_high"])}) | {number(r["fps"])} '
                     f'| {number(r["same_flip"])} | {number(r["same_rmse_box8"])} | {number(r["full_flip"])} |')
    return "\n".join(lines)

def count_table(rows, scenes):
    """Frames a second, and FLIP against the same effects, of each method by scene and count."""
    methods = sorted({name(r) for r in rows})
    head = (["scene"] if scenes else []) + ["trees"]
    lines = ["| " + " | ".join(head + [f"{m}, fps | FLIP" for m in methods]) + " |",
             "|" + ("---|" if scenes else "") + "--:|" * (1 + 2 * len(methods))]
    for scene, trees in sorted({(r["scene"], int(r["trees"])) for r in rows}):
        cells = [scene] if scenes else []
        cells.append(f"{trees:,}")
        for m in methods:
            found = [r for r in rows if r["scene"] == scene and int(r["trees"]) == trees and name(r) == m]
            cells += [fps(found[0]), number(found[0]["same_flip"])] if found else ["-", "-"]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)

work, quick, growth, peer = sys.argv[1:]
def results(which, keep):
    return rows(f"{work}/{which}/tables/results.csv", keep)
def size(rows):
    return f'{rows[0]["width_px"]} x {rows[0]["height_px"]}'

quick_rows = results("quick", lambda r: r["scene"] == "poplar-forest" and r["trees"] == "1000")
growth_rows = results("growth", lambda r: r["method"] != "null")
peer_rows = results("peer", lambda r: r["method"] != "null")
text = f"""<!-- results: made by reports/readme.sh -->
From `{quick}` ({machine(quick)}), 1,000 poplars at {size(quick_rows)}:

{trade_table(quick_rows)}

From `{growth}` ({machine(growth)}), oaks and poplars on hills at {size(growth_rows)}, one tree to a million (frames a
second with their 95 % interval):

![Frame rate against trees](reports/readme/growth.png)

{count_table(growth_rows, False)}

From `{peer}` ({machine(peer)}), a flat mixed forest at {size(peer_rows)}:

{count_table(peer_rows, True)}
<!-- end of results -->"""
readme = "README.md"
whole = open(readme).read()
whole = re.sub(r"<!-- results:.*<!-- end of results -->", lambda _: text, whole, flags=re.S)
open(readme, "w").write(whole)
PY
