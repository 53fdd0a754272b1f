#!/usr/bin/env bash
# Makes those pictures of docs/gallery that are path traced alone, without cases: the looks, whole and cut open at 1024
# px, the sheets of presets and lights, stills, panoramas, depth, and what value and gradient tell apart. The phantom always; real volumes if CLIPGS_DATA
# names their folder.
#
#   scripts/gallery_traced.sh [NAME...]    only these pictures, by their files' names (default all)
#
# SPP (default 96, denoised) trades time for looks. CLIPGS may name another program, CLIPGS_MR an MR scan for the sheet
# of presets. Needs ImageMagick besides what scripts/setup.sh installs.
set -euo pipefail
cd "$(dirname "$0")/.."

readonly clipgs="${CLIPGS:-build/release/src/cli/clipgs}"
readonly out=docs/gallery
readonly data="${CLIPGS_DATA:-}"
readonly head="$data/head.nrrd" chest="$data/chest.nrrd" stent="$data/stent.nrrd"
readonly abdomen="$data/abdomen_pelvis_3mm.nii.gz"
readonly hu=(--hu '16,-1024')  # of the head
readonly dark=(--background '0.07,0.08,0.10')
readonly wanted=("$@")
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT

# is_wanted NAME: whether docs/gallery/NAME.webp is to be made; says so.
is_wanted() {
  if [ "${#wanted[@]}" -gt 0 ] && [[ " ${wanted[*]} " != *" $1 "* ]]; then
    return 1
  fi
  if [[ "$1" != *-phantom && -z "$data" ]]; then
    echo "gallery: CLIPGS_DATA names no folder of volumes; $1 is left as it is" >&2
    return 1
  fi
  echo "gallery: drawing $1"
}

# traced FILE VOLUME OPTIONS...: one picture.
traced() {
  local file="$1" volume="$2"
  shift 2
  "$clipgs" --quiet cinema "$volume" -o "$file" --spp "${SPP:-96}" --denoise "$@" >/dev/null
}

# look NAME PRESET VOLUME VIEW AIM NORMAL AT [LOADING...]: looking at AIM (R,A,S mm from the volume's middle), and cut by
# a plane with that normal, AT mm beyond it.
look() {
  local name="look-$1" preset="$2" volume="$3" view="$4" aim="$5" normal="$6" at="$7" places
  shift 7
  if ! is_wanted "$name"; then
    return
  fi
  places="$("$clipgs" --quiet info "$volume" --json "$@" | node -e '
    const c = JSON.parse(require("fs").readFileSync(0));
    const [aim, normal, [at]] = process.argv.slice(1).map((numbers) => numbers.split(",").map(Number));
    const middle = [0, 1, 2].map((k) => c.origin_ras_mm[k] + 0.5 * c.axes_ras.reduce((s, axis, i) => s + axis[k] * c.size_mm[i], 0));
    const length = Math.hypot(...normal);
    console.log(aim.map((mm, k) => mm + middle[k]).join(","));
    console.log([...normal, length * at + normal.reduce((s, n, k) => s + n * middle[k], 0)].join(","));' -- "$aim" "$normal" "$at")"
  for cut in "" "--plane ${places#*$'\n'}"; do
    # shellcheck disable=SC2086  # two words, or none
    traced "$folder/whole${cut:+-cut}.png" "$volume" --preset "$preset" --view "$view" --look-at "${places%%$'\n'*}" \
      --size 1024 --background 0.05,0.06,0.08 $cut "$@"
  done
  convert "$folder/whole.png" "$folder/whole-cut.png" +append -quality 82 "$out/$name.webp"
}

# cell FILE LABEL VOLUME OPTIONS...: a picture of a sheet.
cell() {
  local file="$1" label="$2" volume="$3"
  shift 3
  traced "$file" "$volume" --size 300 "${dark[@]}" "$@"
  convert "$file" -gravity south -fill '#c8ccd4' -pointsize 15 -annotate +0+8 "$label" "$file"
}

# column NAME PRESET VOLUME VIEW PLANE [LOADING...]: of the sheet of presets, uncut and cut.
column() {
  local name="$1" preset="$2" volume="$3" view="$4" plane="$5"
  shift 5
  cell "$folder/column-1.png" "$name: $preset" "$volume" --preset "$preset" --view "$view" "$@"
  cell "$folder/column-2.png" "" "$volume" --preset "$preset" --view "$view" --plane "$plane" "$@"
  columns=$((columns + 1))
  convert "$folder/column-"{1,2}.png -append "$folder/sheet-$(printf %02d "$columns").png"
}

# presets: all that a volume can show that may be shown; the looks are larger.
presets() {
  local columns=0
  column skin soft-tissue "$chest" 30,40 0,0.3,-1,500
  column organs soft-tissue "$abdomen" 20,20 0,-1,0,-130
  column muscles muscle "$chest" 25,40 0,0,-1,540
  column head skin-and-bone "$head" 30,20 1,0,0,-260 "${hu[@]}"
  column skull bone "$head" 30,15 1,0,0,-260 "${hu[@]}"
  column pelvis bone "$abdomen" 25,20 0,0,-1,-190
  column jaw teeth "$head" 15,10 0,0,-1,-80 "${hu[@]}"
  column lungs lung "$chest" 0,15 0,-1,0,140
  column aorta vessels "$stent" 30,15 0,-1,0,63 --hu 1,0
  column stent stent "$stent" 30,15 0,-1,0,63 --hu 1,0
  column thorax glass "$chest" 30,15 0,0,-1,540
  column body crystal "$head" 30,12 1,0,0,-260 "${hu[@]}"
  column unknown generic "$head" 30,20 0,0,-1,-110
  if [ -n "${CLIPGS_MR:-}" ]; then
    column brain mr "$CLIPGS_MR" 30,25 0,0,-1,-20
  fi
  montage "$folder"/sheet-*.png -tile 7x -geometry +0+0 -background 'rgb(18,20,26)' "$folder/presets.png"
  convert "$folder/presets.png" -quality 80 "$out/presets.webp"
}

