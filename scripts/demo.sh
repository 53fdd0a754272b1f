#!/usr/bin/env bash
# From nothing to a scene in the browser: installs what is missing, builds clipgs, makes a case from a
# procedural phantom and serves it. Interrupt it whenever you like; run it again to go on.
#
#   scripts/demo.sh              ends by serving; stop it with Ctrl+C
#   scripts/demo.sh --no-serve   ends when the case is made
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
if [ ! -f "$folder/phantom.sog" ]; then
  echo "demo: making a case from the phantom; this takes some minutes"
  "$clipgs" build "$folder/phantom.nii.gz" -o "$folder/phantom.sog" \
    --quality draft --title "Phantom torso"
fi
echo "demo: $folder/phantom.sog is ready"

if [ "$serve" -eq 1 ]; then
  exec "$clipgs" serve "$folder"
fi
