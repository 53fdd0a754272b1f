#!/usr/bin/env bash
# What each clip operator is worth when splats were trained with it, and with the others: scenes of one dataset, trained
# with hard, soft and exact cuts in the loop, each shown by all three, with the faces by splats alone and by the volume.
# A scene that was trained with one operator and is shown by another flatters the one it was trained with. Prints
# Markdown.
#
#   CLIPGS_DATA=... BUILT=build/curve bench/operators.sh [FOLDER]    BUILT is the folder of curve.sh, FOLDER (default
#                                                                    build/operators) keeps everything; what is there
#                                                                    is not made again
#
# BUDGET, STEPS and SH_DEGREE of training; paper_steps.sh says what else has a default.
set -euo pipefail
cd "$(dirname "$0")/.."
set -- "${1:-build/operators}"
source bench/paper_steps.sh
readonly built="${BUILT:-build/curve}" budget="${BUDGET:-40000}" steps="${STEPS:-2500}" degree="${SH_DEGREE:-1}"

for name in "${cases[@]}"; do
  at="$folder/$name"
  settings "$at/settings" "BUDGET=$budget" "STEPS=$steps" "SH_DEGREE=$degree"
  for clip in hard soft exact; do
    for faces in splats volume; do
      scene="$at/$clip-$faces"
      alone=()
      [ "$faces" = volume ] || alone=(--no-section)
      step "$scene" "$scene.json" "$clipgs" train "$built/$name/work/dataset" -o "$scene.ply" --clip "$clip" \
        --budget "$budget" --steps "$steps" --sh-degree "$degree" "${alone[@]}"
      step "$scene.figures" "$scene.figures" "$clipgs" eval "$scene.ply" --dataset "$truths/$name/truth" \
        --size "$small" --split "$split" --section "$faces" --json "$scene.figures"
    done
  done
done

node bench/operators.cjs "$folder" "$split" "${cases[@]}"
