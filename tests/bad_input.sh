#!/usr/bin/env bash
# Bad input by hand: cut, malformed, absurd, cyclic, deep; folders, pipes, devices, links; read-only and full disks; two
# runs at once. Each ends in one line that names the thing, with the documented exit code, soon, and loses nothing.
# tests/bad_input.sh [BINARY]
set -u
. "$(dirname "$0")/shell.sh"
top=$PWD
[ -f "$plugins/bad.so" ] || make -s plugins >/dev/null
fast=(--trees 1 --size 32x24 --no-calibrate --frame-seconds 0.02 --frames-max 5 --views 1 --rounds 1 --reference-error 0.1 --reference-samples 16 -q)
cd "$work" || exit 1
PLUGINS=$plugins python3 - "$top" <<'P' || exit 1
# The files: scenes s-NAME.json, meshes with a scene each, results r-NAME/cells.jsonl, plans p-NAME.json, pictures.
import base64, json, os, struct, sys, zlib
top = sys.argv[1]
def put(name, data):
    os.makedirs(os.path.dirname(name) or ".", exist_ok=True)
    open(name, "wb").write(data if isinstance(data, bytes) else data.encode())
scene = {"size": [32, 24], "plants": [{"generator": "poplar"}], "placement": {"kind": "grid", "spacing_m": 5},
         "camera": {"kind": "still", "keys": [{"eye": [0, 5, 30], "target": [0, 5, 0]}]}}
text = json.dumps(scene, indent=1)
def s(name, data): put(f"s-{name}.json", data if isinstance(data, (str, bytes)) else json.dumps(data))
s("good", scene)
s("empty", "")
s("cut", text[:90])
s("brackets", "[" * 100000)
s("braces", '{"a":' * 100000 + "1" + "}" * 100000)
s("nul", text.encode() + b"\0")
s("nul-escape", text.replace("poplar", "poplar\\u0000"))
s("latin", text.replace("poplar", "p\xe9").encode("latin-1"))
s("utf16", text.encode("utf-16"))
s("list", "[]")
s("twice", text.replace('"placement"', '"size": [1, 1],\n"placement"'))
s("bom", b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode())
s("\u00e9 \"it's\" \u6728", scene)
for name, value in {"1e30": "1e30", "minus-zero": "-0", "nan": "NaN", "2e63": "9223372036854775808", "1e999": "1e999",
                    "text": '"x"', "list-in": "[]", "null": "null", "half": "0.5", "true": "true"}.items():
    s("side-" + name, text.replace("  32,", f"  {value},"))
s("many-plants", {**scene, "plants": [{"generator": "poplar", "name": str(i)} for i in range(300)]})
s("numbers", '{"plants": [' + ",".join(["1"] * 8000000) + "]}")
s("rows-self", {**scene, "placement": {"kind": "file", "file": "s-rows-self.json"}})
s("rows-folder", {**scene, "placement": {"kind": "file", "file": "folder"}})
s("rows-nul", {**scene, "placement": {"kind": "file", "file": "rows"}})
put("rows", b"1 2\n3 4\0\n5 6\n")
s("ground-self", {**scene, "terrain": {"size_m": [100, 100], "image": "s-ground-self.json", "height_m": 3}})
s("ground-folder", {**scene, "terrain": {"size_m": [100, 100], "image": "folder", "height_m": 3}})
s("plant-self", {**scene, "plants": [{"file": "s-plant-self.json"}]})
os.mkdir("folder"); os.mkdir("folder.obj"); os.mkdir("folder.so"); os.mkdir("s-folder.json")
for name in ("pipe", "pipe.obj", "pipe.so", "pipe.png"):
    os.mkfifo(name)
for name in ("loop.obj", "loop.so", "s-loop.json"):
    os.symlink(name, name)

def mesh(name, data, **more):
    put(name, data)
    s(name, {**scene, "plants": [{"file": name, **more}]})
