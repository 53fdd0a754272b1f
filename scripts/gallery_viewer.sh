#!/usr/bin/env bash
# Makes the pictures of the viewer in docs/gallery: on a desk, with slices, on a telephone, and what an emulated headset's
# eyes see. By a browser without a GPU in a minute or two.
#
#   scripts/gallery_viewer.sh CASE.sog
#
# Needs a built clipgs, Chromium and ImageMagick.
set -euo pipefail
cd "$(dirname "$0")/.."

if [ $# -ne 1 ]; then
  echo "usage: scripts/gallery_viewer.sh CASE.sog" >&2
  exit 2
fi
if ! command -v convert >/dev/null; then
  echo "gallery: ImageMagick is missing; install the package imagemagick" >&2
  exit 1
fi
case="$(realpath "$1")"
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
(cd web && npx vite-node bench/pictures.ts -- "$case" "$folder")
for name in desk slices phone headset; do
  convert "$folder/$name.png" -quality 85 "docs/gallery/viewer-$name.webp"
done
