#!/usr/bin/env bash
# The command line from outside: exit codes, one clear line an error, stdout apart from stderr, interruption,
# kill -9, resuming, full disks.  tests/cli.sh [BINARY]
set -u
. "$(dirname "$0")/shell.sh"
fast=(--no-calibrate --frame-seconds 0.02 --frames-max 5 --views 1 --reference-error 0.1 --reference-samples 16)
good=(--scene tiny --method null --trees 1 --size 32x24)
make -s -j"$(nproc)" plugins >/dev/null 2>&1
[ -f "$plugins/bad.so" ] || make -s CC="${CC:-gcc}" "${plugins#"$PWD"/}/bad.so" >/dev/null

# 1. A wrong command line.
try; is 'no verb prints the verbs on stderr and is usage' "$rc" -eq 64 -a ! -s "$work/out" -a -s "$work/err"
refuses 'an unknown verb names the nearest' 64 "no verb 'rnu'; did you mean 'run'" rnu
refuses 'an unknown option is named' 64 "unrecognized option '--rouds=3'" run --rouds=3
refuses 'an option without its value is named' 64 "option '--trees' requires an argument" run --trees
refuses 'nothing to run' 64 'no scene' run
refuses 'a scene without a method' 64 'no method' run --scene tiny
refuses 'rounds that are no number' 64 "--rounds: 'many' is not a whole number in 1..10000" run "${good[@]}" --rounds many
refuses 'rounds out of range' 64 "--rounds: '0'" run "${good[@]}" --rounds 0
refuses 'a negative time limit' 64 "--timeout: '-3'" run "${good[@]}" --timeout=-3
refuses 'a time limit that is not finite' 64 "--timeout: 'nan'" run "${good[@]}" --timeout nan
refuses 'a size of memory that is none' 64 "--memory: '3Q'" run "${good[@]}" --memory 3Q
refuses 'a seed that is no number' 64 "seed: '1.5'" run "${good[@]}" --seed 1.5
refuses 'two plans' 64 "'quick' is too much" run smoke quick
refuses '--resume without a folder' 64 '--out' run "${good[@]}" --resume
refuses '--retry without --resume' 64 '--resume' run "${good[@]}" --retry --out "$work/x"
refuses 'trees out of range' 65 "trees: '-1' is not a whole number in 0..4000000" run --scene tiny --method null --trees=-1
refuses 'an unknown level' 65 'low.intermediate.high.auto' run "${good[@]}" --lod best
refuses 'an unknown target' 65 'rgba8.rgba16f.rgba32f' run "${good[@]}" --target rgb
try run "${good[@]}" --rounds 1 --dry-run
is 'one cell and one round are not many' "$(grep -c ' 1 cell, 1 round,' "$work/err")" -eq 1
refuses 'a size that is none' 65 'WIDTHxHEIGHT' run --scene tiny --method null --size 800
refuses 'an unknown scene names the nearest' 66 'tiny' run --scene tinny --method null
refuses 'an unknown method names the nearest' 66 "did you mean 'null'" run --scene tiny --method nul
refuses 'an option that a method does not have' 65 'views' run --scene tiny --method null:views=3
refuses 'a plugin that does not exist' 66 'no/such.so' run --scene tiny --method no/such.so
refuses 'a plugin of another ABI' 65 'ABI 1' run --scene tiny --method "$plugins/old.so"
refuses 'an unknown plan lists the plans' 66 'smoke' run no-such-plan
refuses 'a filter that matches nothing' 65 'none of the 1 cells' run "${good[@]}" --filter trees=9
refuses 'a filter that is no expression' 65 'regular expression' run "${good[@]}" --filter '('
refuses 'an unknown back end' 65 'dx12' run "${good[@]}" --backend dx12
refuses 'a bad cell' 65 'SCENE/METHOD' run --cell nonsense
refuses 'a scene file that is not JSON' 65 "$work/bad.json:1" run --scene "$(echo '{x' >"$work/bad.json"; echo "$work/bad.json")" --method null
refuses 'a plan file with an unknown key' 65 'scene.*not a key' run "$(echo '{"scene": "tiny"}' >"$work/p.json"; echo "$work/p.json")"
refuses 'a folder that cannot be made' 74 '/proc/x' run "${good[@]}" --out /proc/x/y -q
refuses 'render without a scene' 64 'which scene' render
refuses 'render without a method' 64 'which method' render --scene tiny -o "$work/a.png"
refuses 'an eye without a target' 64 '--eye and --target' render --scene tiny --method null --eye 1,2,3
refuses 'an eye that is no vector' 64 "--eye: '1,2'" render --scene tiny --method null --eye 1,2 --target 0,0,0
refuses 'an eye that is not finite' 64 "--eye: 'nan,0,0'" render --scene tiny --method null --eye nan,0,0 --target 0,0,0
refuses 'a time beyond the path' 64 "--time: '2'" render --scene tiny --method null --time 2
refuses 'a picture of an unknown kind' 65 'gif' render --scene tiny --method null -o "$work/a.gif"
refuses 'a picture in no folder' 74 'no/a.png' render --scene tiny --method null -o "$work/no/a.png"
refuses 'several methods for one picture' 64 'several methods need --sheet' render --scene tiny --method null --method billboards
refuses 'a sheet of frames' 64 '--sheet and --frames' render --scene tiny --method null --sheet --frames "$work/f"
refuses 'a distance that is none' 64 "--distances: 'x' is not a number in 0.01..1e.06" render --scene tiny --method null --sheet --distances 9,x
refuses 'distances without a sheet' 64 '--distances needs --sheet' render --scene tiny --method null --distances 9
refuses 'a sheet without a direction' 64 'the eye is 0 m from the target' render --scene tiny --method null --sheet --eye 1,1,1 --target 1,1,1
refuses 'frames of one view' 64 'takes no --output' render --scene tiny --method null --frames "$work/f" -o "$work/a.png"
refuses 'a sheet beyond the largest picture' 64 'take a smaller --size' render --scene tiny --method null --sheet --size 5000x5000
refuses 'a picture above the largest frame' 65 '67117056 pixels; at most 67108864' render --scene tiny --method null --size 8193x8192
refuses 'an option that stands twice' 65 "'views' stands twice" run --scene tiny --method billboards:views=8,views=16 --dry-run
refuses 'a folder without a name' 64 "'' is not the name of a folder" run "${good[@]}" --out ''
# A pipe has no end to wait for.
mkdir "$work/pipes" && mkfifo "$work/pipes/cells.jsonl" "$work/pipe.json"
refuses 'a plan that is a pipe' 65 'not a regular file' run "$work/pipe.json"
truncate -s 16777217 "$work/large.json"
refuses 'a plan above 16 MiB' 65 'has 16777217 bytes; at most 16777216 are allowed' run "$work/large.json"
refuses 'a scene that is a pipe' 65 'not a regular file' run --scene "$work/pipe.json" --method null
refuses 'a picture that is a pipe' 65 'not a regular file' diff "$work/pipe.json" "$work/pipe.json"
refuses 'results that are a pipe' 65 'not a regular file' report "$work/pipes"
refuses 'a run into a pipe' 65 'not a regular file' run "${good[@]}" --out "$work/pipes" --resume -q
refuses 'what a terminal would obey is not printed' 66 "no scene ' \[31mx'" run --scene $'\e[31mx' --method null
refuses 'an unknown effect' 64 "effects: 'rain'" reference --scene tiny --effects rain
refuses 'an unknown list' 64 "'trees' is not one of" list trees
refuses 'an unknown topic' 66 "'nothing' is no verb" help nothing
refuses 'a report of nothing' 64 'which run' report
refuses 'a report of a folder that is no run' 66 'cells.jsonl' report "$work"
refuses 'an unknown action on the cache' 64 "'burn' is not one of" cache burn
refuses 'trimming to no size' 64 'to which size' cache trim
refuses 'trimming to what is no size' 64 "trim: 'nan' is not a size" cache trim nan
refuses 'a view that looks nowhere' 64 'the eye is 0 m from the target' render --scene tiny --method null --eye 1,2,3 --target 1,2,3
refuses 'a check that there is not' 64 "no check's name matches 'zzz'" conform --check zzz null