v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
mesh("good.obj", v + "f 1 2 3\n")
mesh("empty.obj", ""); mesh("empty.ply", ""); mesh("empty.glb", "")
mesh("bare.obj", v)
mesh("index.obj", v + "f 1 2 99999999999\n")
mesh("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
mesh("inf.obj", "v 1e39 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
mesh("high.obj", "v 0 1e30 0\nv 1e30 0 0\nv 0 0 0\nf 1 2 3\n")
mesh("low.obj", "v 0 1e-30 0\nv 1e-30 0 0\nv 0 0 0\nf 1 2 3\n")
mesh("dot.obj", "v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n")
mesh("library-pipe.obj", "mtllib pipe\n" + v + "f 1 2 3\n")
mesh("library-zero.obj", "mtllib /dev/zero\n" + v + "f 1 2 3\n")
mesh("library-none.obj", "mtllib none.mtl\n" + v + "f 1 2 3\n")
put("pipe.mtl", "newmtl a\nmap_Kd pipe.png\n"); put("self.mtl", "newmtl a\nmap_Kd self.mtl\n")
for name in ("pipe", "self"):
    mesh(f"texture-{name}.obj", f"mtllib {name}.mtl\nvt 0 0\nusemtl a\n{v}f 1/1 2/1 3/1\n")
for name in ("folder.obj", "pipe.obj", "loop.obj", "none.obj", "mesh.fbx"):
    s(name, {**scene, "plants": [{"file": name}]})
points = base64.b64encode(struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 2, 0)).decode()
def gltf(uri="data:application/octet-stream;base64," + points, nodes=({"mesh": 0},), count=3, size=36):
    return json.dumps({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": nodes,
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "buffers": [{"byteLength": size, "uri": uri}],
        "bufferViews": [{"buffer": 0, "byteLength": size}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3"}]})
mesh("good.gltf", gltf())
mesh("cut.gltf", gltf()[:150])
mesh("cycle.gltf", gltf(nodes=[{"mesh": 0, "children": [1]}, {"children": [0]}]))
mesh("own-child.gltf", gltf(nodes=[{"mesh": 0, "children": [0]}]))
mesh("deep-nodes.gltf", gltf(nodes=[{"children": [i + 1]} for i in range(20000)] + [{"mesh": 0}]))
mesh("brackets.gltf", "[" * 100000)
mesh("no-child.gltf", gltf(nodes=[{"mesh": 0, "children": [77]}]))
mesh("count.gltf", gltf(count=2 ** 40)); mesh("negative.gltf", gltf(count=-1)); mesh("length.gltf", gltf(size=2 ** 62))
mesh("buffer-pipe.gltf", gltf("pipe")); mesh("buffer-zero.gltf", gltf("/dev/zero")); mesh("buffer-self.gltf", gltf("buffer-self.gltf"))
mesh("buffer-folder.gltf", gltf("folder")); mesh("buffer-none.gltf", gltf("none.bin"))
mesh("base64.gltf", gltf("data:application/octet-stream;base64,!!!!"))
mesh("cut.glb", b"glTF\2\0\0\0\xff\xff\xff\xff")
mesh("long.glb", b"glTF" + struct.pack("<IIII", 2, 2 ** 31, 2 ** 31 - 30, 0x4E4F534A) + b"{}")
mesh("count.ply", "ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nend_header\n0\n")
mesh("list.ply", b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty list uint float x\nend_header\n\xff\xff\xff\xff1234")

# Folders of pictures.
def cameras(name, data):
    put(f"i-{name}/cameras.json", data if isinstance(data, str) else json.dumps(data))
    s("i-" + name, {**scene, "plants": [{"images": "i-" + name}]})
view = {"kind": "orthographic", "color": "c.png", "depth": "d.png", "position_m": [0, 0, 5], "direction": [0, 0, -1], "extent_m": [2, 2]}
box = {"minimum_m": [-1, -1, -1], "maximum_m": [1, 1, 1]}
cameras("cut", '{"minimum_m": [')
cameras("none", {**box, "views": []})
cameras("many", {**box, "views": [view] * 65})
cameras("flat", {**box, "maximum_m": [1, -1, 1], "views": [view]})
cameras("key", {**box, "views": [{**view, "roll": 3}]})
cameras("still", {**box, "views": [{**view, "direction": [0, 0, 0]}]})
cameras("up", {**box, "views": [{**view, "up": [0, 0, 3]}]})
cameras("wide", {**box, "views": [{**view, "kind": "pinhole", "fov_y_deg": 180}]})
cameras("kind", {**box, "views": [{**view, "kind": "fisheye"}]})
cameras("absent", {**box, "views": [view]})
cameras("pipe", {**box, "views": [{**view, "color": "../pipe"}]})
cameras("words", {**box, "views": [view]})
cameras("sizes", {**box, "views": [view]})
cameras("empty", {**box, "views": [view]})
cameras("no-z", {**box, "views": [{**view, "depth": "c.png"}]})
os.mkdir("i-bare"); s("i-bare", {**scene, "plants": [{"images": "i-bare"}]})
s("i-file", {**scene, "plants": [{"images": "s-good.json"}]})
s("i-both", {**scene, "plants": [{"images": "i-bare", "generator": "oak"}]})
s("i-grid", {**scene, "plants": [{"images": "i-bare", "coloring": {"grid": 257}}]})
s("i-alone", {**scene, "plants": [{"generator": "oak", "coloring": {}}]})

lines = open(f"{top}/tests/results-v1/cells.jsonl").read().split("\n")
head, line = lines[0], lines[1]
def r(name, data): put(f"r-{name}/cells.jsonl", data)
r("good", f"{head}\n{line}\n"); r("crlf", f"{head}\r\n{line}\r\n"); r("bom", b"\xef\xbb\xbf" + f"{head}\n{line}\n".encode())
r("empty", ""); r("cut-head", head[:50]); r("head", head + "\n")
r("newer", f"{head}\n{line}\n".replace('"version":1', '"version":999'))
r("newer-line", f"{head}\n" + line.replace('"version":1', '"version":999') + "\n")
r("middle", f"{head}\n{line[:80]}\n{line}\n"); r("no-head", line + "\n"); r("nul", head.encode() + b"\na\0b\n")
r("words", "my thesis\n"); r("key", f"{head}\n" + line.replace('"repetition"', '"zzz":3,"repetition"') + "\n")
r("type", f"{head}\n" + line.replace('"frame_seconds":[', '"frame_seconds":["x",') + "\n")
r("deep", f"{head}\n" + "[" * 100000 + "\n")
os.mkdir("r-folder"); os.mkdir("r-folder/cells.jsonl"); os.mkdir("r-none"); os.mkdir("r-loop"); os.symlink("cells.jsonl", "r-loop/cells.jsonl")

def p(name, **plan): put(f"p-{name}.json", json.dumps(plan))
many = ",".join(["1"] * 2000)
tiny = {"scenes": ["tiny"], "methods": ["null"]}
p("sizes", **tiny, trees=many, sizes=",".join(["9x9"] * 2000), targets=",".join(["rgba8"] * 2000))
p("options", scenes=["tiny"], methods=[f"billboards:views={many},samples={many},filter={many.replace('1', 'nearest')}"])
p("nothing"); p("text", scenes="tiny", methods=["null"]); p("number", scenes=[7], methods=["null"])
p("self", cells=["p-self.json/null"]); p("rounds", rounds=1e30, **tiny); p("seed", seed=2 ** 63, **tiny)
p("items", trees="1,,2", **tiny); p("zero", sizes="0x0", **tiny); p("group", groups=[[]], **tiny)

def chunk(kind, data): return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
def png(width, height): return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)) +
                                chunk(b"IDAT", zlib.compress(b"0")) + chunk(b"IEND", b""))
put("wide.png", png(2 ** 31 - 1, 2 ** 31 - 1)); put("thin.png", png(8000, 8000)); put("cut.png", png(2, 2)[:40]); put("empty.png", "")
put("noise.exr", b"\x76\x2f\x31\x01" + bytes(range(200))); put("words.png", "words")
def white(width, height):
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress((b"\0" + b"\xff" * 3 * width) * height)) + chunk(b"IEND", b""))
for name in ("sizes", "empty", "no-z"):
    put(f"i-{name}/c.png", white(4, 4)); put(f"i-{name}/d.png", white(4, 5 if name == "sizes" else 4))
