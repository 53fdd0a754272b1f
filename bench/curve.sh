#!/usr/bin/env bash
# How good a case is after so many seconds: every version that `clipgs build` writes of one, with the second it was
# there, against path-traced truth at 1024 and at 256 pixels. Prints Markdown, and draws FOLDER/curve.svg.
#
#   CLIPGS_DATA=... bench/curve.sh [FOLDER]    FOLDER (default build/curve) keeps everything, a folder a case; what is
#                                              there is not made again, but a build that was interrupted begins anew
#
# The truth takes a quarter of an hour. QUALITY of the builds (draft), TEST_FRAMES of each kind (2); paper_steps.sh says
# what else has a default. Figures of another program, from its FOLDER, come beside these with BESIDE=FOLDER.
set -euo pipefail
cd "$(dirname "$0")/.."
set -- "${1:-build/curve}"
source bench/paper_steps.sh
readonly quality="${QUALITY:-draft}"

# keep_versions CASE VOLUME OPTIONS...: builds it, and keeps each version as SECONDS.sog.
keep_versions() {
  local at="$folder/$1" began last="" now pid
  shift
  rm -rf "$at/versions" "$at/work" "$at/case.sog"
  mkdir -p "$at/versions"
  began="$(LC_ALL=C date +%s.%N)"
  "$clipgs" build "$@" -o "$at/case.sog" --quality "$quality" --work "$at/work" >&2 &
  pid=$!
  local alive=true
  while $alive; do
    kill -0 "$pid" 2>/dev/null || alive=false
    # A version is another file of the same name: a link to it stays what it was.
    now="$(LC_ALL=C stat -c '%i %.Y' "$at/case.sog" 2>/dev/null || true)"
    if [ -n "$now" ] && [ "$now" != "$last" ]; then
      ln "$at/case.sog" "$at/versions/$(LC_ALL=C awk -v at="${now#* }" -v from="$began" 'BEGIN { printf "%06.1f", at - from }').sog"
      last="$now"
    fi
    sleep 0.2
  done
  wait "$pid"
}

for name in "${cases[@]}"; do
  at="$folder/$name"
  text="$(volume_of "$name")"
  read -ra volume <<<"$text"
  truth "$name" "${TEST_FRAMES:-2}"
  settings "$at/versions.settings" "QUALITY=$quality"
  if [ ! -f "$at/versions.made" ]; then
    cat "$CLIPGS_DATA/${volume[0]}" >/dev/null # from a warm disk
    keep_versions "$name" "$CLIPGS_DATA/${volume[0]}" "${volume[@]:1}"
    touch "$at/versions.made"
  fi
  for version in "$at"/versions/*.sog; do
    measure_case "$at" "$version" "${version%.sog}-"
  done
done

node bench/curve.cjs "$folder" "$split" "$test_size" "$small" "${BESIDE:-}" "${cases[@]}"
echo
echo "On $(machine)."