# 2. What is asked for stands on stdout, alone.
prints 'help lists the verbs' '^  run ' help
prints '--help is help' '^  run ' --help
prints 'help of a verb' '--frame-seconds=S' help run
prints 'help of a method' '^kind: GL' help null
prints 'help of a plant lists its options' 'height' help poplar
prints 'help of the exit codes' '^ +75 +timeout ' help exit
prints 'help of plans' 'reference_error' help plan
prints 'version' '^treeline ' --version
prints 'the manual page' '^\.SH EXIT STATUS' help man
prints 'methods' '^null +GL' list methods
prints 'scenes' '^tiny +96x72' list scenes
prints 'metrics' '^rmse +linear' list metrics
prints 'metrics of a path too' '^flicker-peak +linear +lower' list metrics
prints 'plants with their triangles' '^poplar +98286 ' list plants
prints 'grammars with their needles' '^pine-simple +[0-9]+ +16 +2048 .*branches=16' list plants
prints 'the cache has a place' "^$work/cache\$" cache path
for what in methods scenes metrics plants grammars; do
  try list $what --json
  if python3 -c 'import json,sys; d=json.load(open(sys.argv[1])); assert d[sys.argv[2]]' "$work/out" $what; then
    ok "list $what --json is JSON"
  else
    bad "list $what --json is JSON"
  fi