put("i-words/c.png", "words"); put("i-words/d.png", "words")
plugin = open(f"{os.environ['PLUGINS']}/bad.so", "rb").read()
for size in (0, 10, 100, 1000, 9000):
    put(f"cut-{size}/bad.so", plugin[:size])
put("words.so", "words" * 100)
P

# 1. Scenes.
scene() { refuses "$1" "$2" "$3" run --scene "$4" --method null --trees 1 --dry-run; }
scene 'a scene without a byte' 65 's-empty.json: is empty' s-empty.json
scene 'a scene cut short' 65 "s-cut.json:[0-9]+: not JSON near" s-cut.json
scene '100,000 brackets' 65 's-brackets.json:1: is nested deeper than 64' s-brackets.json
scene '100,000 braces' 65 's-braces.json:1: is nested deeper than 64' s-braces.json
scene 'a NUL byte' 65 's-nul.json: not JSON: a NUL byte at' s-nul.json
scene 'a NUL in a text' 65 's-nul-escape.json:[0-9]+: a text holds .u0000' s-nul-escape.json
scene 'Latin-1' 65 's-latin.json:[0-9]+: not JSON: a byte that is not UTF-8' s-latin.json
scene 'UTF-16' 65 's-utf16.json: not JSON' s-utf16.json
scene 'a list instead of a scene' 65 's-list.json: is not an object' s-list.json
scene 'a key that stands twice' 65 's-twice.json: size: stands here twice' s-twice.json
scene 'a folder' 65 's-folder.json: is not a regular file' s-folder.json
scene 'a link to itself' 66 's-loop.json' s-loop.json
scene 'a path through a file' 66 's-good.json/x.json' s-good.json/x.json
scene 'a name of 5,000 letters' 66 'a{300}' "$(printf 'a%.0s' $(seq 5000)).json"
scene 'too many plants' 65 'plants: has 300 elements; allowed: 1..256' s-many-plants.json
scene '8 million numbers' 65 's-numbers.json: .*allowed' s-numbers.json
for v in 1e30:'1e.30' minus-zero:-0 2e63:9.223372037e.18 half:0.5; do
  scene "a side of ${v%%:*}" 65 "size.0.: value is ${v#*:}; allowed: 1..16384" "s-side-${v%%:*}.json"
