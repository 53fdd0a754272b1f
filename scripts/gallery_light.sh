#!/usr/bin/env bash
# Makes docs/gallery/panoramas.webp, the head in the light of the panoramas of scripts/panoramas.py as skin and as
# glazed china, and docs/gallery/depth.webp, the skull without and with a depth cue. CLIPGS_DATA names the folder of
# the real volumes.
#
#   scripts/gallery_light.sh
#
# SPP (default 96, denoised) trades time for looks. Needs ImageMagick besides what scripts/setup.sh installs.
set -euo pipefail
cd "$(dirname "$0")/.."

readonly clipgs=build/release/src/cli/clipgs
readonly out=docs/gallery
readonly head="${CLIPGS_DATA:?names the folder of the volumes}/head.nrrd"
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT

# picture NAME OPTIONS...: the head, 400 px.
picture() {
  local name="$1"
  shift
  echo "gallery: drawing $name"
  "$clipgs" --quiet cinema "$head" -o "$folder/$name.png" --hu 16,-1024 --size 400 --spp "${SPP:-96}" --denoise \
    "$@" >/dev/null
}

cat >"$folder/china.json" <<'JSON'
{"title": "China", "description": "Glazed, so that what shines is seen in it.", "modality": "ct", "surface_strength": 0.2,
 "lights": "studio", "points": [
   {"value": -300, "color": "#4a5a78", "extinction": 0, "specular": 0.25, "roughness": 0.06},
   {"value": -100, "color": "#4a5a78", "extinction": 8, "specular": 0.25, "roughness": 0.06}]}
JSON
python3 scripts/panoramas.py "$folder/lights"
for light in operating-theatre photo-studio window; do
  for look in skin "$folder/china.json"; do
    picture "$(basename "$look" .json)-$light" --preset "$look" --rig "$folder/lights/$light.hdr" --view -25,8,1.15 \
      --background studio
  done
done
convert \( "$folder"/skin-{operating-theatre,photo-studio,window}.png +append \) \
  \( "$folder"/china-{operating-theatre,photo-studio,window}.png +append \) -append -quality 82 "$out/panoramas.webp"

for background in studio paper; do
  for cue in 0 0.9; do
    picture "depth-$background-$cue" --preset skeleton --view 35,8,1.1 --background "$background" --depth-cue "$cue"
  done
done
convert "$folder"/depth-{studio,paper}-{0,0.9}.png +append -quality 82 "$out/depth.webp"
