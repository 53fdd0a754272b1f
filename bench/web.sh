#!/usr/bin/env bash
# The viewer in numbers: its frames beside those of other viewers, and what it costs a browser besides.
#
#   bench/web.sh CASE.sog [OTHER.sog] [--size PX] [--frames N] [--rounds N] [--shots FOLDER] [--alone]
#
# OTHER is what is switched to; --alone leaves the other viewers' frames out. Needs a built clipgs, Chromium, and the npm
# registry for the other viewers.
set -euo pipefail
cd "$(dirname "$0")/.."

cases=()
while [ $# -gt 0 ] && [ "${1#--}" = "$1" ]; do
  cases+=("$(realpath "$1")")
  shift
done
if [ "${#cases[@]}" -eq 0 ]; then
  echo "usage: bench/web.sh CASE.sog [OTHER.sog] [--size PX] [--frames N] [--rounds N] [--shots FOLDER] [--alone]" >&2
  exit 2
fi

cd web
[ -d node_modules ] || npm ci --silent
[ -d bench/peers/node_modules ] || npm ci --silent --prefix bench/peers
npx vite-node bench/costs.ts -- "${cases[@]}"
npx vite-node bench/frames.ts -- "${cases[0]}" "$@"
