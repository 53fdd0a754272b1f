#!/usr/bin/env bash
# Tries the workflow on this machine: phantoms too small to look at, among them rows that cannot be built; it is killed
# and run again, and the cases must have the bytes of those built one by one, whole or apart.
#
#   batch/test_batch.sh [CLIPGS]         needs snakemake (apt-get install snakemake); half a minute
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
clipgs="$(realpath "${1:-$here/../build/release/src/cli/clipgs}")"
export SOURCE_DATE_EPOCH=1700000000 # the day in a case
export PYTHONDONTWRITEBYTECODE=1
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

fail() {
  echo "test_batch: $*" >&2
  tail -n 60 "$work/log" >&2 || true
  exit 1
}

python3 "$here/test_table.py" || fail "the checks of tables"
command -v snakemake >/dev/null || fail "there is no snakemake; apt-get install snakemake"

options=(--quality draft --size 32 --train-frames 4 --test-frames 1 --uncut-frames 1 --budget 500 --steps 20)
for seed in 1 2 3; do
  "$clipgs" --quiet phantom "$work/$seed.nrrd" --size 24 --seed "$seed" >/dev/null
done
head -c 900 "$work/1.nrrd" >"$work/broken.nrrd"
cat >"$work/cases.csv" <<END
name,volume,title,quality,model,size,train_frames,test-frames,uncut-frames,budget,steps
one,1.nrrd,"One, first",,,,,,,,
two,2.nrrd,,,,,,,,,
papers,3.nrrd,Papers,,clipgs,,,,,,
broken,broken.nrrd,,,,,,,,,
gone,gone.nrrd,,,,,,,,,
END
cat >"$work/tiny.yaml" <<END
clipgs: $clipgs
options: {quality: draft, size: 32, train-frames: 4, test-frames: 1, uncut-frames: 1, budget: 500, steps: 20}
END

# batch OUT [WORD...]: in a session of its own, so that all of it can be killed.
batch() {
  local out="$1"
  shift
  exec setsid snakemake -s "$here/Snakefile" --profile "$here/profiles/local" --configfile "$work/tiny.yaml" \
    --config "cases=$work/cases.csv" "out=$work/$out" threads=1 "$@" >>"$work/log" 2>&1
}

(batch whole) &
main=$!
for _ in $(seq 200); do
  [ ! -s "$work/whole/one.sog" ] || break
  sleep 0.05
done
kill -9 "$main"
wait "$main" 2>/dev/null || true
[ -s "$work/whole/one.sog" ] || fail "nothing was begun"
[ ! -e "$work/whole/one.clipgs-work/batch/build.done" ] || fail "the first case was done before it was killed"
for _ in $(seq 100); do
  left="$(pgrep -f "^$clipgs .*$work" || true)"
  [ -n "$left" ] || break
  sleep 0.1
done
[ -z "$left" ] || fail "a killed batch leaves its steps running"

if (batch whole); then
  fail "a batch with rows that cannot be built must not end well"
fi
if (batch apart steps=apart); then
  fail "a batch with rows that cannot be built must not end well"
fi
grep -q '^line-6: check: cases.csv:6: gone.nrrd: there is no such volume$' "$work/log" || fail "a missing volume"
grep -q '^broken: build: clipgs: .*broken.nrrd' "$work/log" || fail "a broken volume"

mkdir "$work/alone"
"$clipgs" --quiet build "$work/1.nrrd" -o "$work/alone/one.sog" --title "One, first" "${options[@]}" >/dev/null 2>&1
"$clipgs" --quiet build "$work/2.nrrd" -o "$work/alone/two.sog" "${options[@]}" >/dev/null 2>&1
"$clipgs" --quiet build "$work/3.nrrd" -o "$work/alone/papers.sog" --title Papers --model clipgs "${options[@]}" >/dev/null 2>&1
for name in one two papers; do
  cmp "$work/alone/$name.sog" "$work/whole/$name.sog" || fail "$name has other bytes than built alone"
  [ -s "$work/whole/$name.figures" ] && [ -s "$work/apart/$name.figures" ] || fail "$name was not measured"
done
for name in one two; do
  cmp "$work/alone/$name.sog" "$work/apart/$name.sog" || fail "$name has other bytes when its steps are jobs of their own"
done
grep -q "layered" "$work/apart/papers.figures" || fail "the layered scene was not measured beside the papers' way"

page="$work/whole/overview/index.html"
grep -q '5 cases: 3 finished, 2 failed, 0 not finished' "$page" || fail "the overview's counts"
grep -q 'data-name="broken" data-kind="failed".*build: clipgs: …' "$page" || fail "the overview does not say why"
! grep -q "$work" "$page" || fail "the overview names a file"

# What is put right, or was taken away, is made; the rest is left alone.
sed -i '/^broken/d; /^gone/d' "$work/cases.csv"
rm "$work/whole/two.sog"
before="$(stat -c %Y.%i "$work/whole/one.sog")"
(batch whole) || fail "a batch that was put right"
cmp "$work/alone/two.sog" "$work/whole/two.sog" || fail "a case that was taken away was not made again"
[ "$before" = "$(stat -c %Y.%i "$work/whole/one.sog")" ] || fail "a case was made again for nothing"
grep -q '3 cases: 3 finished, 0 failed' "$page" || fail "the overview after it was put right"

# Another title is packed again, not trained again.
sed -i 's/One, first/First/' "$work/cases.csv"
trained="$(stat -c %Y.%i "$work/apart/one.clipgs-work/scene.ply")"
(batch apart steps=apart) || fail "a batch with another title"
"$clipgs" info "$work/apart/one.sog" >"$work/info"
grep -q 'title *First$' "$work/info" || fail "another title did not reach the case"
[ "$trained" = "$(stat -c %Y.%i "$work/apart/one.clipgs-work/scene.ply")" ] || fail "another title trained again"

# What is wrong with the whole table is one line.
echo "name,volum" >"$work/cases.csv"
if (batch apart); then
  fail "a table without volumes"
fi
[ "$(tail -n 1 "$work/log")" = "batch: $work/cases.csv: there is no column \"volum\"; did you mean \"volume\"?" ] ||
  fail "what is wrong with the whole table is not said in one line"
echo "test_batch: passed in $SECONDS s"
