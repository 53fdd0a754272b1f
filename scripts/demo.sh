#!/usr/bin/env bash
# From nothing to a scene in the browser: installs what is missing, builds clipgs and shows a procedural
# phantom, at once and better while you watch. Interrupt it whenever you like; run it again to go on.
#
#   scripts/demo.sh              ends with the page that it opens, or Ctrl+C
#   scripts/demo.sh --no-serve   shows nothing; ends when the case is made
set -euo pipefail
cd "$(dirname "$0")/.."

case "${1:-}" in
  "") serve=1 ;;
  --no-serve) serve=0 ;;
  *)
    echo "usage: scripts/demo.sh [--no-serve]" >&2
    exit 2
    ;;
esac

readonly folder=build/demo
readonly clipgs=build/release/src/cli/clipgs

bash scripts/setup.sh --build
bash scripts/build.sh

mkdir -p "$folder"
if [ ! -f "$folder/phantom.nii.gz" ]; then
  "$clipgs" phantom "$folder/phantom.nii.gz"
fi
if [ "$serve" -eq 1 ]; then
  exec "$clipgs" view "$folder/phantom.nii.gz" --work "$folder" --quality draft --title "Phantom torso"
fi
echo "demo: making a case from the phantom; this takes some minutes"
"$clipgs" build "$folder/phantom.nii.gz" -o "$folder/phantom.sog" --quality draft --title "Phantom torso"
echo "demo: $folder/phantom.sog is ready"
