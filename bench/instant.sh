#!/usr/bin/env bash
# How soon a case is there that one can cut, and how it looks then: `clipgs build --quality instant`, timed, against
# path-traced truth at 1024 and at 256 pixels. Prints Markdown.
#
#   CLIPGS_DATA=... bench/instant.sh [FOLDER]    FOLDER (default build/instant) keeps everything, a folder a case; what
#                                                is there is not made again, and what is timed alone takes seconds
#
# The truth takes a quarter of an hour. Everything has a default: TEST_SIZE and SMALL of the pictures compared, px;
# TEST_FRAMES of each split; NOISE_DB, masked, of the truth; SPLIT (test, or validation to choose between methods by);
# and what paper_steps.sh says of CASES and CLIPGS.
set -euo pipefail
cd "$(dirname "$0")/.."
set -- "${1:-build/instant}"
source bench/paper_steps.sh

readonly test_size="${TEST_SIZE:-1024}" small="${SMALL:-256}" test_frames="${TEST_FRAMES:-2}"
readonly noise_db="${NOISE_DB:-44}" split="${SPLIT:-test}"

for name in "${cases[@]}"; do
  at="$folder/$name"
  text="$(volume_of "$name")"
  read -ra volume <<<"$text"
  settings "$at/truth.settings" "TEST_SIZE=$test_size" "TEST_FRAMES=$test_frames" "NOISE_DB=$noise_db"
  step "$at/truth" "$at/truth/transforms.json" "$clipgs" dataset "$CLIPGS_DATA/${volume[0]}" "${volume[@]:1}" \
    -o "$at/truth" --no-section --train-frames 1 --train-spp 2 --points 1000 --test-frames "$test_frames" \
    --validation-frames 1 --uncut-frames "$test_frames" --close-frames "$test_frames" --test-size "$test_size" \
    --test-masked-noise-db "$noise_db"
  cat "$CLIPGS_DATA/${volume[0]}" >/dev/null # from a warm disk
  step "$at/case" "$at/case.sog" "$clipgs" build "$CLIPGS_DATA/${volume[0]}" "${volume[@]:1}" -o "$at/case.sog" \
    --quality instant
  for size in "$test_size" "$small"; do
    step "$at/$split-$size" "$at/$split-$size.figures" "$clipgs" eval "$at/case.sog" --dataset "$at/truth" \
      --size "$size" --split "$split" --clip exact --section volume --json "$at/$split-$size.figures"
  done
done

node bench/sharpness.cjs "$folder" "$split" "$test_size" "$small" "${cases[@]}"
echo "| s | $(for name in "${cases[@]}"; do printf '%s | ' "$(<"$folder/$name/case.seconds")"; done)"
echo
echo "On $(machine)."
