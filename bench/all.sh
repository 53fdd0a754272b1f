#!/usr/bin/env bash
# Every table of docs/benchmarks.md anew, made by one program, and put in its place there; what tables are made of is
# kept in docs/figures.
#
#   CLIPGS_DATA=... bench/all.sh [FOLDER] [PART...]    FOLDER (default build/all) keeps everything; the parts, if not
#                                                      all, are those of `parts` below
#
# Takes hours on two cores, which should have nothing else to do: what is timed comes first. Stop it whenever you
# like; run again, it goes on. It refuses to go on with other sources than it began with. Needs Chromium, the packages
# `time` and `snakemake`, and Blender with python3-openvdb for one of the tables.
set -euo pipefail
cd "$(dirname "$0")/.."
all="$(realpath -m "${1:-build/all}")"
shift || true
readonly parts=(instant draft standard tracer kernels viewer archive batch flicker seeds operators cuts papers ablation samples clone)
[ $# -gt 0 ] || set -- "${parts[@]}"
mkdir -p "$all/tables"

# What figures depend on: documents may change meanwhile.
sources="$(git rev-parse HEAD:src HEAD:presets HEAD:web/src HEAD:web/bench | sha256sum | cut -c 1-16)"
if [ -f "$all/sources" ] && [ "$(<"$all/sources")" != "$sources" ]; then
  echo "all: $all was begun with other sources, at commit $(<"$all/commit"): check that out, or use another FOLDER" >&2
  exit 1
fi
if [ ! -f "$all/sources" ]; then
  git diff --quiet HEAD -- src presets web || { echo "all: commit what you changed in src, presets and web first" >&2; exit 1; }
  bash scripts/build.sh >&2
  cp build/release/src/cli/clipgs "$all/clipgs"
  git rev-parse --short HEAD >"$all/commit"
  echo "$sources" >"$all/sources"
fi
export CLIPGS="$all/clipgs" TRUTH="$all/truth"
readonly volumes="head chest abdomen stent"
# Of the papers' models: half an hour a volume.
readonly paper_settings=(env TRAIN_FRAMES=1500 TRAIN_SPP=4 TEST_FRAMES=10 BUDGET=60000 STEPS=3000
  REFINE_BUDGET=120000 REFINE_STEPS=3000 SECTION_STEPS=2500)

part_instant() { CASES="$volumes" bash bench/instant.sh "$all/instant"; }
part_draft() { CASES="$volumes mr phantom" QUALITY=draft bash bench/curve.sh "$all/draft"; }
part_standard() { CASES="$volumes" QUALITY=standard bash bench/curve.sh "$all/standard"; }
part_seeds() { CASES="$volumes" BUILT="$all/standard" bash bench/seeds.sh "$all/seeds"; }
part_operators() { CASES="head abdomen" BUILT="$all/standard" bash bench/operators.sh "$all/operators"; }
part_cuts() { bash bench/cuts.sh "$all/draft/abdomen/case.sog" "$all/cuts"; }
part_papers() { CASES="$volumes" "${paper_settings[@]}" bash bench/paper_tables.sh "$all/papers"; }
part_ablation() { CASES=head "${paper_settings[@]}" bash bench/ablation.sh "$all/papers"; }
part_samples() { BUDGET=20000 STEPS=1500 bash bench/dataset.sh "$all/samples"; }
part_tracer() { bash bench/cinema.sh; }
part_kernels() { bash bench/kernels.sh; }
part_viewer() { bash bench/web.sh "$all/standard/head/case.sog" "$all/standard/abdomen/case.sog"; }
part_archive() { bash bench/archive.sh "$CLIPGS"; }
part_batch() { bash bench/batch.sh "$CLIPGS" drafts; }
part_flicker() {
  bash bench/flicker.sh "$all/draft/abdomen/case.sog" "$CLIPGS_DATA/abdomen_pelvis_3mm.nii.gz" "$all/flicker" --steps 8
}
part_clone() { bash bench/clone.sh; }

# store PART: what its tables are made of, into docs/figures.
store() {
  local from="$all/$1" to="$PWD/docs/figures/$1"
  [ -d "$from" ] || return 0
  rm -rf "$to"
  mkdir -p "$to"
  (cd "$from" && find . \( -name work -o -name dataset \) -prune -o -type f -regextype posix-extended \
    -regex '.*(\.(figures|seconds|bytes|picture|settings)|/(settings|kilobytes|bake\.json))' \
    -not -regex '.*-[0-9]+\.seconds' -print0 |
    tar --null -T - -cf - | tar -xf - -C "$to")
}

for part in "$@"; do
  table="$all/tables/$part.md"
  if [ ! -f "$table" ]; then
    echo "all: $part" >&2
    {
      "part_$part"
      printf '\nMade at commit %s by `bench/all.sh`.\n' "$(<"$all/commit")"
    } >"$table.part"
    mv "$table.part" "$table"
  fi
  store "${part/ablation/papers}"
done
node bench/tables.cjs docs/benchmarks.md "$all/tables"
for plot in draft/curve.svg samples/samples.svg; do
  [ ! -f "$all/$plot" ] || cp "$all/$plot" docs/
done
