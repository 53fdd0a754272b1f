#!/usr/bin/env bash
# The figures of docs/benchmarks.md: builds cases of the volumes in CLIPGS_DATA from scratch, measures
# them against their test pictures, times a training step, and prints it all as Markdown.
#
#   CLIPGS_DATA=... scripts/bench.sh [FOLDER]    FOLDER (default build/bench) keeps cases, figures and
#                                                reports; a case that is there already is only printed
#
# Takes hours. Needs the package `time` for the peak memory. What costs time is measured in a fresh
# clone without the compiler's cache.
set -euo pipefail
cd "$(dirname "$0")/.."

if [ -z "${CLIPGS_DATA:-}" ]; then
  echo "bench: set CLIPGS_DATA to the folder with head.nrrd, chest.nrrd and abdomen_pelvis_3mm.nii.gz" >&2
  exit 2
fi
if [ ! -x /usr/bin/time ]; then
  echo "bench: /usr/bin/time is missing; install the package time" >&2
  exit 1
fi
folder="${1:-build/bench}"
readonly clipgs=build/release/src/cli/clipgs
bash scripts/build.sh >&2
mkdir -p "$folder"

# bench NAME VOLUME QUALITY [LOADING...]: builds and measures one case.
bench() {
  local name="$1" volume="$2" quality="$3" case="$folder/$1.sog"
  shift 3
  local command=(build "$CLIPGS_DATA/$volume" -o "$case" --quality "$quality" "$@")
  if [ ! -f "$folder/$name.figures" ]; then
    echo "bench: building $case" >&2
    /usr/bin/time -f '{"seconds": %e, "kilobytes": %M}' -o "$folder/$name.time" "$clipgs" "${command[@]}" >&2
    "$clipgs" eval "$case" --dataset "$folder/$name.clipgs-work/dataset" \
      --json "$folder/$name.figures" --report "$folder/$name.html" >&2
  fi
  node - "$folder/$name" "clipgs ${command[*]/$CLIPGS_DATA\//}" <<'JS'
const fs = require("node:fs");
const [prefix, command] = process.argv.slice(2);
const figures = JSON.parse(fs.readFileSync(`${prefix}.figures`, "utf8"));
const time = JSON.parse(fs.readFileSync(`${prefix}.time`, "utf8"));
const show = (value, digits) => (value === null ? "–" : value.toFixed(digits));
const name = prefix.split("/").pop();
console.log(`### ${name}\n\n\`${command.replaceAll(prefix, name)}\`\n`);
console.log(
  `${(time.seconds / 60).toFixed(1)} min, peak memory ${(time.kilobytes / 1048576).toFixed(2)} GiB; ` +
    `${figures.splats} Gaussians, ${(figures.bytes / 1e6).toFixed(2)} MB. Noise floor of the truth: ` +
    Object.entries(figures.noise_floor_db).map(([split, db]) =>
      `${split} ${db.toFixed(1)} dB (masked ${figures.masked_noise_floor_db[split].toFixed(1)} dB)`).join(", ") + ".\n");
console.log("| split | section | clip | masked PSNR, dB | PSNR, dB | SSIM | band SSIM | leak, 10⁻² | pictures |");
console.log("|---|---|---|---|---|---|---|---|---|");
for (const row of figures.rows) {
  console.log(
    `| ${row.split} | ${row.section} | ${row.clip} | ${show(row.psnr_masked, 2)} | ${show(row.psnr, 2)} | ${show(row.ssim, 4)} | ` +
      `${show(row.band_ssim, 4)} | ${show(row.leak, 3)} | ${row.images} |`);
}
console.log();
JS
}

# budgets NAME: masked PSNR against the number of Gaussians, with the section and without, after a short
# training on the pictures that bench left.
budgets() {
  local dataset="$folder/$1.clipgs-work/dataset" count option scene
  echo "| Gaussians | with the section, axis / oblique | splats alone, axis / oblique |"
  echo "|---|---|---|"
  for count in 15000 30000 60000 120000; do
    for option in "" --no-section; do
      scene="$folder/$1-$count$option.ply"
      if [ ! -f "$scene.figures" ]; then
        "$clipgs" train "$dataset" -o "$scene" --budget "$count" --steps 4000 --sh-degree 2 $option >&2
        "$clipgs" eval "$scene" --dataset "$dataset" --clip exact --json "$scene.figures" >&2
      fi
    done
    node - "$folder/$1-$count" <<'JS'
const fs = require("node:fs");
const prefix = process.argv[2];
// Rows of the volume come first.
const masked = (file) => ["test_axis", "test_oblique"].map((split) =>
  JSON.parse(fs.readFileSync(file, "utf8")).rows.find((row) => row.split === split).psnr_masked.toFixed(2)).join(" / ");
console.log(`| ${prefix.split("-").pop()} | ${masked(`${prefix}.ply.figures`)} | ${masked(`${prefix}--no-section.ply.figures`)} |`);
JS
  done
}

# minutes_in_clone COMMAND...: how long it takes from a fresh clone to its end.
minutes_in_clone() {
  local clone begin
  clone="$(mktemp -d)"
  git clone -q . "$clone"
  begin=$SECONDS
  # A command substitution does not inherit errexit: a failed run must not be reported as a time.
  (cd "$clone" && CCACHE_DISABLE=1 "$@") >&2 || return 1
  awk -v s="$((SECONDS - begin))" 'BEGIN { printf "%.1f", s / 60 }'
  rm -rf "$clone"
}

cat <<EOF2
# Benchmarks

Made by \`CLIPGS_DATA=... scripts/bench.sh > docs/benchmarks.md\` on $(nproc) cores of
$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1) and no graphics card. Test pictures have
views and planes that training never saw. [method.md](method.md#7-metrics) defines the columns; masked
PSNR is the one to compare.

## Cases

EOF2
bench head head.nrrd standard --hu 16,-1024
bench chest chest.nrrd standard
bench abdomen abdomen_pelvis_3mm.nii.gz standard
bench abdomen-draft abdomen_pelvis_3mm.nii.gz draft

cat <<'EOF2'
## Gaussians against fidelity

Masked PSNR, dB, under the exact operator after 4,000 steps on the pictures of the head.

EOF2
budgets head

cat <<'EOF2'

## A picture of a face

`build/release/src/section/face_bench`: 1024 × 1024 pixels on one core; `covered` is the share of the
picture that the face takes.

```
EOF2
cmake --build --preset release --target face_bench >&2
build/release/src/section/face_bench 2>/dev/null
echo '```'

cat <<'EOF2'
## One training step

Forward, loss, backward and Adam, `build/release/src/train/train_bench`: size of the picture in pixels,
number of Gaussians, SH degree, and whether a plane cuts (exact).

```
EOF2
cmake --build --preset release --target train_bench >&2
build/release/src/train/train_bench --benchmark_min_time=5 2>/dev/null
echo '```'

demo="$(minutes_in_clone bash scripts/demo.sh --no-serve)"
tests="$(minutes_in_clone bash scripts/test.sh)"
cat <<EOF2

## From a clone, packages installed

| command | min |
|---|---|
| \`scripts/demo.sh --no-serve\` | $demo |
| \`scripts/test.sh\` | $tests |
EOF2