done
prints 'every exit code has a row' '^ 130 +interrupted' help exit
if command -v man >/dev/null && "$binary" help man >"$work/t.1" && man --warnings -l "$work/t.1" >/dev/null 2>"$work/err"; then
  is 'the manual page formats without warnings' ! -s "$work/err"
fi
"$binary" help exit >/dev/full 2>"$work/err"; rc=$?
is 'a full disk behind stdout is an error' $rc -eq 74

# 3. A run.
try run "${good[@]}" --lod high,low --rounds 3 --dry-run
is 'a dry run prints the cells and touches nothing' "$rc" -eq 0 -a "$(lines "$work/out")" -eq 2 -a ! -e results/command-line
cell=$(head -1 "$work/out")
try run --scene tiny --method null,polygons --method billboards:views=8,16,alpha=blend --trees 1 --dry-run
is 'names of methods stand in a list, options sweep' "$(cut -d/ -f2 "$work/out" | LC_ALL=C sort | tr '\n' ' ')" = \
  "billboards:alpha=blend billboards:views=8,alpha=blend null polygons "
try run --cell "$cell" --dry-run
is 'a name can be pasted back' "$(cat "$work/out")" = "$cell"
try run "$cell" --dry-run
is 'a name can be pasted as an argument' "$(cat "$work/out")" = "$cell"

try run "${good[@]}" "${fast[@]}" --rounds 2 --out "$work/run"
is 'a run succeeds' $rc -eq 0
is 'its table is on stdout' "$(grep -c 'tiny/null/trees=1.* ok' "$work/out")" -eq 1
is 'its notes are on stderr' "$(grep -c 'repetitions of 1 cell' "$work/err")" -eq 1
is 'one line for the run and one for each repetition' "$(told "$work/run/cells.jsonl")" -eq 3
refuses 'a folder with a run is not mixed' 64 '--resume' run "${good[@]}" "${fast[@]}" --out "$work/run" -q
try run "${good[@]}" "${fast[@]}" --rounds 2 --out "$work/run" --resume -q
is 'nothing is left to resume' $rc -eq 0 -a "$(told "$work/run/cells.jsonl")" -eq 3
refuses 'other measuring is not mixed in' 65 'frame_seconds: was measured with 0.02; 1 ' run "${good[@]}" --reference-error 0.1 --out "$work/run" --resume -q
try run "${good[@]}" "${fast[@]}" --rounds 3 --out "$work/run/" --resume -q --json
is 'more rounds are only the new ones' $rc -eq 0 -a "$(told "$work/run/cells.jsonl")" -eq 4
is 'quiet is quiet' ! -s "$work/err"
(cd "$work" && "$binary" run --out run --resume "${good[@]}" "${fast[@]}" --rounds 3 --json --report -q >out 2>page)
is 'the path of the page is not among the JSON' "$(cat "$work/page")" = reports/run/index.html
if python3 -c 'import json,sys; d=json.load(open(sys.argv[1])); assert d["cells"][0]["repetitions"]==3' "$work/out"; then
  ok 'the table as JSON'
else
  bad 'the table as JSON' "$(head -c 300 "$work/out")"
fi
if python3 - "$work/run/cells.jsonl" <<'P'; then ok 'every line is strict JSON of version 5'; else bad 'every line is strict JSON of version 5'; fi
import json, sys
def no(x): raise ValueError(x)
for line in open(sys.argv[1]):
    assert json.loads(line, parse_constant=no)["version"] == 5