done
scene 'a side of 1e999' 65 'size.0.: is too large a number' s-side-1e999.json
scene 'a side of NaN' 65 "not JSON near 'NaN" s-side-nan.json
for v in text:'a text' list-in:'a list' null:null true:'true or false'; do
  scene "a side that is ${v#*:}" 65 "size.0.: is ${v#*:}; allowed: a number" "s-side-${v%%:*}.json"
done
try run --scene s-bom.json --method null --trees 1 --dry-run
is 'a byte order mark and carriage returns are taken' $rc -eq 0
name="s-é \"it's\" 木.json"
try run --scene "$name" --method null "${fast[@]}" --out "o é \"it's\" 木"
is 'names of any letters are taken' $rc -eq 0
try run --resume --cell "$(tail -n 1 "o é \"it's\" 木/cells.jsonl" | python3 -c 'import json,sys; print(json.loads(sys.stdin.read())["cell"])')" "${fast[@]:4}" --out "o é \"it's\" 木"
is 'and their results are found again' $rc -eq 0 -a "$(told "o é \"it's\" 木/cells.jsonl")" -eq 2
latin=$(printf 's-\xe9.json')
cp s-good.json "$latin"
try run --scene "$latin" --method null "${fast[@]}" --out latin
is 'a name that is not UTF-8 leaves results that are' $rc -eq 0 -a "$(python3 -c 'import json; print(sum("cell" in json.loads(l) for l in open("latin/cells.jsonl", encoding="utf-8")))')" = 1

