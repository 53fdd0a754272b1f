#!/usr/bin/env bash
# What other programs make of exported cases: bench/export.sh CASE... writes each in every format, reads it back by
# PlayCanvas's splat-transform and by clipgs, checks the glTF by Khronos's validator, and prints, per file, its bytes and
# how much a picture of it (1024 px) is that of the PLY, dB; then how much pictures of the PLY, whole and cut, are those of
# the case itself.
set -euo pipefail
cd "$(dirname "$0")/.."

clipgs="${CLIPGS:-build/release/src/cli/clipgs}"
peers=web/bench/peers
[ -d "$peers/node_modules/gltf-validator" ] || npm ci --silent --prefix "$peers"
transform() { "$peers/node_modules/.bin/splat-transform" -q -w "$@"; }

folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT

picture() {
  "$clipgs" --quiet render "$1" -o "$2" --size 1024x1024 --view 30,-20 2>/dev/null
}

# alike A B: dB between two pictures over black.
alike() {
  ffmpeg -v info -i "$1" -i "$2" \
    -filter_complex "[0]premultiply=inplace=1,format=gbrp[a];[1]premultiply=inplace=1,format=gbrp[b];[a][b]psnr" \
    -f null - 2>&1 | sed -n 's/.*average:\([0-9.inf]*\).*/\1/p'
}

# likeness FILE: of its picture to that of the PLY.
likeness() {
  picture "$1" "$folder/picture.png"
  alike "$folder/truth.png" "$folder/picture.png"
}

# place CASE AZIMUTH ELEVATION ZOOM: a camera, as clipgs render --camera takes it, that frames the case's sphere.
place() {
  "$clipgs" info "$1" --json | python3 -c '
import json, math, sys
info = json.load(sys.stdin)
azimuth, elevation = (math.radians(float(x)) for x in sys.argv[1:3])
size, half = 1024, math.tan(math.radians(20))
distance = info["radius_mm"] / math.sin(math.atan(0.9 * half))
back = [-math.sin(azimuth) * math.cos(elevation), math.cos(azimuth) * math.cos(elevation), math.sin(elevation)]
right = [-math.cos(azimuth), -math.sin(azimuth), 0]
up = [back[1] * right[2] - back[2] * right[1], back[2] * right[0] - back[0] * right[2], back[0] * right[1] - back[1] * right[0]]
rows = [[right[i], up[i], back[i], info["center_ras_mm"][i] + distance * back[i]] for i in range(3)]
focal = 0.5 * size / half * float(sys.argv[3])
print(json.dumps({"w": size, "h": size, "fl_x": focal, "fl_y": focal, "cx": size / 2, "cy": size / 2,
                  "transform_matrix": rows + [[0, 0, 0, 1]]}))' "$2" "$3" "$4"
}

# through_middle CASE NX,NY,NZ: the plane of that direction, made a unit vector, through the middle of the case.
through_middle() {
  "$clipgs" info "$1" --json | python3 -c '
import json, math, sys
center = json.load(sys.stdin)["center_ras_mm"]
n = [float(x) for x in sys.argv[1].split(",")]
n = [x / math.hypot(*n) for x in n]
print(*n, sum(a * b for a, b in zip(n, center)), sep=",")' "$2"
}

# beside_the_case CASE: rows of a table, of pictures from the front, from behind and close up.
beside_the_case() {
  local cut view plane dB
  place "$1" 28 20 1 >"$folder/front.json"
  place "$1" 200 -10 1 >"$folder/behind.json"
  place "$1" 20 10 2.5 >"$folder/close.json"
  for cut in whole: across:0,0,-1 oblique:0.3,-0.75,-0.55; do
    plane=()
    [ -z "${cut#*:}" ] || plane=(--plane "$(through_middle "$1" "${cut#*:}")")
    "$clipgs" --quiet export "$1" -o "$folder/cut.ply" "${plane[@]}" >/dev/null
    dB=()
    for view in front behind close; do
      "$clipgs" --quiet render "$1" -o "$folder/case.png" --camera "$folder/$view.json" "${plane[@]}"
      "$clipgs" --quiet render "$folder/cut.ply" -o "$folder/splats.png" --camera "$folder/$view.json" 2>/dev/null
      dB+=("$(alike "$folder/case.png" "$folder/splats.png")")
    done
    printf '| %s | %.1f | %.1f | %.1f |\n' "${cut%%:*}" "${dB[@]}"
  done
}

splats() { head -c 300 "$1" | grep -a '^element vertex'; }

row() { printf '| %s | %.2f | %s |\n' "$1" "$(stat -c %s "$2" | awk '{print $1 / 1e6}')" "$3"; }

for case in "$@"; do
  echo "$case"
  for format in ply spz glb sog; do
    "$clipgs" export "$case" -o "$folder/own.$format" >/dev/null
  done
  "$clipgs" export "$case" -o "$folder/own3.spz" --spz-version 3 >/dev/null
  node "$peers/validate_glb.js" "$folder/own.glb" >&2
  picture "$folder/own.ply" "$folder/truth.png"
  row "PLY" "$folder/own.ply" "–"
  row "glTF" "$folder/own.glb" "–"
  row "SPZ 4" "$folder/own.spz" "$(likeness "$folder/own.spz")"
  row "SPZ 3" "$folder/own3.spz" "$(likeness "$folder/own3.spz")"
  row "SOG" "$folder/own.sog" "$(likeness "$folder/own.sog")"
  # By the peer, and read back by it: it takes SPZ's axes for those of a PLY.
  for format in spz compressed.ply; do
    transform "$folder/own.ply" "$folder/peer.$format"
    transform "$folder/peer.$format" "$folder/back.ply"
    row "splat-transform, .$format" "$folder/peer.$format" "$(likeness "$folder/back.ply")"
  done
  transform -g cpu "$folder/own.ply" "$folder/peer.sog"
  row "splat-transform, .sog" "$folder/peer.sog" "$(likeness "$folder/peer.sog")"
  for format in spz sog; do # what it reads of ours is all of it
    transform "$folder/own.$format" "$folder/back.ply"
    [ "$(splats "$folder/back.ply")" = "$(splats "$folder/own.ply")" ]
  done
  beside_the_case "$case"
done
