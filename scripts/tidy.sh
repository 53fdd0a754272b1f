#!/usr/bin/env bash
# clang-tidy over the project's C++ sources but its tests, as the thread-sanitized preset compiles them: a room's sources
# together, for most of the time goes into headers. The preset has to be configured (cmake --preset tsan) and its rooms
# built, or at least their generated headers.
#
#   scripts/tidy.sh              every room
#   scripts/tidy.sh ROOM...      only these rooms, e.g. core measure
#   scripts/tidy.sh --turn       a fifth of the rooms, in turn from commit to commit
set -euo pipefail
cd "$(dirname "$0")/.."

if ! command -v clang-tidy-19 >/dev/null; then
  echo "tidy: clang-tidy-19 is not installed; skipped" >&2
  exit 0
fi

# Some minutes of processor each.
turns=(
  "core light splat section tour"
  "train bake measure archive"
  "volume study"
  "cinema asset pipeline serve"
  "cli"
)
rooms=("$@")
if [ "${#rooms[@]}" -eq 0 ]; then
  read -ra rooms <<<"${turns[*]}"
elif [ "$1" = --turn ]; then
  read -ra rooms <<<"${turns[$(git rev-list --count HEAD 2>/dev/null || echo 0) % ${#turns[@]}]}"
fi
echo "tidy: ${rooms[*]}"
for room in "${rooms[@]}"; do
  case "$room" in
    cli) target=clipgs ;;
    *) target="clipgs_$room" ;;
  esac
  ls build/tsan/src/"$room/CMakeFiles/$target.dir"/Unity/*.cxx
  # What shares names with its neighbours is compiled alone. Kernels are left out: each is compiled once per instruction
  # set, through macros.
  grep -oE "\"file\": \"[^\"]*/src/$room/[a-z_]+\.cpp\"" build/tsan/compile_commands.json |
    sed -E 's/.*"([^"]+)"$/\1/' | sort -u | grep -vE '_(test|bench|fuzz|kernel)\.cpp$' || true
done | xargs -n 1 -P "$(nproc)" clang-tidy-19 -p build/tsan --quiet --header-filter='src/.*' \
  --extra-arg=-Wno-unknown-warning-option # of GCC's
