#!/usr/bin/env bash
# What the batch workflow costs over the builds themselves, and that it changes no byte. Prints Markdown.
#
#   bench/batch.sh [CLIPGS]          needs snakemake; some twenty minutes on two cores
#
# A hundred phantoms, too small to look at, by the workflow, two at a time and killed once, and one by one; then eight
# drafts, one after the other, and two of them step by step: what is counted is the time in which no step ran.
set -euo pipefail
here="$(cd "$(dirname "$0")/.." && pwd)"
clipgs="$(realpath "${1:-$here/build/release/src/cli/clipgs}")"
export SOURCE_DATE_EPOCH=1700000000
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

# --- a hundred, the same bytes ---
make_table 100 24 >"$work/hundred.csv"
tiny=(--quality draft --size 32 --train-frames 4 --test-frames 1 --uncut-frames 1 --budget 500 --steps 20)
echo "{clipgs: $clipgs, threads: 1, options: {quality: draft, size: 32, train-frames: 4, test-frames: 1," \
  "uncut-frames: 1, budget: 500, steps: 20}}" >"$work/tiny.yaml"
begin="$(now)"
(batch "$work/hundred.csv" "$work/tiny.yaml" "$work/hundred" 2) &
main=$!
until [ -e "$work/hundred/phantom-40.sog" ] || [ "$(ls "$work/hundred" 2>/dev/null | grep -c sog)" -ge 40 ]; do
  sleep 0.2
done
kill -9 "$main"
wait "$main" 2>/dev/null || true
(batch "$work/hundred.csv" "$work/tiny.yaml" "$work/hundred" 2)
by_batch="$(since "$begin")"
begin="$(now)"
mkdir "$work/alone"
same=0
for seed in $(seq 100); do
  "$clipgs" --quiet --threads 1 build "$work/24-$seed.nrrd" -o "$work/alone/phantom-$seed.sog" \
    --title "Phantom $seed" "${tiny[@]}" >/dev/null 2>&1
  cmp -s "$work/alone/phantom-$seed.sog" "$work/hundred/phantom-$seed.sog" && same=$((same + 1))
done
one_by_one="$(since "$begin")"
overview_begin="$(now)"
"$clipgs" overview "$work/hundred" >/dev/null
overview="$(since "$overview_begin")"

# --- eight of a usual length, what the workflow adds ---
make_table 8 64 >"$work/eight.csv"
echo "{clipgs: $clipgs, threads: 2, options: {quality: draft, train-frames: 400, steps: 1200, uncut-frames: 2}}" >"$work/eight.yaml"
rows=
head -n 3 "$work/eight.csv" >"$work/two.csv"
for run in eight:whole two:apart; do
  steps="${run#*:}"
  begin="$(now)"
  (batch "$work/${run%:*}.csv" "$work/eight.yaml" "$work/$steps" 2 "steps=$steps")
  wall="$(since "$begin")"
  own="$(seconds_in "$work/$steps")"
  share="$(echo "$wall $own" | awk '{printf "%.1f", 100 * ($1 - $2) / $2}')"
  rows+="| ${run%:*} drafts, $steps | $own | $wall | $share % |"$'\n'
done

cat <<END
| | s |
|---|---|
| 100 phantoms by the workflow, two at a time, killed once | $by_batch |
| one by one | $one_by_one |
| of the same bytes | $same of 100 |
| their overview | $overview |

| | steps themselves, s | by the workflow, s | over them |
|---|---|---|---|
$rows
END
