#!/usr/bin/env bash
# Installs the libraries, builds the example of another program with them, as it would be built elsewhere, and holds its
# picture of a small case to the program's own.
#
#   packaging/find_package_test.sh BUILD
set -euo pipefail
cd "$(dirname "$0")/.."

readonly build="$1"
readonly clipgs="$build/src/cli/clipgs"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

cmake --install "$build" --component development --prefix "$work/prefix" >"$work/log"
cp -r examples/cut_and_draw "$work/example"
cmake -G Ninja -S "$work/example" -B "$work/example/build" -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_CXX_FLAGS="-Wall -Wextra -Werror"
cmake --build "$work/example/build"

"$clipgs" phantom "$work/body.nrrd" --size 40 >>"$work/log"
"$clipgs" build "$work/body.nrrd" -o "$work/body.sog" --quality draft --size 48 --train-frames 4 --test-frames 1 \
  --steps 40 --budget 1000 --quiet
"$work/example/build/cut_and_draw" "$work/body.sog" "$work/example.png"
# The same plane: the program divides all four numbers by the length of the normal.
plane="$("$clipgs" info --json "$work/body.sog" | python3 -c '
import json, sys
x, y, z = json.load(sys.stdin)["center_ras_mm"]
print(1, -2, -1, x - 2 * y - z, sep=",")')"
"$clipgs" render "$work/body.sog" -o "$work/own.png" --size 1024x1024 --plane="$plane" --view 20,15 --background 1,1,1
# But for rounding of the plane.
alike="$(ffmpeg -v info -i "$work/example.png" -i "$work/own.png" -lavfi psnr -f null - 2>&1 |
  sed -n 's/.*average:\([0-9.inf]*\).*/\1/p')"
echo "find_package: the example's picture beside the program's own: $alike dB"
python3 -c "exit(not float('$alike') > 60)"
