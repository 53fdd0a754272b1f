#!/usr/bin/env bash
# Cuts as XClipGS measures them (docs/method.md, Metrics), of a case of the abdomen, at 512 pixels. Prints Markdown.
#
#   CLIPGS_DATA=... bench/cuts.sh CASE.sog [FOLDER]    FOLDER (default build/cuts) keeps what is traced
set -euo pipefail
cd "$(dirname "$0")/.."
readonly case="${1:?usage: bench/cuts.sh CASE.sog [FOLDER]}"
set -- "${2:-build/cuts}"
source bench/paper_steps.sh

find_volume abdomen
step "$folder/cuts" "$folder/cuts/transforms.json" "$clipgs" dataset "${volume[@]}" -o "$folder/cuts" \
  --preset soft-tissue --train-frames 1 --test-frames 0 --cut-views --size 64 --test-size 512 \
  --test-masked-noise-db 42 --no-section
step "$folder/figures" "$folder/cuts.figures" "$clipgs" eval "$case" --dataset "$folder/cuts" --json "$folder/cuts.figures"
node - "$folder/cuts.figures" <<'JS'
const fs = require("node:fs");
const {show, line, head} = require("./bench/markdown.cjs");
const {rows} = JSON.parse(fs.readFileSync(process.argv[2], "utf8"));
head(["planes", "faces", "clip", "face SSIM", "leak, 10⁻²", "CDE, edge / face, 10⁻²"]);
for (const [split, title, paper] of [
  ["test_cut_axis", "three axes", [".860", ".40", "22.7 / 17.9"]],
  ["test_cut_oblique", "arbitrary normals", [".874", ".13", "23.5 / 14.3"]]]) {
  line([title, "splats", "*XClipGS*", ...paper.map((text) => `*${text}*`)]);
  for (const row of rows.filter((r) => r.split === split)) {
    line([title, row.section, `\`${row.clip}\``, show(row.cut_face_ssim, 3), show(row.cut_leak, 3),
      `${show(row.cut_edge_error, 1)} / ${show(row.cut_face_error, 1)}`]);
  }
}
JS
