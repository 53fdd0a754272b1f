#!/usr/bin/env bash
# What other programs make of exported cases: bench/export.sh CASE... writes each in every format, reads it back by
# PlayCanvas's splat-transform and by clipgs, checks the glTF by Khronos's validator, and prints, per file, its bytes and
# how much a picture of it (1024 px) is that of the PLY, dB.
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

# likeness FILE: dB of its picture to that of the PLY, over black.
likeness() {
  picture "$1" "$folder/picture.png"
  ffmpeg -v info -i "$folder/truth.png" -i "$folder/picture.png" \
    -filter_complex "[0]premultiply=inplace=1,format=gbrp[a];[1]premultiply=inplace=1,format=gbrp[b];[a][b]psnr" \
    -f null - 2>&1 | sed -n 's/.*average:\([0-9.inf]*\).*/\1/p'
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
done