P

once=(--frame-seconds 0.02 --frames-max 5 --views 1 --reference-error 0.1 --reference-samples 16 -q)
try run "${good[@]}" "${once[@]}" --rounds 1 --target rgba8,rgba16f --out "$work/limits"
is 'a run calibrates once a target format' "$(grep -c '"kind":"treeline-calibration"' "$work/limits/cells.jsonl")" -eq 2
try run "${good[@]}" "${once[@]}" --rounds 2 --target rgba8,rgba16f --out "$work/limits" --resume
is 'a resumed run does not calibrate again' "$(grep -c '"kind":"treeline-calibration"' "$work/limits/cells.jsonl")" -eq 2
is 'its results are all there' "$(told "$work/limits/cells.jsonl")" -eq 7
try calibrate --seconds 0.05 --size 128x128 --threads 1
is 'calibrate prints a row for each kind of work' $rc -eq 0 -a "$(grep -cE '^[a-z_0-9]+ +[0-9.e+]+ ' "$work/out")" -eq 23
try calibrate --seconds 0.05 --size 128x128 --json
is 'calibrate --json prints the record' "$(python3 -c 'import json,sys; d=json.load(open(sys.argv[1])); print(all(m["rate"] > 0 for m in d["measures"].values()))' "$work/out")" = True
refuses 'a picture too small to calibrate on' 64 "--size: '3x3' is not WxH in pixels, each side in 128..2048" calibrate --size 3x3
for verb in 'calibrate' 'run --scene tiny --method null' 'render --scene tiny --method null -o x.png'; do
  refuses "$verb: a back end that is none" 65 "'foo' is not one of" $verb --backend foo
done
refuses 'a target that is none' 64 "--target: 'rgb' is not one of" calibrate --target rgb
try shaders -q -o "$work/shaders"
is 'shaders draws its maps' $rc -eq 0 -a -s "$work/shaders/shaders.png" -a -s "$work/shaders/shaders.gp"
is 'the exact forms of shaders err by hundredths, those of the paper by most of it' "$(awk '
  function off(x, y) {return x > y ? x - y : y - x}
  /^[0-9]/ {n++; for (k = 4; k < 6; k++) {exact[k] += off($(k + 3), $k); paper[k] += off($(k + 6), $k); all[k] += $k}}
  END {print (n == 2709 && exact[4] < 0.01 * all[4] && exact[5] < 0.03 * all[5] && paper[4] > 0.5 * all[4] &&
    paper[5] > 0.3 * all[5])}' "$work/shaders/shaders.dat")" = 1
refuses 'an argument that shaders does not have' 64 "'x' is too much" shaders x

# 4. Cells that fail are results.
try run --scene tiny --method "$plugins/bad.so:way=none,crash,exit-1,nan" --trees 1 --size 32x24 "${fast[@]}" --rounds 1 --out "$work/fails" -q
is 'failed cells end in 77' $rc -eq 77
is 'all of them are in the file' "$(told "$work/fails/cells.jsonl")" -eq 5
is 'a crash is called a crash' "$(grep -c '"status":"crash"' "$work/fails/cells.jsonl")" -eq 2
try run --scene tiny --method "$plugins/bad.so:way=none,crash,exit-1,nan" --trees 1 --size 32x24 "${fast[@]}" --rounds 1 --out "$work/fails" --resume
is 'resuming keeps failures' "$(told "$work/fails/cells.jsonl")" -eq 5
is 'and says so' "$(grep -c '3 repetitions failed before; --retry' "$work/err")" -eq 1
try run --scene tiny --method "$plugins/bad.so:way=none,crash,exit-1,nan" --trees 1 --size 32x24 "${fast[@]}" --rounds 1 --out "$work/fails" -q --resume --retry
is '--retry runs them again' "$(told "$work/fails/cells.jsonl")" -eq 8
try run --scene tiny --method "$plugins/bad.so:way=hang" --trees 1 --size 32x24 "${fast[@]}" --rounds 1 --timeout 0.5 --out "$work/hang" -q
is 'a timeout is a result' "$(grep -c '"status":"timeout"' "$work/hang/cells.jsonl")" -eq 1
"$binary" report "$work/hang" --out "$work/hang-page" -q
replay=$(python3 -c 'import html,re,sys; print(html.unescape(re.search("<pre>[.]/treeline (run --cell .*)</pre>", open(sys.argv[1]).read())[1]))' \
  "$work/hang-page/index.html")
