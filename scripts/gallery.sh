#!/usr/bin/env bash
# Makes the pictures of docs/gallery: the upper row path traced, the lower row clipgs; uncut, cut across
# the axis, cut obliquely, and cut by two planes. The phantom always; the real volumes if CLIPGS_DATA names their folder.
#
#   scripts/gallery.sh [FOLDER]    FOLDER keeps the cases (default build/gallery); those that are there
#                                  already are not built again
#
# QUALITY (default standard, draft for the phantom) and SPP (default 512, of the path tracer) trade time for looks.
# PAPER names what bench/paper_tables.sh made (default build/paper), for the stages. Needs ImageMagick besides what
# scripts/setup.sh installs.
set -euo pipefail
cd "$(dirname "$0")/.."

folder="${1:-build/gallery}"
readonly clipgs=build/release/src/cli/clipgs
readonly size=400
readonly background='0.07,0.08,0.10'
readonly out=docs/gallery

if ! command -v convert >/dev/null; then
  echo "gallery: ImageMagick is missing; install the package imagemagick" >&2
  exit 1
fi
if [ ! -x "$clipgs" ]; then
  bash scripts/build.sh
fi
mkdir -p "$folder" "$out"

# from_case CASE EXPRESSION: a value computed from what `clipgs info` says of the case.
from_case() {
  "$clipgs" info "$1" --json |
    node -e 'const c = JSON.parse(require("fs").readFileSync(0)); console.log(eval(process.argv[1]))' "$2"
}

# pair CASE VOLUME NAME VIEW PLANES [LOADING...]: one column, truth above ours; PLANES are separated by spaces.
pair() {
  local case="$1" volume="$2" name="$3" view="$4" planes="$5" plane
  shift 5
  local cut=()
  for plane in $planes; do
    cut+=(--plane "$plane")
  done
  "$clipgs" --quiet cinema "$volume" -o "$folder/$name-truth.png" --preset "$(from_case "$case" c.preset)" \
    --view "$view" --size "$size" --spp "${SPP:-512}" --background "$background" "${cut[@]}" "$@" >/dev/null
  "$clipgs" --quiet render "$case" -o "$folder/$name-ours.png" --view "$view" --size "$size" "${cut[@]}"
  convert "$folder/$name-ours.png" -background 'rgb(18,20,26)' -flatten "$folder/$name-ours.png"
}

# build NAME VOLUME OPTIONS...: NAME.sog, unless it is there; one that is being built, and not finished yet, is not.
build() {
  local name="$1" volume="$2"
  if [ ! -f "$folder/$name.sog" ]; then
    echo "gallery: building $folder/$name.sog"
    "$clipgs" build "$volume" -o "$folder/$name.coming.sog" --work "$folder/$name.clipgs-work" "${@:3}"
    mv "$folder/$name.coming.sog" "$folder/$name.sog"
  fi
}

# picture NAME VOLUME TITLE VIEW [LOADING...]
picture() {
  local name="$1" volume="$2" title="$3" view="$4"
  shift 4
  local case="$folder/$name.sog"
  build "$name" "$volume" --quality "${QUALITY:-standard}" --title "$title" "$@"
  echo "gallery: drawing $name"
  local plane='((n) => [...n, n.reduce((s, v, i) => s + v * c.center_ras_mm[i], 0)].join(","))'
  local axis
  axis="$(from_case "$case" "$plane([0, 0, -1])")"
  pair "$case" "$volume" "$name-whole" "$view" "" "$@"
  pair "$case" "$volume" "$name-axis" "$view" "$axis" "$@"
  pair "$case" "$volume" "$name-oblique" "$view" "$(from_case "$case" "$plane([0.36, -0.8, -0.48])")" "$@"
  pair "$case" "$volume" "$name-two" "$view" "$axis $(from_case "$case" "$plane([0, -1, 0])")" "$@"
  convert \
    \( "$folder/$name-"{whole,axis,oblique,two}-truth.png +append \) \
    \( "$folder/$name-"{whole,axis,oblique,two}-ours.png +append \) \
    -append -quality 80 "$out/$name.webp"
  echo "gallery: $out/$name.webp, $(($(stat -c %s "$out/$name.webp") / 1024)) KB"
}

