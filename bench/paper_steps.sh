#!/usr/bin/env bash
# What paper_tables.sh, ablation.sh, sharpness.sh, instant.sh and curve.sh have in common; they source it. Where their
# results lie, how their steps resume and are timed, and the pictures that they learn from and are measured against.
#
# From the environment: CASES to make; of the pictures SIZE in px, TRAIN_FRAMES, TRAIN_SPP, TEST_FRAMES and
# DATASET_OPTIONS, more options of `clipgs dataset`; SH_DEGREE of the Gaussians; CLIPGS, a program to use
# instead of building one. Of truth at a headset's size: TEST_SIZE and SMALL of the pictures compared, px; NOISE_DB,
# masked; SPLIT, test, or validation to choose between methods by.

if [ -z "${CLIPGS_DATA:-}" ]; then
  echo "$0: set CLIPGS_DATA to the folder with head.nrrd, chest.nrrd, abdomen_pelvis_3mm.nii.gz and stent.nrrd" >&2
  exit 2
fi
readonly folder="${1:-build/paper}"
read -ra cases <<<"${CASES:-head chest abdomen stent}"
# Evenly spread, not by need: solid splats, as these models are, learn better from such views.
read -ra dataset_options <<<"${DATASET_OPTIONS:---views spiral}"
readonly sh_degree="${SH_DEGREE:-2}"
readonly clipgs="${CLIPGS:-build/release/src/cli/clipgs}"
if [ -z "${CLIPGS:-}" ]; then
  bash scripts/build.sh >&2
fi

# volume_of CASE: the file in CLIPGS_DATA, and options how to read it.
volume_of() {
  case "$1" in
    head) echo head.nrrd --hu 16,-1024 ;;
    chest) echo chest.nrrd ;;
    abdomen) echo abdomen_pelvis_3mm.nii.gz ;;
    stent) echo stent.nrrd ;;
    *)
      echo "$0: there is no case $1; use head, chest, abdomen and stent" >&2
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
  local text volume
  text="$(volume_of "$1")"
  read -ra volume <<<"$text"
  settings "$at/dataset.settings" "SIZE=$size" "TRAIN_FRAMES=$train" "TRAIN_SPP=$spp" "TEST_FRAMES=$test" \
    "DATASET_OPTIONS=${dataset_options[*]}"
  step "$at/dataset" "$at/dataset/section.zip" "$clipgs" dataset "$CLIPGS_DATA/${volume[0]}" "${volume[@]:1}" \
    -o "$at/dataset" --one-sided --train-frames "$train" --train-spp "$spp" --test-frames "$test" --size "$size" \
    "${dataset_options[@]}"
}

readonly test_size="${TEST_SIZE:-1024}" small="${SMALL:-256}" split="${SPLIT:-test}"

# truth CASE FRAMES: path-traced pictures at a headset's size, FRAMES of each kind, in FOLDER/CASE/truth. What a case
# learns from does not matter to them: cases of any quality are measured against the same.
truth() {
  local at="$folder/$1" frames="$2" noise_db="${NOISE_DB:-44}" text volume
  text="$(volume_of "$1")"
  read -ra volume <<<"$text"
  settings "$at/truth.settings" "TEST_SIZE=$test_size" "TEST_FRAMES=$frames" "NOISE_DB=$noise_db"
  step "$at/truth" "$at/truth/transforms.json" "$clipgs" dataset "$CLIPGS_DATA/${volume[0]}" "${volume[@]:1}" \
    -o "$at/truth" --no-section --train-frames 1 --train-spp 2 --points 1000 --test-frames "$frames" \
    --validation-frames 1 --uncut-frames "$frames" --close-frames "$frames" --test-size "$test_size" \
    --test-masked-noise-db "$noise_db"
}

# measure CASE: FOLDER/CASE/case.sog against the truth, large and small.
measure() {
  measure_case "$folder/$1" "$folder/$1/case.sog" "$folder/$1/"
}

# measure_case AT FILE STEM: the same of a case in a file, against the truth in AT; the figures are called STEM….
measure_case() {
  local at="$1" size
  for size in "$test_size" "$small"; do
    step "$3$split-$size" "$3$split-$size.figures" "$clipgs" eval "$2" --dataset "$at/truth" \
      --size "$size" --split "$split" --clip exact --section volume --json "$3$split-$size.figures"
  done
}

machine() {
  echo "$(nproc) cores of $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1)"
}
