#!/usr/bin/env bash
# clang-tidy over the project's C++ sources, as the release build compiles them.
#
#   scripts/tidy.sh              every source but the tests
#   scripts/tidy.sh FOLDER...    only these rooms, e.g. src/core src/measure
set -euo pipefail
cd "$(dirname "$0")/.."

if ! command -v clang-tidy-19 >/dev/null; then
  echo "tidy: clang-tidy-19 is not installed; skipped" >&2
  exit 0
fi
folders=("$@")
if [ "${#folders[@]}" -eq 0 ]; then
  folders=(src)
fi
find "${folders[@]}" -name '*.cpp' ! -name '*_test.cpp' ! -name '*_bench.cpp' ! -name '*fuzz*' -print0 |
  xargs -0 -n 1 -P "$(nproc)" clang-tidy-19 -p build/release --quiet
