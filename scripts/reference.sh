#!/usr/bin/env bash
# The reference of the headers by Doxygen, in build/reference/html. Ends with 1 if Doxygen warns of anything, or a type
# says nothing of itself.
set -euo pipefail
cd "$(dirname "$0")/.."

if ! command -v doxygen >/dev/null; then
  echo "reference: doxygen is not installed; skipped" >&2
  exit 0
fi
mkdir -p build/reference
doxygen docs/Doxyfile
# Members whose names say it all need no comment.
if grep -vE 'Member .* is not documented' build/reference/warnings; then
  echo "reference: Doxygen warns, see above" >&2
  exit 1
fi
echo "build/reference/html/index.html"
