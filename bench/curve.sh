#!/usr/bin/env bash
# How good a case is after so many seconds: every version that `clipgs build` writes of one, with the second it was
# there, against path-traced truth at 1024 and at 256 pixels: cut, uncut and close up, as a headset shows it. Of the
# last, the finished case, what each kind of pixel has, its size and the memory it took. Prints Markdown, and draws
# FOLDER/curve.svg.
#
#   CLIPGS_DATA=... bench/curve.sh [FOLDER]    FOLDER (default build/curve) keeps everything, a folder a case; what is
#                                              there is not made again, but a build that was interrupted begins anew
#
# The truth takes a quarter of an hour. QUALITY of the builds (draft) and BUILD_OPTIONS, more of `clipgs build`;
# paper_steps.sh says what else has a default. Figures of another program, from its FOLDER, come beside these with
# BESIDE=FOLDER.
set -euo pipefail
cd "$(dirname "$0")/.."
set -- "${1:-build/curve}"
source bench/paper_steps.sh
readonly quality="${QUALITY:-draft}"
read -ra build_options <<<"${BUILD_OPTIONS:-}"

# keep_versions AT VOLUME OPTIONS...: builds it, and keeps each version as SECONDS.sog, and the peak memory in KB.
keep_versions() {
  local at="$1" began last="" now pid
  shift
  rm -rf "$at/versions" "$at/work" "$at/case.sog"
  mkdir -p "$at/versions"
  began="$(LC_ALL=C date +%s.%N)"
  /usr/bin/time -f %M -o "$at/kilobytes" "$clipgs" build "$@" -o "$at/case.sog" --quality "$quality" \
    --work "$at/work" >&2 &
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
  find_volume "$name"
  truth "$name"
  settings "$at/versions.settings" "QUALITY=$quality" "BUILD_OPTIONS=${build_options[*]}"
  if [ ! -f "$at/versions.made" ]; then
    cat "${volume[0]}" >/dev/null # from a warm disk
    keep_versions "$at" "${volume[@]}" "${tiny_tests[@]}" "${build_options[@]}"
    touch "$at/versions.made"
  fi
  for version in "$at"/versions/*.sog; do
    measure "$name" "$version" "${version%.sog}-"
  done
  for size in "$test_size" "$small"; do
    cp "${version%.sog}-$split-$size.figures" "$at/$split-$size.figures"
  done
done

node bench/curve.cjs "$folder" "$split" "$test_size" "$small" "${BESIDE:-}" "${cases[@]}"
printf '\nThe finished cases:\n\n'
node bench/sharpness.cjs "$folder" "$split" "$test_size" "$small" "${cases[@]}"
echo "| GiB at the peak | $(for name in "${cases[@]}"; do LC_ALL=C awk '{ printf "%.2f | ", $1 / 1048576 }' "$folder/$name/kilobytes"; done)"
echo
echo "On $(machine)."
