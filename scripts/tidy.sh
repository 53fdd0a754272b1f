#!/usr/bin/env bash
# clang-tidy over the project's C++ sources but its tests, as the thread-sanitized preset compiles them: a room's sources
# together, for most of the time goes into headers. The preset has to be configured (cmake --preset tsan) and its rooms
# built, or at least their generated headers.
#
#   scripts/tidy.sh              every room but src/cli
#   scripts/tidy.sh ROOM...      only these rooms, e.g. core measure
set -euo pipefail
cd "$(dirname "$0")/.."

if ! command -v clang-tidy-19 >/dev/null; then
  echo "tidy: clang-tidy-19 is not installed; skipped" >&2
  exit 0
fi
rooms=("$@")
if [ "${#rooms[@]}" -eq 0 ]; then
  rooms=(core volume light cinema splat section train bake asset measure pipeline study serve)
fi
for room in "${rooms[@]}"; do
  objects="CMakeFiles/clipgs_$room.dir"
  ls build/tsan/src/"$room/$objects"/Unity/*.cxx
  # What shares names with its neighbours is compiled alone. Kernels are left out: each is compiled once per instruction
  # set, through macros.
  grep -oE "\"file\": \"[^\"]*/src/$room/[a-z_]+\.cpp\"" build/tsan/compile_commands.json |
    sed -E 's/.*"([^"]+)"$/\1/' | sort -u | grep -vE '_(test|bench|fuzz|kernel)\.cpp$' || true
done | xargs -n 1 -P "$(nproc)" clang-tidy-19 -p build/tsan --quiet --header-filter='src/.*'
