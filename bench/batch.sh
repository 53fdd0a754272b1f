#!/usr/bin/env bash
# What the batch workflow costs over the builds themselves, and that it changes no byte. Prints Markdown.
#
#   bench/batch.sh [CLIPGS [PART...]]      needs snakemake; half an hour on two cores. Parts: hundred, drafts
#
# A hundred phantoms, too small to look at, by the workflow, two at a time and killed once, and as plain builds, two at a
# time; then DRAFTS (8) drafts, one after the other, and two of them step by step: what is counted is the time in which
# no step ran.
set -euo pipefail
here="$(cd "$(dirname "$0")/.." && pwd)"
clipgs="$(realpath "${1:-$here/build/release/src/cli/clipgs}")"
export SOURCE_DATE_EPOCH=1700000000
[ $# -lt 2 ] && parts="hundred drafts" || parts="${*:2}"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

# batch CSV CONFIG OUT CORES WORD...: the workflow on so many cores.
batch() {
  local cases="$1" config="$2" out="$3" cores="$4"
  shift 4
  exec snakemake -s "$here/batch/Snakefile" --profile "$here/batch/profiles/local" --cores "$cores" \
    --configfile "$config" --config "cases=$cases" "out=$out" "$@" >>"$work/log" 2>&1
}

# seconds_in OUT: of all steps.
seconds_in() {
  python3 - "$1" <<'END'
import glob, json, sys
files = [f for f in glob.glob(f"{sys.argv[1]}/*.clipgs-work/batch/*.json")]
print(round(sum(json.load(open(f))["seconds"] for f in files), 1))
END
}

now() { date +%s.%N; }
since() { echo "$(now) $1" | awk '{printf "%.1f", $1 - $2}'; }

make_table() {
  local count="$1" side="$2" seed
  echo "name,volume,title"
  for seed in $(seq "$count"); do
    "$clipgs" --quiet phantom "$work/$side-$seed.nrrd" --size "$side" --seed "$seed" >/dev/null
    echo "phantom-$seed,$side-$seed.nrrd,Phantom $seed"
  done
}

part_hundred() {
  local begin main by_batch plain overview seed same=0
  make_table 100 24 >"$work/hundred.csv"
  echo "{clipgs: $clipgs, threads: 1, options: {quality: draft, size: 32, train-frames: 4, test-frames: 1," \
    "uncut-frames: 1, budget: 500, steps: 20}}" >"$work/tiny.yaml"
  begin="$(now)"
  (batch "$work/hundred.csv" "$work/tiny.yaml" "$work/hundred" 2) &
  main=$!
  until [ "$(find "$work/hundred" -name build.done 2>/dev/null | wc -l)" -ge 40 ]; do
    sleep 0.2
  done
  kill -9 "$main"
  wait "$main" 2>/dev/null || true
  (batch "$work/hundred.csv" "$work/tiny.yaml" "$work/hundred" 2)
  by_batch="$(since "$begin")"
  begin="$(now)"
  mkdir "$work/alone"
  seq 100 | xargs -P 2 -I SEED "$clipgs" --quiet --threads 1 build "$work/24-SEED.nrrd" -o "$work/alone/phantom-SEED.sog" \
    --title "Phantom SEED" --quality draft --size 32 --train-frames 4 --test-frames 1 --uncut-frames 1 --budget 500 \
    --steps 20 >/dev/null 2>&1
  plain="$(since "$begin")"
  for seed in $(seq 100); do
    cmp -s "$work/alone/phantom-$seed.sog" "$work/hundred/phantom-$seed.sog" && same=$((same + 1))
  done
  begin="$(now)"
  "$clipgs" overview "$work/hundred" >/dev/null
  overview="$(since "$begin")"
  cat <<END
| 100 phantoms, two at a time | |
|---|---|
| by the workflow, killed once and run again, measured as well | $by_batch s |
| plain builds | $plain s |
| of the same bytes | $same of 100 |
| their overview | $overview s |

END
}

part_drafts() {
  local count="${DRAFTS:-8}" run steps begin wall own
  make_table "$count" 64 >"$work/all.csv"
  head -n 3 "$work/all.csv" >"$work/two.csv"
  echo "{clipgs: $clipgs, threads: 2, options: {quality: draft, train-frames: 300, steps: 1000, uncut-frames: 2}}" \
    >"$work/drafts.yaml"
  echo "| drafts | steps themselves | by the workflow | over them |"
  echo "|---|---|---|---|"
  for run in all:whole two:apart; do
    steps="${run#*:}"
    begin="$(now)"
    (batch "$work/${run%:*}.csv" "$work/drafts.yaml" "$work/$steps" 2 "steps=$steps")
    wall="$(since "$begin")"
    own="$(seconds_in "$work/$steps")"
    echo "$run $own $wall $count" | awk '{
      n = $1 ~ /^all/ ? $4 : 2; sub(/.*:/, "", $1)
      printf "| %d, %s | %.1f s | %.1f s | %.1f %% |\n", n, $1, $2, $3, 100 * ($3 - $2) / $2 }'
  done
}

for part in $parts; do
  "part_$part"
done