eval "timeout 30 '$binary' $replay --rounds 1 --out '$work/replayed' -q" >/dev/null 2>&1
is 'the command of a failure fails the same way' "$(grep -c '"status":"timeout"' "$work/replayed/cells.jsonl")" -eq 1
filter="tiny/(null|[it's])"
try run "${good[@]}" "${fast[@]}" --rounds 1 --filter "$filter" --out "$work/quoted" -q
eval "set -- $(python3 -c 'import json,sys; print(json.loads(open(sys.argv[1]).readline())["command"])' "$work/quoted/cells.jsonl")"
is 'a shell reads the stored command back' "$(printf '%s\n' "$@" | grep -cxF -- "$filter")" -eq 1

# 5. Interruption. The slow method takes 50 ms a frame.
slow=(--scene tiny --method "$plugins/bad.so:way=slow" --trees 1 --size 32x24,33x24,34x24 --frame-seconds 0.2
  --views 1 --rounds 3 --reference-error 0.1 --reference-samples 16 --no-calibrate)
# wait_lines FILE N: until the file has N lines, 60 s at most
wait_lines() { for _ in $(seq 600); do [ -f "$1" ] && [ "$(told "$1")" -ge "$2" ] && return; sleep 0.1; done; }
# finish NAME DIR: resumes, and checks that each (cell, repetition) stands once
finish() {
  try run "${slow[@]}" --out "$2" -q --resume
  python3 - "$2/cells.jsonl" <<'P' >"$work/py" 2>&1
import json, sys
rows = [r for r in map(json.loads, open(sys.argv[1])) if "cell" in r]
keys = [(r["cell"], r["repetition"]) for r in rows]
assert len(keys) == len(set(keys)) == 9, keys
assert all(r["status"] == "ok" for r in rows)
P
  if [ $? -eq 0 ] && [ $rc -eq 0 ]; then ok "$1"; else bad "$1" "exit code $rc" "$(tail -3 "$work/py")"; fi
}
for signal in INT TERM; do
  dir=$work/stop-$signal
  "$binary" run "${slow[@]}" --out "$dir" -q >"$work/out" 2>"$work/err" &
  pid=$!
  wait_lines "$dir/cells.jsonl" 3
  before=$(told "$dir/cells.jsonl")
  start=$SECONDS
  kill -$signal $pid
  wait $pid; rc=$?
  is "SIG$signal ends in 130" $rc -eq 130
  is "SIG$signal ends soon" $((SECONDS - start)) -le 3
  is "SIG$signal is told in one line that names --resume" "$(grep -c -- '--resume' "$work/err")" -eq 1
  is "SIG$signal loses no finished repetition" "$(told "$dir/cells.jsonl")" -ge "$before"
  is "SIG$signal leaves no half line" "$(tail -c 1 "$dir/cells.jsonl" | od -An -c | tr -d ' ')" = '\n'
  finish "after SIG$signal --resume does the rest" "$dir"
done

dir=$work/killed
"$binary" run "${slow[@]}" --out "$dir" -q >/dev/null 2>&1 &
pid=$!
wait_lines "$dir/cells.jsonl" 3
refuses 'two runs into one folder are refused' 64 'another run' run "${slow[@]}" --out "$dir" -q --resume
before=$(told "$dir/cells.jsonl")
children=$(pgrep -P $pid)
{ kill -KILL $pid; wait $pid; } 2>/dev/null
is 'kill -9 loses no finished repetition' "$(told "$dir/cells.jsonl")" -ge "$before"
sleep 0.3
alive=0
for child in $children; do grep -qs '^State:[[:space:]]*[RSDTt]' "/proc/$child/status" && alive=1; done
is 'kill -9 leaves no cell running' $alive -eq 0
printf '{"version":1,"cell":"half a li' >>"$dir/cells.jsonl"
finish 'after kill -9 and a torn line --resume does the rest' "$dir"

