#!/usr/bin/env bash
# How cases look at the resolution and from the distance that a headset shows them: cut, uncut and close up, at 1024
# and at 256 pixels, against path-traced truth. Prints Markdown.
#
#   CLIPGS_DATA=... bench/sharpness.sh [FOLDER]    FOLDER (default build/sharpness) keeps everything, a folder a case;
#                                                  what is there is not made again
#
# Takes hours. Stop it whenever you like; run again, it goes on. Everything has a default: QUALITY of the builds;
# TEST_FRAMES of each kind (6); BUILD_OPTIONS, more of `clipgs build`; what paper_steps.sh says.
set -euo pipefail
cd "$(dirname "$0")/.."
set -- "${1:-build/sharpness}"
source bench/paper_steps.sh

readonly quality="${QUALITY:-standard}" test_frames="${TEST_FRAMES:-6}"
read -ra build_options <<<"${BUILD_OPTIONS:-}"

# build CASE OPTIONS...: its case.sog, which is there when it is finished.
build() {
  local at="$folder/$1"
  "$clipgs" build "$CLIPGS_DATA/${volume[0]}" "${volume[@]:1}" -o "$at/coming.sog" --work "$at/work" "${@:2}"
  mv "$at/coming.sog" "$at/case.sog"
}

for name in "${cases[@]}"; do
  at="$folder/$name"
  text="$(volume_of "$name")"
  read -ra volume <<<"$text"
  truth "$name" "$test_frames"
  # Of the same test planes and views, which training keeps away from, tiny pictures: the large ones are the truth's.
  settings "$at/build.settings" "QUALITY=$quality" "TEST_FRAMES=$test_frames" "BUILD_OPTIONS=${build_options[*]}"
  step "$at/build" "$at/case.sog" build "$name" --quality "$quality" --test-frames "$test_frames" \
    --uncut-frames "$test_frames" --close-frames "$test_frames" --test-size 32 --test-noise-db 20 \
    "${build_options[@]}"
  measure "$name"
done

node bench/sharpness.cjs "$folder" "$split" "$test_size" "$small" "${cases[@]}"
echo
echo "On $(machine)."
