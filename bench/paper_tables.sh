#!/usr/bin/env bash
# The tables of ClipGS-VR and XClipGS, made with clipgs: a neural model of each case (ClipGS), its states
# baked into one scene (ClipGS-VR), and that refined under cuts of any angle (ours), with the faces by
# splats and by the volume. Against the model's pictures, against path-traced truth, and in bytes. Prints
# Markdown.
#
#   CLIPGS_DATA=... bench/paper_tables.sh [FOLDER]    FOLDER (default build/paper) keeps everything, a
#                                                     folder a case; what is there is not made again
#
# Takes hours. Stop it whenever you like; run again, it goes on. Everything has a default:
# BUDGET of Gaussians; STEPS of the neural model; REFINE_BUDGET, what refinement without the section may grow
# to, REFINE_STEPS and REFINE_SH_DEGREE; SECTION_STEPS, those of refinement with the volume's faces in front;
# what paper_steps.sh says of pictures, CASES and CLIPGS.
set -euo pipefail
cd "$(dirname "$0")/.."
source bench/paper_steps.sh

readonly budget="${BUDGET:-120000}" steps="${STEPS:-8000}"
readonly refine_budget="${REFINE_BUDGET:-260000}" refine_steps="${REFINE_STEPS:-10000}" refine_sh_degree="${REFINE_SH_DEGREE:-1}"
readonly section_steps="${SECTION_STEPS:-6000}"

# Leaves FOLDER/CASE/bake.json too.
bake() {
  "$clipgs" bake "$1/neural.ply" -o "$1/layered.ply" --json >"$1/bake.json.part"
  mv "$1/bake.json.part" "$1/bake.json"
}

# evaluate FOLDER/CASE NAME SCENE [OPTION...]: NAME.figures and NAME.html. (A scene's PLY has a NAME.json.)
evaluate() {
  step "$1/$2.figures" "$1/$2.html" "$clipgs" eval "$1/$3" --dataset "$1/dataset" \
    --json "$1/$2.figures" --report "$1/$2.html" "${@:4}"
}

# make_case CASE
make_case() {
  local at="$folder/$1"
  dataset "$1"
  settings "$at/tables.settings" "BUDGET=$budget" "STEPS=$steps" \
    "REFINE_BUDGET=$refine_budget" "REFINE_STEPS=$refine_steps" "REFINE_SH_DEGREE=$refine_sh_degree" \
    "SECTION_STEPS=$section_steps" "SH_DEGREE=$sh_degree"
  # The JSON beside a PLY is written last.
  step "$at/neural" "$at/neural.json" "$clipgs" train "$at/dataset" -o "$at/neural.ply" --model clipgs --no-section \
    --budget "$budget" --steps "$steps" --sh-degree "$sh_degree"
  step "$at/bake" "$at/bake.json" bake "$at"
  step "$at/deep" "$at/deep.json" "$clipgs" bake "$at/neural.ply" -o "$at/deep.ply" --slab-depth 0.08
  step "$at/refined" "$at/refined.json" "$clipgs" refine "$at/deep.ply" --dataset "$at/dataset" \
    -o "$at/refined.ply" --no-section --budget "$refine_budget" --steps "$refine_steps" --sh-degree "$refine_sh_degree"
  step "$at/section" "$at/section.json" "$clipgs" refine "$at/deep.ply" --dataset "$at/dataset" \
    -o "$at/section.ply" --steps "$section_steps"
  step "$at/refined.sog" "$at/refined.sog" "$clipgs" pack "$at/refined.ply" -o "$at/refined.sog" --no-section
  step "$at/case.sog" "$at/case.sog" "$clipgs" pack "$at/section.ply" -o "$at/case.sog"
  bytes "$at/refined.sog" "$at/refined.sog"
  bytes "$at/case.sog" "$at/case.sog"
  bytes "$at/neural" "$at/neural.ply" "$at/neural.json"
  evaluate "$at" refined refined.sog --with "$at/layered.ply" --with "$at/deep.ply" --model "$at/neural.ply"
  # Beside a case with a section, the refined scene is drawn with the volume's faces as well.
  evaluate "$at" case case.sog --with "$at/refined.sog"
  evaluate "$at" unpacked refined.ply --with "$at/section.ply" --clip exact
}

for name in "${cases[@]}"; do
  make_case "$name"
done

cat <<EOF2
Made by \`CLIPGS_DATA=... bench/paper_tables.sh\` on $(machine) and no graphics card: $budget Gaussians of
SH degree $sh_degree; $steps steps of the neural model, $refine_steps of refinement (to $refine_budget Gaussians of
degree $refine_sh_degree), $section_steps of refinement with the section. Means over the cases: ${cases[*]}. [method.md](method.md#7-metrics) defines the columns.
Figures under a paper's name are as it states them, of its own volumes and pictures: they say what to expect,
not who wins.

- \`neural\`: the neural model ([ClipGS](method.md#9-the-neural-model)); draws axis planes alone, in its own way
- \`layered\`: its 200 states [as one scene](method.md#10-from-states-to-one-scene) (ClipGS-VR)
- \`deep\`: the same, each primitive from a state whose plane is 8 % of the extent away, where nothing is adjusted
- \`refined\`: that, [refined](method.md#11-refinement) without the section, as a case
- \`case\`: \`deep\`, refined with the section's faces in front, as a case with its section. Its splats are hollow

EOF2

node bench/paper_tables.cjs "$folder" "${cases[@]}"
