#!/usr/bin/env bash
# Builds the release and packs it for the Debian or Ubuntu that it was built on: build/package/clipgs_VERSION_ARCHITECTURE.deb.
set -euo pipefail
cd "$(dirname "$0")/.."

cmake --preset release >/dev/null
cmake --build --preset release --target clipgs
cpack --config build/release/CPackConfig.cmake -B build/package
rm -rf build/package/_CPack_Packages