# 2. What a scene names: rows, height images, meshes.
draw() { refuses "$1" "$2" "$3" render --scene "s-$4.json" --method polygons --trees 1 --size 16x12 -o x.png; }
draw 'rows that are the scene itself' 65 's-rows-self.json:1:' rows-self
draw 'rows that are a folder' 65 'placement.file: .*folder: is not a regular file' rows-folder
draw 'rows behind a NUL' 65 'rows: a NUL byte at 7' rows-nul
draw 'a height image that is the scene itself' 65 'terrain.image: .*no picture' ground-self
draw 'a height image that is a folder' 65 'terrain.image: .*folder: is not a regular file' ground-folder
draw 'a plant that is the scene itself' 65 's-plant-self.json: is not a mesh format' plant-self
draw 'an unknown mesh format' 65 'allowed: .obj, .ply, .gltf, .glb' mesh.fbx
draw 'a mesh that is not there' 66 'none.obj: No such file' none.obj
draw 'a mesh that is a folder' 65 'folder.obj: is not a regular file' folder.obj
draw 'a mesh that is a pipe' 65 'pipe.obj: is not a regular file' pipe.obj
draw 'a mesh that is a link to itself' 74 'loop.obj: Too many levels' loop.obj
for kind in obj ply glb; do draw "an empty .$kind" 65 "empty.$kind: is empty" empty.$kind; done
draw 'a mesh without triangles' 65 'bare.obj: ' bare.obj
draw 'a corner far outside' 65 'index.obj: .*out of range' index.obj
draw 'a vertex that is NaN' 65 'nan.obj: vertex 0 .*not finite' nan.obj
draw 'a vertex above all floats' 65 'inf.obj: vertex 0 .*not finite' inf.obj
draw 'a mesh of 1e30 m' 65 'high.obj: is 1e.30 m high; allowed: 0.001..1000' high.obj
draw 'a mesh of 1e-30 m' 65 'low.obj: is 1e-30 m high; allowed: 0.001..1000' low.obj
draw 'a mesh that is a dot' 65 'dot.obj: none of its 1 triangles has an area' dot.obj
draw 'a material library that is a pipe' 65 'pipe: is not a regular file' library-pipe.obj
draw 'a material library that never ends' 65 '/dev/zero: is not a regular file' library-zero.obj
draw 'a material library that is not there' 66 "material library 'none.mtl' does not exist" library-none.obj
draw 'a texture that is a pipe' 65 'pipe.png: is not a regular file' texture-pipe.obj
draw 'a texture that is its own library' 65 'self.mtl: no picture' texture-self.obj
draw 'a glTF cut short' 65 'cut.gltf: ' cut.gltf
draw 'nodes in a circle' 65 'cycle.gltf: .*recursive' cycle.gltf
draw 'a node that is its own child' 65 'own-child.gltf: .*recursive' own-child.gltf
draw '20,000 nodes deep' 65 'deep-nodes.gltf: ' deep-nodes.gltf
draw '100,000 brackets of a glTF' 65 'brackets.gltf: ' brackets.gltf
draw 'a child that is not there' 65 'no-child.gltf: .*77' no-child.gltf
draw '2^40 vertices' 65 'count.gltf: ' count.gltf
draw '-1 vertices' 65 'negative.gltf: ' negative.gltf
draw 'a buffer of 2^62 bytes' 65 'length.gltf: ' length.gltf
draw 'a buffer that is a pipe' 65 'buffer-pipe.gltf: .*pipe: is not a regular file' buffer-pipe.gltf
draw 'a buffer that never ends' 65 '/dev/zero: is not a regular file' buffer-zero.gltf
draw 'a buffer that is the glTF itself' 65 'buffer-self.gltf: none of its 1 triangles' buffer-self.gltf
draw 'a buffer that is a folder' 65 'folder: is not a regular file' buffer-folder.gltf
draw 'a buffer that is not there' 65 'none.bin' buffer-none.gltf
draw 'a buffer that is not base64' 65 'base64.gltf: ' base64.gltf
draw 'a GLB cut short' 65 'cut.glb: ends after 12 of 20 bytes' cut.glb
draw 'a GLB that says it is longer than it is' 65 'long.glb: ends after 22 of 2147483648 bytes' long.glb
draw '10^11 elements of a PLY' 65 'count.ply: ends after 1 of 99999999999' count.ply
draw 'a PLY list of 2^32 numbers' 65 'list.ply: ' list.ply
try render --scene s-good.gltf.json --method polygons --trees 1 --size 16x12 -o x.png -q
is 'the good glTF among them is drawn' $rc -eq 0 -a -s x.png
draw 'no cameras.json' 66 'i-bare/cameras.json: No such file' i-bare
draw 'a file instead of a folder' 74 's-good.json/cameras.json: ' i-file
draw 'a cameras.json cut short' 65 'i-cut/cameras.json:1: not JSON' i-cut
draw 'no view' 65 'i-none/cameras.json: views: has 0 elements; allowed: 1..64' i-none
draw '65 views' 65 'i-many/cameras.json: views: has 65 elements; allowed: 1..64' i-many
draw 'a flat box' 65 'maximum_m: value is -1 along y, minimum_m is -1; allowed: above it' i-flat
draw 'an unknown key of a view' 65 'views.0..roll: is not a key' i-key
draw 'a camera that looks nowhere' 65 'views.0..direction: value is .0, 0, 0.; allowed: any other' i-still
draw 'a camera whose top is before it' 65 'views.0..up: is along direction; allowed: across it' i-up
draw 'a view of 180 degrees' 65 'views.0..fov_y_deg: value is 180; allowed: 0.1..170' i-wide
draw 'a fisheye' 65 "views.0..kind: value is 'fisheye'; allowed: pinhole.orthographic" i-kind
draw 'a picture that is not there' 66 'i-absent/c.png: No such file' i-absent
draw 'a picture that is a pipe' 65 'pipe: is not a regular file' i-pipe
draw 'words instead of a picture' 65 'i-words/c.png: no picture' i-words
draw 'a depth of another size' 65 'd.png: is 4 x 5 pixels, .*c.png 4 x 4; allowed: the same size' i-sizes
draw 'a depth in a picture that has none' 65 'c.png: has no channel Z' i-no-z
draw 'pictures of nothing' 65 'i-empty: no voxel is coloured: 0 are carved' i-empty
scene 'images beside a generator' 65 'plants.0..generator: stands beside images; allowed: either' s-i-both.json
scene 'a grid of 257' 65 'coloring.grid: value is 257; allowed: 2..256' s-i-grid.json
scene 'a coloring without images' 65 'plants.0..coloring: stands without images' s-i-alone.json

