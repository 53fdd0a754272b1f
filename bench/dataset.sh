#!/usr/bin/env bash
# How many samples a training picture needs: models trained for as many steps on few clean pictures
# and on many noisy ones that took as many paths in all, against one set of test pictures. Prints a
# Markdown table; the same as a plot lies in FOLDER/samples.svg.
#
#   CLIPGS_DATA=... bench/dataset.sh [FOLDER]    FOLDER (default build/bench-dataset) keeps pictures,
#                                                scenes and figures; what is there is not made again
#
# Everything has a default: VOLUME, with options how to read it, of CLIPGS_DATA; SAMPLES a frame to
# compare; PATHS, frames times samples; SIZE in px; BUDGET of Gaussians; STEPS of training; SEEDS to
# take the mean over; OPTIONS of `clipgs dataset` for the training pictures, whose results need a
# FOLDER of their own.
set -euo pipefail
cd "$(dirname "$0")/.."

if [ -z "${CLIPGS_DATA:-}" ]; then
  echo "dataset: set CLIPGS_DATA to the folder with abdomen_pelvis_3mm.nii.gz" >&2
  exit 2
fi
folder="${1:-build/bench-dataset}"
read -ra volume <<<"${VOLUME:-abdomen_pelvis_3mm.nii.gz}"
read -ra samples <<<"${SAMPLES:-4 8 16 32 64 128}"
read -ra seeds <<<"${SEEDS:-1}"
read -ra options <<<"${OPTIONS:-}"
readonly paths="${PATHS:-2400}" size="${SIZE:-192}" budget="${BUDGET:-40000}" steps="${STEPS:-4000}"
readonly clipgs=build/release/src/cli/clipgs
bash scripts/build.sh >&2
mkdir -p "$folder"

# dataset NAME SEED TRAIN-FRAMES TEST-FRAMES [OPTION...]
dataset() {
  "$clipgs" dataset "$CLIPGS_DATA/${volume[0]}" "${volume[@]:1}" -o "$folder/$1" --size "$size" --seed "$2" \
    --train-frames "$3" --test-frames "$4" "${@:5}" >&2
}

# measure SAMPLES SEED: trains on PATHS / SAMPLES frames and leaves figures.
measure() {
  local name="$1-$2" frames=$(((paths + $1 / 2) / $1))
  if [ ! -f "$folder/$name.figures" ]; then
    dataset "$name" "$((100 + $2))" "$frames" 0 --train-spp "$1" --points "$budget" "${options[@]}"
    "$clipgs" train "$folder/$name" -o "$folder/$name.ply" --budget "$budget" --steps "$steps" --seed "$2" >&2
    "$clipgs" eval "$folder/$name.ply" --dataset "$folder/test" --clip exact --section volume \
      --json "$folder/$name.figures" >&2
  fi
}

# Cameras and planes of its own, so that it suits every row.
dataset test 1 1 12 --no-section
for seed in "${seeds[@]}"; do
  for spp in "${samples[@]}"; do
    measure "$spp" "$seed"
  done
done

node - "$folder" "$paths" "${samples[*]}" "${seeds[*]}" <<'JS'
const fs = require("node:fs");
const [folder, paths, samples, seeds] = process.argv.slice(2);
const splits = ["test_axis", "test_oblique"];
const mean = (values) => values.reduce((a, b) => a + b, 0) / values.length;
const masked = (prefix, split) =>
  JSON.parse(fs.readFileSync(`${prefix}.figures`, "utf8")).rows.find((row) => row.split === split).psnr_masked;
const rows = samples.split(" ").map(Number).map((spp) => {
  const prefixes = seeds.split(" ").map((seed) => `${folder}/${spp}-${seed}`);
  return {
    spp,
    frames: Math.round(paths / spp),
    db: splits.map((split) => mean(prefixes.map((prefix) => masked(prefix, split)))),
  };
});

console.log("| samples a pixel | frames | masked PSNR, dB, axis / oblique | mean, dB |\n|---|---|---|---|");
for (const row of rows) {
  const db = row.db.map((value) => value.toFixed(2)).join(" / ");
  console.log(`| ${row.spp} | ${row.frames} | ${db} | ${mean(row.db).toFixed(2)} |`);
}

// The plot: samples on a logarithmic axis.
const [width, height, margin] = [560, 320, 48];
const all = rows.flatMap((row) => row.db);
const [low, high] = [Math.floor(Math.min(...all)), Math.ceil(Math.max(...all))];
const logs = rows.map((row) => Math.log2(row.spp));
const [first, last] = [Math.min(...logs), Math.max(...logs)];
const x = (spp) => margin + ((Math.log2(spp) - first) / Math.max(last - first, 1)) * (width - 2 * margin);
const y = (db) => height - margin - ((db - low) / Math.max(high - low, 1)) * (height - 2 * margin);
const text = (at, down, anchor, what) => `<text x="${at}" y="${down}" text-anchor="${anchor}">${what}</text>`;
const parts = [];
for (let db = low; db <= high; ++db) {
  parts.push(`<path d="M${margin} ${y(db)}H${width - margin}" stroke="#ddd"/>`, text(margin - 6, y(db) + 4, "end", db));
}
for (const row of rows) {
  parts.push(text(x(row.spp), height - margin + 18, "middle", row.spp));
}
["#1769aa", "#c2571a"].forEach((colour, split) => {
  const points = rows.map((row) => [x(row.spp).toFixed(1), y(row.db[split]).toFixed(1)]);
  parts.push(`<polyline points="${points.join(" ")}" fill="none" stroke="${colour}" stroke-width="2"/>`);
  parts.push(...points.map(([px, py]) => `<circle cx="${px}" cy="${py}" r="3.5" fill="${colour}"/>`));
  parts.push(`<g fill="${colour}">${text(width - margin, 20 + 16 * split, "end", ["axis", "oblique"][split])}</g>`);
});
parts.push(text(width / 2, height - 10, "middle", `samples a pixel, ${paths} paths a pixel in all`), text(margin, 20, "start", "masked PSNR, dB"));
fs.writeFileSync(`${folder}/samples.svg`,
  `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" font-family="sans-serif" font-size="12">\n` +
  `<rect width="${width}" height="${height}" fill="#fff"/>\n${parts.join("\n")}\n</svg>\n`);
JS
