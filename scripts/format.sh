#!/usr/bin/env bash
# Formats every C++ source of the project; with --check it only says what would change.
set -euo pipefail
cd "$(dirname "$0")/.."

arguments=(-i)
if [ "${1:-}" = --check ]; then
  arguments=(--dry-run --Werror)
fi
find src web/wasm examples \( -name '*.cpp' -o -name '*.h' \) -print0 |
  xargs -0 clang-format-19 "${arguments[@]}"