# 3. Plans.
plan() { refuses "$1" 65 "$2" run "$3" --dry-run; }
plan 'eight billion cells of one name' 'p-sizes.json: .*more than 100000 cells' p-sizes.json
plan 'eight billion options' 'p-options.json: .*more than 100000 cells' p-options.json
plan 'a plan of nothing' 'p-nothing.json: no scene' p-nothing.json
plan 'a text instead of a list' 'p-text.json: scenes: is a text; allowed: a list' p-text.json
plan 'a number instead of a name' 'p-number.json: scenes.0.: is a number; allowed: a text' p-number.json
plan 'a plan that is its own scene' 'p-self.json: plants' p-self.json
plan '1e30 rounds' 'p-rounds.json: rounds: value is 1e.30; allowed: 1..10000' p-rounds.json
plan 'a seed of 2^63' 'p-seed.json: seed: value is' p-seed.json
plan 'an empty item' "p-items.json: trees: '1,,2' has an empty item" p-items.json
plan 'pictures of no size' "p-zero.json: size: '0x0' is not" p-zero.json
plan 'a group that is a list' 'p-group.json: groups.0.: is a list; allowed: an object' p-group.json
plan 'a device as a plan' '/dev/null: is not a regular file' /dev/null

# 4. Pictures.
for f in wide thin cut empty words; do refuses "a PNG that is $f" 65 "$f.png: no picture can be read" diff $f.png $f.png; done
refuses 'an EXR of noise' 65 'noise.exr: no picture can be read' diff noise.exr noise.exr
refuses 'a picture that is a folder' 65 'folder: is a folder' diff folder folder
refuses 'a picture that never ends' 65 '/dev/zero: is not a regular file' diff /dev/zero /dev/zero
refuses 'a picture that is a link to itself' 74 'loop.obj' diff loop.obj loop.obj

