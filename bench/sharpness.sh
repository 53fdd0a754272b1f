#!/usr/bin/env bash
# How cases look at the resolution and from the distance that a headset shows them: cut, uncut and close up, at 1024
# and at 256 pixels, against path-traced truth. Prints Markdown.
#
#   CLIPGS_DATA=... bench/sharpness.sh [FOLDER]    FOLDER (default build/sharpness) keeps everything, a folder a case;
#                                                  what is there is not made again
#
# Takes hours. Stop it whenever you like; run again, it goes on. Everything has a default: QUALITY of the builds;
# TEST_SIZE and SMALL of the pictures compared, px; TEST_FRAMES of each split; NOISE_DB, masked, of the truth; SPLIT
# (test, or validation to choose between methods by); BUILD_OPTIONS, more of `clipgs build`; what paper_steps.sh says of
# CASES and CLIPGS.
set -euo pipefail
cd "$(dirname "$0")/.."
set -- "${1:-build/sharpness}"
source bench/paper_steps.sh

readonly quality="${QUALITY:-standard}" test_size="${TEST_SIZE:-1024}" small="${SMALL:-256}" test_frames="${TEST_FRAMES:-6}"
readonly noise_db="${NOISE_DB:-44}" split="${SPLIT:-test}"
read -ra build_options <<<"${BUILD_OPTIONS:-}"

for name in "${cases[@]}"; do
  at="$folder/$name"
  text="$(volume_of "$name")"
  read -ra volume <<<"$text"
  settings "$at/build.settings" "QUALITY=$quality" "TEST_SIZE=$test_size" "TEST_FRAMES=$test_frames" "NOISE_DB=$noise_db" \
    "BUILD_OPTIONS=${build_options[*]}"
  step "$at/build" "$at/case.sog" "$clipgs" build "$CLIPGS_DATA/${volume[0]}" "${volume[@]:1}" -o "$at/case.sog" \
    --work "$at/work" --quality "$quality" --test-size "$test_size" --test-frames "$test_frames" --uncut-frames "$test_frames" \
    --close-frames "$test_frames" --test-masked-noise-db "$noise_db" "${build_options[@]}"
  for size in "$test_size" "$small"; do
    step "$at/$split-$size" "$at/$split-$size.figures" "$clipgs" eval "$at/case.sog" --dataset "$at/work/dataset" \
      --size "$size" --split "$split" --clip exact --section volume --json "$at/$split-$size.figures"
  done
done

node bench/sharpness.cjs "$folder" "$split" "$test_size" "$small" "${cases[@]}"
echo
echo "On $(machine)."
