#!/usr/bin/env bash
# From a fresh clone, packages installed, without the compiler's cache: minutes to the demo's case, and of all tests.
# Prints Markdown.
set -euo pipefail
cd "$(dirname "$0")/.."

# minutes COMMAND...
minutes() {
  local clone begin
  clone="$(mktemp -d)"
  git clone -q . "$clone"
  begin=$SECONDS
  # A command substitution does not inherit errexit: a failed run must not be reported as a time.
  (cd "$clone" && CCACHE_DISABLE=1 "$@") >&2 || return 1
  awk -v s="$((SECONDS - begin))" 'BEGIN { printf "%.1f", s / 60 }'
  rm -rf "$clone"
}
demo="$(minutes bash scripts/demo.sh --no-serve)"
tests="$(minutes bash scripts/test.sh)"
echo "| command | min |"
echo "|---|---|"
echo "| \`scripts/demo.sh --no-serve\` | $demo |"
echo "| \`scripts/test.sh\` | $tests |"
