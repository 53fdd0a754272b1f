// The table of seeds.sh: masked PSNR over seeds, from SEED-SPLIT-SIZE.figures of each case.
//
//   node bench/seeds.cjs FOLDER SPLIT SIZE SMALL "SEED..." CASE...
const fs = require("node:fs");
const {kinds, show, mean, line, head} = require("./markdown.cjs");

const [folder, split, size, small, seedList, ...cases] = process.argv.slice(2);
const seeds = seedList.split(" ");
const psnr = (name, seed, px, kind) =>
  JSON.parse(fs.readFileSync(`${folder}/${name}/${seed}-${split}-${px}.figures`, "utf8"))
    .rows.find((row) => row.split === `${split}_${kind}`)?.psnr_masked;
const span = (values) => `${show(mean(values), 2)} (${show(Math.min(...values), 2)} to ${show(Math.max(...values), 2)})`;

console.log(`Masked PSNR in dB over ${seeds.length} seeds of training, mean (least to most):\n`);
for (const px of [size, small]) {
  head([`${px} × ${px} px`, ...cases, "mean"]);
  for (const [kind, title] of kinds) {
    const bySeed = seeds.map((seed) => cases.map((name) => psnr(name, seed, px, kind)));
    line([title, ...cases.map((_, i) => span(bySeed.map((values) => values[i]))), span(bySeed.map(mean))]);
  }
  console.log();
}