# inside NAME VOLUME VIEW [LOADING...]: what cuts open, close up: across the axis, coronal, oblique, two planes.
inside() {
  local name="$1" volume="$2" view="$3" case="$folder/$1.sog"
  shift 3
  echo "gallery: inside $name"
  local plane='((n) => [...n, n.reduce((s, v, i) => s + v * c.center_ras_mm[i], 0)].join(","))'
  local axis coronal
  axis="$(from_case "$case" "$plane([0, 0, -1])")"
  coronal="$(from_case "$case" "$plane([0, -1, 0])")"
  pair "$case" "$volume" "$name-inside1" "$view" "$axis" "$@"
  pair "$case" "$volume" "$name-inside2" "15,10,1.5" "$coronal" "$@"
  pair "$case" "$volume" "$name-inside3" "$view" "$(from_case "$case" "$plane([0.62, -0.72, -0.31])")" "$@"
  pair "$case" "$volume" "$name-inside4" "$view" "$axis $coronal" "$@"
  convert \
    \( "$folder/$name-inside"{1,2,3,4}-truth.png +append \) \
    \( "$folder/$name-inside"{1,2,3,4}-ours.png +append \) \
    -append -quality 80 "$out/$name-inside.webp"
}

# lights NAME VOLUME VIEW [LOADING...]: a case in other lights than it was made in, whole and cut.
lights() {
  local name="$1" volume="$2" view="$3" case="$folder/$1.sog" rig plane i=0
  shift 3
  echo "gallery: lights of $name"
  plane="$(from_case "$case" '[0, 0, -1, -c.center_ras_mm[2]].join(",")')"
  for rig in theatre rim; do
    for cut in "" "--plane $plane"; do
      i=$((i + 1))
      # shellcheck disable=SC2086
      "$clipgs" --quiet cinema "$volume" -o "$folder/$name-light$i-truth.png" --preset "$(from_case "$case" c.preset)" \
        --rig "$rig" --view "$view" --size "$size" --spp "${SPP:-512}" --background "$background" $cut "$@" >/dev/null
      # shellcheck disable=SC2086
      "$clipgs" --quiet render "$case" -o "$folder/$name-light$i-ours.png" --rig "$rig" --view "$view" --size "$size" $cut
      convert "$folder/$name-light$i-ours.png" -background 'rgb(18,20,26)' -flatten "$folder/$name-light$i-ours.png"
    done
  done
  convert \
    \( "$folder/$name-light"{1,2,3,4}-truth.png +append \) \
    \( "$folder/$name-light"{1,2,3,4}-ours.png +append \) \
    -append -quality 80 "$out/$name-lights.webp"
}

# faces NAME VIEW: the same face cinematic, half grey and grey through the soft-tissue window, and a grey slab.
faces() {
  local name="$1" case="$folder/$1.sog" view="$2" plane slab i=0 arguments
  plane="$(from_case "$case" '[0, 0, -1, -c.center_ras_mm[2]].join(",")')"
  slab="$(from_case "$case" '[0, -1, 0, -c.center_ras_mm[1] - 15, 30].join(",")')"
  for arguments in "--plane $plane" "--plane $plane --grey 0.5" "--plane $plane --grey 1 --annotate" \
      "--slab $slab --grey 1 --window bone --annotate"; do
    i=$((i + 1))
    # shellcheck disable=SC2086
    "$clipgs" --quiet render "$case" -o "$folder/$name-face$i.png" --view "$view" --size "$size" $arguments
    convert "$folder/$name-face$i.png" -background 'rgb(18,20,26)' -flatten "$folder/$name-face$i.png"
  done
  convert "$folder/$name-face"{1,2,3,4}.png +append -quality 80 "$out/$name-faces.webp"
}

# shot FILE LABEL VOLUME [CINEMA...]: one path-traced picture for a sheet.
shot() {
  local file="$1" label="$2" volume="$3"
  shift 3
  "$clipgs" --quiet cinema "$volume" -o "$file" --size 300 --spp "${SPP:-512}" --background "$background" "$@" >/dev/null
  convert "$file" -gravity south -fill '#c8ccd4' -pointsize 15 -annotate +0+8 "$label" "$file"
}

