#!/usr/bin/env bash
# Fuzzes what reads files and requests, for as long as you like: one libFuzzer program a format, under the address and
# undefined-behaviour sanitizers. No input may abort, take over 10 s, or more than 4 GB.
#
#   scripts/fuzz.sh [MINUTES [TARGET...]]    MINUTES (default 10) for each target (default: all of them, one after
#                                            another); e.g. scripts/fuzz.sh 60 nifti dicom
#
# Inputs that reached new code are kept in build/fuzzing/TARGET and gone on from; findings are in build/fuzzing/findings,
# and build/asan/src/ROOM/TARGET_fuzz FINDING reads one once again.
set -euo pipefail
cd "$(dirname "$0")/.."

minutes="${1:-10}"
shift || true
bash scripts/setup.sh
cmake --preset asan >/dev/null
cmake --build --preset asan --target fuzz
targets=("$@")
if [ "${#targets[@]}" -eq 0 ]; then
  mapfile -t targets < <(find build/asan/src -name '*_fuzz' -type f -executable -printf '%f\n' | sed 's/_fuzz$//' | sort)
fi

mkdir -p build/fuzzing/findings
status=0
for target in "${targets[@]}"; do
  program="$(find build/asan/src -name "${target}_fuzz" -type f -executable)"
  if [ -z "$program" ]; then
    echo "fuzz: there is no target $target" >&2
    exit 2
  fi
  echo "fuzz: $target for $minutes min"
  mkdir -p "build/fuzzing/$target"
  # Libraries that read files leak when they give up; what must not leak is tested.
  if ! ASAN_OPTIONS=detect_leaks=0 "$program" -max_total_time="$((minutes * 60))" -timeout=10 -rss_limit_mb=4096 \
      -artifact_prefix="build/fuzzing/findings/$target-" "build/fuzzing/$target" >"build/fuzzing/$target.log" 2>&1; then
    echo "fuzz: $target: a finding; see build/fuzzing/$target.log and build/fuzzing/findings" >&2
    status=1
  fi
  tail -n 1 "build/fuzzing/$target.log"
done
exit "$status"