# 6. A full disk: nothing is lost, the run says so.
if mkdir "$work/small" && mount -t tmpfs -o size=48k tmpfs "$work/small" 2>/dev/null; then
  try run "${good[@]}" "${fast[@]}" --frames-max 4000 --frame-seconds 0.5 --size 8x8 --rounds 30 --out "$work/small/run" -q
  is 'a full disk ends in a code of its own' $rc -eq 74 -o $rc -eq 77
  is 'a full disk is told' "$(grep -c 'No space left\|failed' "$work/err")" -ge 1
  is 'a full disk leaves whole lines' "$(tail -c 1 "$work/small/run/cells.jsonl" | od -An -c | tr -d ' ')" = '\n'
  umount "$work/small"
else
  skipped=$((skipped + 1))
  printf 'skipped a full disk (no tmpfs may be mounted here)\n'
fi

# 7. Pictures.
try render --scene tiny --method null --size 40x30 -o "$work/a.exr" -q
is 'render writes an EXR' $rc -eq 0 -a -s "$work/a.exr"
try render --scene tiny --method null --size 40x30 -o "$work/b.exr" -q
is 'the same cell is the same file' $rc -eq 0 -a "$(cmp "$work/a.exr" "$work/b.exr" && echo same)" = same
# A tile of the sheet is the picture that render and reference give alone; a frame is the path's view.
camera=(--scene tiny --trees 3 --size 64x48 --eye 0,5,40 --target 0,5,0)
tile() { oiiotool "$work/sheet.png" --cut "64x48+$1+$2" -o "$work/tile.png" && idiff -q -fail 0 "$work/tile.png" "$3"; }
try render "${camera[@]}" --method null --method billboards --sheet --distances 80,40 -o "$work/sheet.png" -q
is 'a sheet is written' $rc -eq 0 -a -s "$work/sheet.png" -a ! -s "$work/out"
try render "${camera[@]}" --method billboards -o "$work/one.png" -q
is 'its tiles are the pictures of render' "$(tile $((14 + 64 + 10)) $((34 + 24 + 2 * (48 + 44))) "$work/one.png" && echo same)" = same
try reference "${camera[@]}" --standard-error 0.006 --samples 1024 -o "$work/one.png" -q
is 'and those of reference' "$(tile $((14 + 64 + 10)) $((34 + 24)) "$work/one.png" && echo same)" = same
try render --scene walk-in --trees 3 --method billboards --size 41x30 --frames "$work/frames" --frames-count 4
is 'the frames of a path are written' $rc -eq 0 -a "$(ls "$work"/frames/frame-0000[1-4].png | wc -l)" -eq 4
try render --scene walk-in --trees 3 --method billboards --size 41x30 --time 1 -o "$work/one.png" -q
is 'the last frame is the end of the path' "$(idiff -q -fail 0 "$work/one.png" "$work/frames/frame-00004.png" && echo same)" = same
if command -v ffmpeg >/dev/null; then
  is 'and a video' "$(ffprobe -v error -count_frames -show_entries stream=nb_read_frames -of csv=p=0 "$work/frames/path.mp4")" = 4
fi
PATH=/nowhere try render --scene tiny --method null --size 40x30 --frames "$work/silent" --frames-count 2
is 'without ffmpeg there is no video, which is said' $rc -eq 0 -a -s "$work/silent/frame-00002.png" -a "$(grep -c 'no video: ffmpeg: not found' "$work/err")" -eq 1
try render tiny/null/size=40x30 --eye 0,2,30 --target 0,5,0 -o "$work/c.png"
is 'render takes a cell and a camera, and says what it wrote on stderr' $rc -eq 0 -a -s "$work/c.png" -a ! -s "$work/out" -a -s "$work/err"
try reference --scene tiny --size 40x30 --effects none --samples 16 --standard-error 0 -o "$work/r.exr" -q
is 'reference writes an EXR' $rc -eq 0 -a -s "$work/r.exr"
if command -v oiiotool >/dev/null; then
  is 'with the variance of each channel' "$(oiiotool --info -v "$work/r.exr" | grep -c 'variance.R')" -ge 1
fi
prints 'diff compares them' 'rmse' diff "$work/a.exr" "$work/r.exr"
prints 'the cache can be trimmed' 'MB removed' cache trim 1k
prints 'the cache can be cleared' 'MB removed' cache clear
is 'a cleared cache is empty' -z "$(ls -A "$work/cache" 2>/dev/null)"

echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