# stages: what becomes of the head on the papers' way, from what bench/paper_tables.sh left in PAPER; a cut across the
# axis above, an oblique one, which the neural model cannot draw, below.
stages() {
  local paper="$1" view=20,35,1.3 row=0 plane name label file
  echo "gallery: stages of $paper"
  for plane in 0,0,-1,-115 0.36,-0.7,-0.62,20; do
    row=$((row + 1))
    shot "$folder/stage-$row-truth.png" truth "$CLIPGS_DATA/head.nrrd" --hu 16,-1024 --preset "$(from_case "$paper/case.sog" c.preset)" \
      --view "$view" --plane "$plane"
    for name in neural.ply layered.ply deep.ply refined.sog case.sog; do
      file="$folder/stage-$row-${name%.*}.png"
      label="${name%.*}"
      if ! "$clipgs" --quiet render "$paper/$name" -o "$file" --view "$view" --size 300 --plane "$plane" 2>/dev/null; then
        convert -size 300x300 xc:none "$file"
        label="$label: none"
      fi
      convert "$file" -background 'rgb(18,20,26)' -flatten -gravity south -fill '#c8ccd4' -pointsize 15 \
        -annotate +0+8 "$label" "$file"
    done
    convert "$folder/stage-$row-"{truth,neural,layered,deep,refined,case}.png +append "$folder/stage-$row.png"
  done
  convert "$folder/stage-1.png" "$folder/stage-2.png" -append -quality 80 "$out/stages.webp"
}

if [ ! -f "$folder/phantom.nii.gz" ]; then
  "$clipgs" phantom "$folder/phantom.nii.gz"
fi
QUALITY="${QUALITY:-draft}" picture phantom "$folder/phantom.nii.gz" "Phantom torso" 30,25
# openings NAME PLANE VIEW: a case's grey face in a soft-tissue window: lit walls, clay and values; and in that of lungs
openings() {
  local name="$1" plane="$2" view="$3" case="$folder/$1.sog" look
  echo "gallery: openings of $name"
  for look in "cinematic soft-tissue" "neutral soft-tissue" "values soft-tissue" "cinematic lung"; do
    # shellcheck disable=SC2086
    set -- $look
    "$clipgs" --quiet render "$case" -o "$folder/$name-$1-$2.png" --view "$view" --plane "$plane" --grey 1 \
      --openings "$1" --window "$2" --size "$size"
    convert "$folder/$name-$1-$2.png" -background 'rgb(18,20,26)' -flatten "$folder/$name-$1-$2.png"
  done
  convert "$folder/$name-cinematic-soft-tissue.png" "$folder/$name-neutral-soft-tissue.png" \
    "$folder/$name-values-soft-tissue.png" "$folder/$name-cinematic-lung.png" +append -quality 85 "$out/$name-openings.webp"
}

inside phantom "$folder/phantom.nii.gz" 20,45,1.4

if [ -n "${CLIPGS_DATA:-}" ]; then
  picture head "$CLIPGS_DATA/head.nrrd" "Head and neck" 30,20 --hu 16,-1024
  faces head 20,50
  build skull "$CLIPGS_DATA/head.nrrd" --quality draft --preset bone --title "Skull" --hu 16,-1024
  inside skull "$CLIPGS_DATA/head.nrrd" 20,35,1.2 --hu 16,-1024
  picture chest "$CLIPGS_DATA/chest.nrrd" "Chest" 30,25
  inside chest "$CLIPGS_DATA/chest.nrrd" 20,45,1.4
  lights chest "$CLIPGS_DATA/chest.nrrd" 30,25
  openings chest 0,0,-1,540 0,70,1.5
  picture abdomen "$CLIPGS_DATA/abdomen_pelvis_3mm.nii.gz" "Abdomen and pelvis" 30,25
  inside abdomen "$CLIPGS_DATA/abdomen_pelvis_3mm.nii.gz" 20,45,1.4
  if [ -f "${PAPER:-build/paper}/head/case.sog" ]; then
    stages "${PAPER:-build/paper}/head"
  fi
fi
