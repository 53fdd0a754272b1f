#!/usr/bin/env bash
# How soon a case is there that one can cut, and how it looks then: `clipgs build --quality instant`, timed, against
# path-traced truth at 1024 and at 256 pixels. Prints Markdown.
#
#   CLIPGS_DATA=... bench/instant.sh [FOLDER]    FOLDER (default build/instant) keeps everything, a folder a case; what
#                                                is there is not made again, and what is timed alone takes seconds
#
# The truth takes a quarter of an hour. paper_steps.sh says what has a default.
set -euo pipefail
cd "$(dirname "$0")/.."
set -- "${1:-build/instant}"
source bench/paper_steps.sh

for name in "${cases[@]}"; do
  at="$folder/$name"
  find_volume "$name"
  truth "$name"
  cat "${volume[0]}" >/dev/null # from a warm disk
  step "$at/case" "$at/case.sog" "$clipgs" build "${volume[@]}" -o "$at/case.sog" \
    --quality instant
  measure "$name"
done

node bench/sharpness.cjs "$folder" "$split" "$test_size" "$small" "${cases[@]}"
echo "| s | $(for name in "${cases[@]}"; do printf '%s | ' "$(<"$folder/$name/case.seconds")"; done)"
echo
echo "On $(machine)."
