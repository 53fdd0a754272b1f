#!/usr/bin/env bash
# ClipGS's ablation, and ours: neural models with and without learnable truncation (LT) and adaptive
# adjustment (AAM), trained on the same pictures and measured on axis planes. Prints Markdown.
#
#   CLIPGS_DATA=... bench/ablation.sh [FOLDER]    FOLDER (default build/paper) may be that of
#                                                 paper_tables.sh, whose pictures are taken then; what is
#                                                 there is not made again
#
# Takes hours. Stop it whenever you like; run again, it goes on. Everything has a default:
# BUDGET of Gaussians; STEPS of training; what paper_steps.sh says of pictures, CASES and CLIPGS.
set -euo pipefail
cd "$(dirname "$0")/.."
source bench/paper_steps.sh

readonly budget="${BUDGET:-60000}" steps="${STEPS:-8000}"

# What of `clipgs train` makes each row. Without truncation the adjustment alone cuts, and must act everywhere.
declare -A options=(
  [lt]="--no-aam"
  [aam]="--no-lt --window 0"
  [aam-hard]="--truncation hard"
  [aam-lt]=""
  [everywhere]="--window 0"
  [position]="--aam-sees position"
)
readonly rows=(lt aam aam-hard aam-lt everywhere position)

# picture MODEL: the seconds of the fastest of three, in MODEL.picture.
picture() {
  local begin runs=()
  for _ in 1 2 3; do
    begin="$(date +%s.%N)"
    "$clipgs" render "$1.ply" -o "$1.png" --view 30,30 --state 100 --size 512x512
    runs+=("$(LC_ALL=C awk -v a="$begin" -v b="$(date +%s.%N)" 'BEGIN { printf "%.3f", b - a }')")
  done
  printf '%s\n' "${runs[@]}" | sort -n | head -n 1 >"$1.picture.part"
  mv "$1.picture.part" "$1.picture"
}

# make_row CASE ROW
make_row() {
  local dataset="$folder/$1/dataset" model="$folder/$1/ablation/$2" train
  read -ra train <<<"${options[$2]}"
  # The JSON beside a PLY is written last.
  step "$model" "$model.json" "$clipgs" train "$dataset" -o "$model.ply" --model clipgs --no-section \
    --budget "$budget" --steps "$steps" --sh-degree "$sh_degree" "${train[@]}"
  step "$model.figures" "$model.figures" "$clipgs" eval "$model.ply" --dataset "$dataset" --section splats \
    --json "$model.figures"
  step "$model.picture" "$model.picture" picture "$model"
  bytes "$model" "$model.ply" "$model.json"
}

for name in "${cases[@]}"; do
  dataset "$name"
  settings "$folder/$name/ablation/settings" "BUDGET=$budget" "STEPS=$steps" "SH_DEGREE=$sh_degree"
  for row in "${rows[@]}"; do
    make_row "$name" "$row"
  done
done

cat <<EOF2
Made by \`CLIPGS_DATA=... bench/ablation.sh\` on $(machine) and no graphics card: $budget Gaussians of SH
degree $sh_degree, $steps steps. Axis planes against path-traced truth, faces by splats; means over the cases:
${cases[*]}. LT: [learnable truncation](method.md#9-the-neural-model), AAM: the adaptive adjustment model. In
italics what ClipGS states of five volumes of its own. A picture is all of \`clipgs render\` at 512 × 512
pixels, the best of three: reading the model is part of it.

EOF2

node bench/ablation.cjs "$folder" "${cases[@]}"
