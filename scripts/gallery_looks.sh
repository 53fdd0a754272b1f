#!/usr/bin/env bash
# Makes docs/gallery/look-*.webp: each look whole and cut open, path traced at 1024 px. The phantom always; the real
# volumes if CLIPGS_DATA names their folder.
#
#   scripts/gallery_looks.sh [NAME...]    only these (default all)
#
# SPP (default 96, denoised) trades time for looks. Needs ImageMagick besides what scripts/setup.sh installs.
set -euo pipefail
cd "$(dirname "$0")/.."

readonly clipgs=build/release/src/cli/clipgs
readonly out=docs/gallery
readonly data="${CLIPGS_DATA:-}"
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT

# look NAME PRESET VOLUME VIEW AIM NORMAL AT [LOADING...]: looking at AIM (R,A,S mm from the volume's middle), and cut by
# a plane with that normal, AT mm beyond it.
look() {
  local name="$1" preset="$2" volume="$3" view="$4" aim="$5" normal="$6" at="$7" places
  shift 7
  if [ "${#wanted[@]}" -gt 0 ] && [[ " ${wanted[*]} " != *" $name "* ]]; then
    return
  fi
  if [ ! -e "$volume" ]; then
    echo "gallery: no $volume; $name is left as it is" >&2
    return
  fi
  echo "gallery: drawing look $name"
  places="$("$clipgs" --quiet info "$volume" --json "$@" | node -e '
    const c = JSON.parse(require("fs").readFileSync(0));
    const [aim, normal, [at]] = process.argv.slice(1).map((numbers) => numbers.split(",").map(Number));
    const middle = [0, 1, 2].map((k) => c.origin_ras_mm[k] + 0.5 * c.axes_ras.reduce((s, axis, i) => s + axis[k] * c.size_mm[i], 0));
    const length = Math.hypot(...normal);
    console.log(aim.map((mm, k) => mm + middle[k]).join(","));
    console.log([...normal, length * at + normal.reduce((s, n, k) => s + n * middle[k], 0)].join(","));' -- "$aim" "$normal" "$at")"
  for cut in "" "--plane ${places#*$'\n'}"; do
    # shellcheck disable=SC2086  # two words, or none
    "$clipgs" --quiet cinema "$volume" -o "$folder/whole${cut:+-cut}.png" --preset "$preset" --view "$view" \
      --look-at "${places%%$'\n'*}" --size 1024 \
      --spp "${SPP:-96}" --denoise --background 0.05,0.06,0.08 $cut "$@" >/dev/null
  done
  convert "$folder/whole.png" "$folder/whole-cut.png" +append -quality 82 "$out/look-$name.webp"
}

wanted=("$@")
"$clipgs" --quiet phantom "$folder/phantom.nii.gz" >/dev/null
look skin-head skin "$data/head.nrrd" -25,12,1.6 0,0,10 -0.3,-0.5,-0.8 -20 --hu 16,-1024
look skeleton-head skeleton "$data/head.nrrd" 35,8,1.15 0,0,-7 1,0,-0.15 0 --hu 16,-1024
look anatomy-chest anatomy "$data/chest.nrrd" 20,12,1.1 -8,0,15 0,-1,0.1 0
look x-ray-chest x-ray "$data/chest.nrrd" 15,5,1.2 0,0,0 -1,0,0 0
look skin-abdomen skin "$data/abdomen_pelvis_3mm.nii.gz" 30,12,1.2 0,0,0 0.5,-0.8,-0.3 0
look skeleton-abdomen skeleton "$data/abdomen_pelvis_3mm.nii.gz" 25,12,1.2 0,0,0 0,-1,0 -20
look surgery-stent surgery "$data/stent.nrrd" 20,10,1.5 0,0,0 0,-1,0 0
look angiography-stent angiography "$data/stent.nrrd" -25,8,1.5 0,0,0 -1,0,0 0
look anatomy-phantom anatomy "$folder/phantom.nii.gz" 25,15,1.1 0,0,0 0.4,-0.9,-0.2 0
look glass-phantom glass "$folder/phantom.nii.gz" 25,15,1.1 0,0,0 0,0,-1 0