rigs() {
  local rig
  for rig in studio portrait theatre softbox rim dome ambient; do
    cell "$folder/rig-$rig.png" "$rig" "$head" "${hu[@]}" --preset soft-tissue --rig "$rig" --view 30,20 --plane 0,0,-1,-150
  done
  convert "$folder"/rig-{studio,portrait,theatre,softbox,rim,dome,ambient}.png +append -quality 80 "$out/rigs.webp"
}

# of_head NAME OPTIONS...: the head, 400 px.
of_head() {
  traced "$folder/$1.png" "$head" "${hu[@]}" --size 400 "${@:2}"
}

# stills: shadows on a floor, a lens, skin of glass under a soft box.
stills() {
  local paper=(--background '0.82,0.82,0.84')
  of_head floor --preset bone --view 30,12 --floor inferior "${paper[@]}"
  of_head lens --preset teeth --view 35,5,1.5 --lens 5 --focus -262,-150,60 "${dark[@]}"
  of_head glass --preset crystal --view -35,10 --rig softbox --exposure auto "${dark[@]}"
  of_head cut --preset skin-and-bone --view 25,25 --plane 0,0,-1,-110 --floor inferior --rig theatre "${paper[@]}"
  convert "$folder"/{floor,lens,glass,cut}.png +append -quality 80 "$out/stills.webp"
}

# panoramas: the head in the light of those of scripts/panoramas.py, as skin and as glazed china.
panoramas() {
  cat >"$folder/china.json" <<'JSON'
{"title": "China", "description": "Glazed, so that what shines is seen in it.", "modality": "ct", "surface_strength": 0.2,
 "lights": "studio", "points": [
   {"value": -300, "color": "#4a5a78", "extinction": 0, "specular": 0.25, "roughness": 0.06},
   {"value": -100, "color": "#4a5a78", "extinction": 8, "specular": 0.25, "roughness": 0.06}]}
JSON
  python3 scripts/panoramas.py "$folder/lights"
  local light look
  for light in operating-theatre photo-studio window; do
    for look in skin "$folder/china.json"; do
      of_head "$(basename "$look" .json)-$light" --preset "$look" --rig "$folder/lights/$light.hdr" --view -25,8,1.15 \
        --background studio
    done
  done
  convert \( "$folder"/skin-{operating-theatre,photo-studio,window}.png +append \) \
    \( "$folder"/china-{operating-theatre,photo-studio,window}.png +append \) -append -quality 82 "$out/panoramas.webp"
}

# depth: the skull without and with a depth cue.
depth() {
  local background cue
  for background in studio paper; do
    for cue in 0 0.9; do
      of_head "depth-$background-$cue" --preset skeleton --view 35,8,1.1 --background "$background" --depth-cue "$cue"
    done
  done
  convert "$folder"/depth-{studio,paper}-{0,0.9}.png +append -quality 82 "$out/depth.webp"
}

# boundary: anatomy of the chest by value alone, and by value and gradient.
boundary() {
  node -e 'const { boundary, ...plain } = JSON.parse(require("fs").readFileSync(0)); console.log(JSON.stringify(plain))' \
    <presets/anatomy.json >"$folder/plain.json"
  local look i=0
  for look in "$folder/plain.json" anatomy; do
    i=$((i + 1))
    traced "$folder/boundary-$i.png" "$chest" --preset "$look" --view 20,12,1.4 --size 512x360 "${dark[@]}"
  done
  convert "$folder"/boundary-{1,2}.png +append -quality 82 "$out/boundary.webp"
}

# value-gradient: a histogram of the same.
value-gradient() {
  "$clipgs" --quiet info "$chest" --preset anatomy --histogram "$folder/histogram.png" >/dev/null
  convert "$folder/histogram.png" -quality 90 "$out/value-gradient.webp"
}

"$clipgs" --quiet phantom "$folder/phantom.nii.gz" >/dev/null
look skin-head skin "$head" -25,12,1.6 0,0,10 -0.3,-0.5,-0.8 -20 "${hu[@]}"
look skeleton-head skeleton "$head" 35,8,1.15 0,0,-7 1,0,-0.15 0 "${hu[@]}"
look anatomy-chest anatomy "$chest" 20,12,1.1 -8,0,15 0,-1,0.1 0
look x-ray-chest x-ray "$chest" 15,5,1.2 0,0,0 -1,0,0 0
look skin-abdomen skin "$abdomen" 30,12,1.2 0,0,0 0.5,-0.8,-0.3 0
look skeleton-abdomen skeleton "$abdomen" 25,12,1.2 0,0,0 0,-1,0 -20
look surgery-stent surgery "$stent" 20,10,1.5 0,0,0 0,-1,0 0
look angiography-stent angiography "$stent" -25,8,1.5 0,0,0 -1,0,0 0
look anatomy-phantom anatomy "$folder/phantom.nii.gz" 25,15,1.1 0,0,0 0.4,-0.9,-0.2 0
look glass-phantom glass "$folder/phantom.nii.gz" 25,15,1.1 0,0,0 0,0,-1 0
for sheet in presets rigs stills panoramas depth boundary value-gradient; do
  if is_wanted "$sheet"; then
    "$sheet"
  fi
done
