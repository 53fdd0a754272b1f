#!/usr/bin/env bash
# Whether paper_tables.sh, ablation.sh, instant.sh, curve.sh, seeds.sh and operators.sh work: all, on a phantom, with
# next to no pictures and steps.
#
#   bench/paper_test.sh CLIPGS
set -euo pipefail
CLIPGS="$(realpath "$1")"
cd "$(dirname "$0")/.."
scratch="$(mktemp -d)"
trap 'rm -rf "$scratch"' EXIT

export CLIPGS CLIPGS_DATA="$scratch" CASES="chest abdomen"
export SIZE=32 TRAIN_FRAMES=24 TRAIN_SPP=2 TEST_FRAMES=1 BUDGET=1000 STEPS=20 REFINE_STEPS=10 SECTION_STEPS=10
export DATASET_OPTIONS="--test-noise-db 15 --test-masked-noise-db 0 --points 2000"

fail() {
  echo "paper_test: $1" >&2
  exit 1
}

# expect SCRIPT ROWS NAME=VALUE: it prints that many lines of tables, every time, makes nothing twice, and does not mix
# in what is made otherwise.
expect() {
  local script="$1" rows
  bash "bench/$script" "$scratch/${OUT:-out}" >"$scratch/first" 2>"$scratch/log" || fail "$script: $(tail -n 5 "$scratch/log")"
  rows="$(grep -c '^|' "$scratch/first")"
  [ "$rows" -eq "$2" ] || fail "$script printed $rows lines of tables, not $2"
  # What has no figure is a dash.
  ! grep -E 'NaN|undefined|null|Infinity' "$scratch/first" || fail "$script printed something that is no figure"
  bash "bench/$script" "$scratch/${OUT:-out}" >"$scratch/second" 2>"$scratch/log" || fail "$script failed when run again"
  ! grep making "$scratch/log" || fail "$script made something again"
  cmp "$scratch/first" "$scratch/second" || fail "$script printed something else when run again"
  ! env "$3" bash "bench/$script" "$scratch/${OUT:-out}" >/dev/null 2>"$scratch/log" || fail "$script mixed results"
  grep -q 'was made with' "$scratch/log" || fail "$script: $(tail -n 5 "$scratch/log")"
}

"$CLIPGS" phantom "$scratch/chest.nrrd" --size 32 --quiet
"$CLIPGS" phantom "$scratch/abdomen_pelvis_3mm.nii.gz" --size 32 --seed 2 --quiet
expect paper_tables.sh 129 STEPS=30
expect ablation.sh 17 STEPS=30
export QUALITY=draft TEST_SIZE=64 SMALL=32 NOISE_DB=15
export BUILD_OPTIONS="--size 32 --train-frames 24 --steps 20 --budget 1000"
OUT=curve expect curve.sh 38 NOISE_DB=16
export BUILT="$scratch/curve" TRUTH="$scratch/curve"
OUT=instant expect instant.sh 17 NOISE_DB=16
OUT=seeds expect seeds.sh 12 STEPS=30
OUT=operators expect operators.sh 10 STEPS=30
