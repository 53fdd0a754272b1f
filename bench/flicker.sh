#!/usr/bin/env bash
# How calm the viewer's pictures are while a camera turns by 0.2° a step, and while a plane moves, beside path-traced
# truth. Prints Markdown.
#
#   bench/flicker.sh CASE.sog VOLUME FOLDER [--options "--hu 16,-1024"] [--size PX] [--steps N] [--spp N]
#
# FOLDER keeps what is traced, two pictures a step; what is there is not traced again. --options read the volume. Needs a
# built clipgs and Chromium.
set -euo pipefail
cd "$(dirname "$0")/.."

if [ $# -lt 3 ]; then
  echo "usage: bench/flicker.sh CASE.sog VOLUME FOLDER [--options TEXT] [--size PX] [--steps N] [--spp N]" >&2
  exit 2
fi
paths=("$(realpath "$1")" "$(realpath "$2")" --folder "$(realpath -m "$3")")
cd web
[ -d node_modules ] || npm ci --silent
npx vite-node bench/flicker.ts -- "${paths[@]}" "${@:4}"