# 5. Results.
report() { refuses "$1" "$2" "$3" report "r-$4" --out page; }
report 'no byte of results' 65 'cells.jsonl: holds no whole line' empty
report 'half a first line' 65 'cells.jsonl: holds no whole line' cut-head
report 'results without a result' 65 'r-head: holds no result' head
report 'a newer version' 65 'cells.jsonl:1: version: value is 999; this treeline reads version' newer
report 'a newer line' 65 'cells.jsonl:2: version: value is 999; this treeline reads version' newer-line
report 'a malformed line in the middle' 65 'cells.jsonl:2:1: not JSON near' middle
report 'results without their first line' 65 'cells.jsonl:1: kind' no-head
report 'a NUL among results' 65 'cells.jsonl:2: a NUL byte' nul
report 'words instead of results' 65 'cells.jsonl:1:1: not JSON' words
report 'an unknown key' 65 'cells.jsonl:2: zzz: is not a key' key
report 'a text among seconds' 65 'cells.jsonl:2: frame_seconds.0.: is a text; allowed: a number' type
report 'a line of 100,000 brackets' 65 'cells.jsonl:2:1: is nested deeper' deep
report 'results that are a folder' 65 'cells.jsonl: is not a regular file' folder
report 'results that are not there' 66 'r-none/cells.jsonl: No such file' none
report 'results that are a link to themselves' 74 'Too many levels' loop
for kind in crlf bom; do try report r-$kind --out page-$kind; is "results with $kind are taken" $rc -eq 0; done
refuses 'a page into a file' 74 's-good.json.*Not a directory' report r-good --out s-good.json
# resume keeps NAME CODE PATTERN FOLDER: refused, and the file is what it was, with and without --resume
keeps() {
  local before
  before=$(md5sum <"$4/cells.jsonl")
  refuses "$1" "$2" "$3" run --scene tiny --method null "${fast[@]}" --out "$4"
  refuses "$1, resumed" "$2" "$3" run --scene tiny --method null "${fast[@]}" --out "$4" --resume
  is "$1 are left as they were" "$before" = "$(md5sum <"$4/cells.jsonl")"
}
mkdir thesis later own
printf 'my thesis, without a newline' >thesis/cells.jsonl
{ head -1 r-newer/cells.jsonl; printf '{"version":999,"cell":"ha'; } >later/cells.jsonl
keeps 'words where results go' 65 'thesis/cells.jsonl: holds no whole line' thesis
keeps 'results of a newer version, cut,' 65 'later/cells.jsonl:1: version' later
head -c 50 latin/cells.jsonl >own/cells.jsonl
try run --scene tiny --method null "${fast[@]}" --out own
is 'a first line that was cut is written anew' $rc -eq 0 -a "$(told own/cells.jsonl)" -eq 2

