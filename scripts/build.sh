#!/usr/bin/env bash
# Builds the release program with its viewer: build/release/src/cli/clipgs.
set -euo pipefail
cd "$(dirname "$0")/.."

bash scripts/setup.sh --build
mkdir -p build
log=build/build.log
echo "build: compiling clipgs; this takes some minutes the first time"
if ! {
  cmake --preset release &&
    cmake --build --preset release --target clipgs
} >"$log" 2>&1; then
  tail -n 40 "$log" >&2
  echo "build: failed; the whole log is $log" >&2
  exit 1
fi
echo "build: build/release/src/cli/clipgs is ready"
