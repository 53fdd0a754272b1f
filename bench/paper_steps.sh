#!/usr/bin/env bash
# What paper_tables.sh, ablation.sh, instant.sh, curve.sh, seeds.sh and operators.sh have in common; they source it. Where their
# results lie, how their steps resume and are timed, and the pictures that they learn from and are measured against.
#
# From the environment: CASES to make; of the pictures SIZE in px, TRAIN_FRAMES, TRAIN_SPP, TEST_FRAMES and
# DATASET_OPTIONS, more options of `clipgs dataset`; SH_DEGREE of the Gaussians; CLIPGS, a program to use
# instead of building one. Of truth at a headset's size: TEST_SIZE and SMALL of the pictures compared, px; NOISE_DB,
# masked; TEST_FRAMES of each kind (2); SPLIT, test, or
# validation to choose between methods by; TRUTH, a folder for it that others share (FOLDER).

if [ -z "${CLIPGS_DATA:-}" ]; then
  echo "$0: set CLIPGS_DATA to the folder of the volumes: head.nrrd, chest.nrrd, abdomen_pelvis_3mm.nii.gz, stent.nrrd" >&2
  exit 2
fi
readonly folder="${1:-build/paper}"
read -ra cases <<<"${CASES:-head chest abdomen stent}"
# Evenly spread, not by need: solid splats, as these models are, learn better from such views.
read -ra dataset_options <<<"${DATASET_OPTIONS:---views spiral}"
readonly sh_degree="${SH_DEGREE:-2}"
readonly clipgs="${CLIPGS:-build/release/src/cli/clipgs}"
mkdir -p "$folder"
if [ -z "${CLIPGS:-}" ]; then
  bash scripts/build.sh >&2
fi

# find_volume CASE: sets `volume` to its file, and options how to read it.
find_volume() {
  case "$1" in
    head) volume=("$CLIPGS_DATA/head.nrrd" --hu 16,-1024) ;;
    chest) volume=("$CLIPGS_DATA/chest.nrrd") ;;
    abdomen) volume=("$CLIPGS_DATA/abdomen_pelvis_3mm.nii.gz") ;;
    stent) volume=("$CLIPGS_DATA/stent.nrrd") ;;
    mr) volume=("$CLIPGS_DATA/chris_t1.nii.gz") ;;
    phantom)
      volume=("$folder/phantom.nrrd")
      [ -f "${volume[0]}" ] || "$clipgs" phantom "${volume[0]}" >&2
      ;;
    *)
      echo "$0: there is no case $1; use head, chest, abdomen, stent, mr and phantom" >&2
      return 1
      ;;
  esac
}

# settings FILE NAME=VALUE...: remembers what results were made with; refuses to add others to them.
settings() {
  local file="$1" text="${*:2}"
  if [ ! -f "$file" ]; then
    mkdir -p "$(dirname "$file")"
    echo "$text" >"$file"
  elif [ "$(<"$file")" != "$text" ]; then
    echo "$0: $(dirname "$file") was made with $(<"$file"), not $text: use another FOLDER, or delete that" >&2
    exit 1
  fi
}

# count_time NAME [UNTIL]: adds the seconds from NAME.began to UNTIL to NAME.seconds; by default, until the
# last file was written whose name begins with NAME: what an interrupted step had done by then is not lost.
count_time() {
  local name="$1" until="${2:-}"
  if [ -z "$until" ]; then
    until="$(find "$(dirname "$name")" -path "$name*" -newer "$name.began" -printf '%T@\n' | sort -n | tail -n 1)"
  fi
  if [ -n "$until" ]; then
    LC_ALL=C awk -v from="$(stat -c %.Y "$name.began")" -v until="$until" \
      '{ sum += $1 } END { printf "%.2f\n", sum + until - from }' \
      "$([ -f "$name.seconds" ] && echo "$name.seconds" || echo /dev/null)" >"$name.seconds.part"
    mv "$name.seconds.part" "$name.seconds"
  fi
  rm "$name.began"
}

# step NAME OUTPUT COMMAND...: makes OUTPUT, the file that the command writes last, unless it is there;
# NAME.seconds says how long it took.
step() {
  local name="$1" output="$2"
  shift 2
  if [ -f "$name.began" ]; then
    count_time "$name"
  fi
  if [ -e "$output" ]; then
    return
  fi
  echo "$(basename "$0"): making $output" >&2
  mkdir -p "$(dirname "$name")"
  touch "$name.began"
  "$@" >&2
  count_time "$name" "$(LC_ALL=C date +%s.%N)"
}

# bytes NAME FILE...: leaves in NAME.bytes how large the files are together.
bytes() {
  stat -c %s "${@:2}" | awk '{ sum += $1 } END { print sum }' >"$1.bytes"
}

# dataset CASE: the pictures, in FOLDER/CASE/dataset.
dataset() {
  local at="$folder/$1" size="${SIZE:-256}" train="${TRAIN_FRAMES:-3000}" spp="${TRAIN_SPP:-6}" test="${TEST_FRAMES:-20}"
  local volume
  find_volume "$1"
  settings "$at/dataset.settings" "SIZE=$size" "TRAIN_FRAMES=$train" "TRAIN_SPP=$spp" "TEST_FRAMES=$test" \
    "DATASET_OPTIONS=${dataset_options[*]}"
  step "$at/dataset" "$at/dataset/section.zip" "$clipgs" dataset "${volume[@]}" \
    -o "$at/dataset" --one-sided --train-frames "$train" --train-spp "$spp" --test-frames "$test" --size "$size" \
    "${dataset_options[@]}"
}

readonly test_size="${TEST_SIZE:-1024}" small="${SMALL:-256}" split="${SPLIT:-test}" test_frames="${TEST_FRAMES:-2}"
readonly truths="${TRUTH:-$folder}"
# Of the same test planes and views, which training keeps away from, tiny pictures: the large ones are the truth's.
readonly tiny_tests=(--test-frames "$test_frames" --uncut-frames "$test_frames" --close-frames "$test_frames"
  --test-size 32 --test-noise-db 20)

# truth CASE: path-traced pictures at a headset's size, TEST_FRAMES of each kind, in TRUTH/CASE/truth. What a case
# learns from does not matter to them: cases of any quality are measured against the same.
truth() {
  local at="$truths/$1" noise_db="${NOISE_DB:-44}" volume
  find_volume "$1"
  settings "$at/truth.settings" "TEST_SIZE=$test_size" "TEST_FRAMES=$test_frames" "NOISE_DB=$noise_db"
  step "$at/truth" "$at/truth/transforms.json" "$clipgs" dataset "${volume[@]}" \
    -o "$at/truth" --no-section --train-frames 1 --train-spp 2 --points 1000 --test-frames "$test_frames" \
    --validation-frames 1 --uncut-frames "$test_frames" --close-frames "$test_frames" --test-size "$test_size" \
    --test-masked-noise-db "$noise_db"
}

# measure CASE [FILE STEM]: FOLDER/CASE/case.sog, or another of the case, against the truth, large and small; the
# figures are called STEM….
measure() {
  local file="${2:-$folder/$1/case.sog}" stem="${3:-$folder/$1/}" size
  for size in "$test_size" "$small"; do
    step "$stem$split-$size" "$stem$split-$size.figures" "$clipgs" eval "$file" --dataset "$truths/$1/truth" \
      --size "$size" --split "$split" --clip exact --section volume --json "$stem$split-$size.figures"
  done
}

machine() {
  echo "$(nproc) cores of $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1)"
}