# 6. Plugins.
plugin() { refuses "$1" "$2" "$3" run --scene tiny --method "$4" --trees 1 --dry-run; }
plugin 'words' 65 'words.so: is not a loadable method' ./words.so
plugin 'a folder as a plugin' 65 'folder.so: is not a regular file' ./folder.so
plugin 'a pipe as a plugin' 65 'pipe.so: is not a regular file' ./pipe.so
plugin 'a link to itself as a plugin' 66 'loop.so: Too many levels' ./loop.so
for n in 0 10 100; do plugin "a plugin of $n bytes" 65 'bad.so: is not a loadable' "./cut-$n/bad.so"; done
for n in 1000 9000; do plugin "a plugin of $n bytes, which the loader dies of" 76 'bad.so: dies of signal' "./cut-$n/bad.so"; done
plugin 'a library that is no plugin' 65 "does not define 'const struct method treeline_image_method" "$(dirname "$binary")/treeline_image.so"

# 7. Where nothing can be written.
run() { refuses "$1" "$2" "$3" run --scene tiny --method null "${fast[@]}" --out "$4"; }
run 'a run into a file' 74 's-good.json: is not a folder' s-good.json
run 'a run below a file' 74 's-good.json/x: .*Not a directory' s-good.json/x
run 'a run into a name too long' 74 'File name too long' "$(printf 'a%.0s' $(seq 300))"
mkdir -p locked/.lock && run 'a lock that is a folder' 74 'locked/.lock: cannot be written' locked
refuses 'a picture over a folder' 74 'over.png: cannot be written' render --scene tiny --method null --size 16x12 -o "$(mkdir over.png; echo over.png)"
is 'which leaves nothing behind' -z "$(ls -A over.png)" -a -z "$(ls -d over.png.tmp* 2>/dev/null)"
if mkdir disk && mount -t tmpfs -o size=64k tmpfs disk 2>/dev/null; then
  refuses 'a picture on a full disk' 74 'disk/a.exr: cannot be written: No space left' render --scene tiny --method null --size 640x480 -o disk/a.exr
  is 'which leaves nothing there' -z "$(ls -A disk)"
  refuses 'a page on a full disk' 74 'No space left' report r-good --out disk/page
  rm -rf disk/page
  mount -o remount,ro disk
  run 'a run on a read-only disk' 74 'disk/run: .*Read-only' disk/run
  refuses 'a picture on a read-only disk' 74 'disk/a.png: .*Read-only' render --scene tiny --method null --size 16x12 -o disk/a.png
  refuses 'a page on a read-only disk' 74 'Read-only' report r-good --out disk/page
  TREELINE_CACHE=$work/disk/cache try render --scene tiny --method null --size 16x12 -o x.png -q
  is 'a cache on a read-only disk is done without' $rc -eq 0
  umount disk
else
  skipped=$((skipped + 1))
  printf 'skipped full and read-only disks (no tmpfs may be mounted here)\n'
fi
if [ "$(id -u)" -ne 0 ]; then
  chmod 0 s-good.obj.json
  scene 'a file that may not be read' 74 's-good.obj.json: Permission denied' s-good.obj.json
else
  skipped=$((skipped + 1))
  printf 'skipped a file that may not be read (root may read all)\n'
fi

# 8. Two runs into one folder that begin at the same moment: one runs, the other is told, every result is there once.
for i in 1 2; do
  ("$binary" run --scene tiny --method null,polygons "${fast[@]}" --out both >/dev/null 2>"err-$i"; echo $? >"rc-$i") &
done
wait
is 'of two runs at once one succeeds' "$(sort -n rc-1 rc-2 | tr '\n' ' ')" = '0 64 '
is 'the other is told why in one line' "$(cat err-1 err-2 | wc -l)" -eq 1 -a "$(grep -cE 'another run|holds a run' err-1 err-2 | grep -c ':1')" -eq 1
is 'and every result stands once' "$(told both/cells.jsonl)" -eq 3

echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
