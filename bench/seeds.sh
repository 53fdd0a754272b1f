#!/usr/bin/env bash
# How much of a figure is chance: the cases that curve.sh built, trained again with other seeds on the same pictures,
# against the same truth. Prints Markdown.
#
#   CLIPGS_DATA=... BUILT=build/curve bench/seeds.sh [FOLDER]    BUILT is the folder of curve.sh, FOLDER (default
#                                                                build/seeds) keeps everything; what is there is not
#                                                                made again
#
# SEEDS besides the builds' own (2 3); BUDGET, STEPS and SH_DEGREE as the builds' quality has them (those of standard);
# paper_steps.sh says what else has a default.
set -euo pipefail
cd "$(dirname "$0")/.."
set -- "${1:-build/seeds}"
source bench/paper_steps.sh
readonly built="${BUILT:-build/curve}" budget="${BUDGET:-40000}" steps="${STEPS:-2500}" degree="${SH_DEGREE:-1}"
read -ra seeds <<<"${SEEDS:-2 3}"

for name in "${cases[@]}"; do
  at="$folder/$name"
  settings "$at/settings" "BUDGET=$budget" "STEPS=$steps" "SH_DEGREE=$degree"
  for size in "$test_size" "$small"; do
    cp "$built/$name/$split-$size.figures" "$at/1-$split-$size.figures"
  done
  for seed in "${seeds[@]}"; do
    step "$at/$seed" "$at/$seed.json" "$clipgs" train "$built/$name/work/dataset" -o "$at/$seed.ply" \
      --budget "$budget" --steps "$steps" --sh-degree "$degree" --seed "$seed"
    step "$at/$seed.sog" "$at/$seed.sog" "$clipgs" pack "$at/$seed.ply" -o "$at/$seed.sog"
    measure "$name" "$at/$seed.sog" "$at/$seed-"
  done
done

node bench/seeds.cjs "$folder" "$split" "$test_size" "$small" "1 ${seeds[*]}" "${cases[@]}"
