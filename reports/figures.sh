#!/usr/bin/env bash
# Makes pictures of stacks of slices beside the ray-traced reference, all by the program:
#   reports/figures.sh FOLDER
# turning-light.png  the reference, with shadows and with the method's effects, above shaded-texels, at four times of the
#                    sun (Senegas 2001, figure 6.1)
# oblique.png        between the stacks' directions, where gaps show between slices: the reference; the slices alone; up to
#                    four times as many by interpolation; a closed mesh (64 slices), below a tree (16)
# dilation.png       close up, the published path: the reference, with and without dilation
# ghosts.png         jakulin near the camera, between two directions: the reference; mixed, exact; of 4 directions, below of 2
set -eu
[ $# = 1 ] || { echo "Usage: reports/figures.sh FOLDER" >&2; exit 2; }
mkdir -p "$1"
out=$(realpath "$1")
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

scene=() # of the pictures that follow
traced() { # NAME EFFECTS [OPTION...]
  ./treeline reference -q "${scene[@]}" --effects "$2" --standard-error 0.01 -o "$work/$1.png" "${@:3}"
}
drawn() { # NAME METHOD [OPTION...]
  ./treeline render -q "${scene[@]}" --method "$2" -o "$work/$1.png" "${@:3}"
}
mosaic() { # FILE COLUMNSxROWS NAME...
  (cd "$work" && oiiotool "${@:3}" --mosaic:pad=6 "$2" -o "$out/$1")
}
same=two-sided,ambient # what these methods model of the scenes' effects

scene=(--scene closed-mesh --size 400x300)
for time in 0 0.33 0.67 1; do
  traced "1-$time" all --time "$time"
  traced "2-$time" "$same" --time "$time"
  drawn "3-$time" shaded-texels --time "$time"
done
mosaic turning-light.png 4x3 {1,2,3}-{0,0.33,0.67,1}.png

row=0
for view in "closed-mesh -13,11,-7 -3.6,3.5,0 64" "single-tree 9,17,7 0,11,0 16"; do
  read -r name eye target slices <<<"$view"
  scene=(--scene "$name" --size 400x400 --eye="$eye" --target="$target")
  row=$((row + 1))
  traced "oblique$row-1" "$same"
  drawn "oblique$row-2" "shaded-texels:near=0,slices=$slices,criterion=0"
  drawn "oblique$row-3" "shaded-texels:near=0,slices=$slices,criterion=1,interpolate=on"
done
mosaic oblique.png 3x2 oblique{1,2}-{1,2,3}.png

scene=(--scene single-tree --size 400x400 --eye 3,14,6 --target 0,14,0)
traced dilation1 "$same"
drawn dilation2 shaded-texels:path=naive --lod high
drawn dilation3 shaded-texels:path=naive,dilate=off --lod high
mosaic dilation.png 3x1 dilation{1,2,3}.png

row=0
for directions in 4 2; do
  # half way between two directions
  eye=$([ $directions = 4 ] && echo 1.53,9,3.7 || echo 2.83,9,2.83)
  scene=(--scene single-tree --size 400x400 --eye "$eye" --target 0,9,0)
  row=$((row + 1))
  traced "ghosts$row-1" "$same"
  drawn "ghosts$row-2" "jakulin:near=0,directions=$directions"
  drawn "ghosts$row-3" "jakulin:near=0,directions=$directions,order=exact"
done
mosaic ghosts.png 3x2 ghosts{1,2}-{1,2,3}.png
