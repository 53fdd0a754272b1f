// The tables of finished cases of curve.sh and instant.sh, from what they left of each case: SPLIT-SIZE.figures.
//
//   node bench/sharpness.cjs FOLDER SPLIT SIZE SMALL CASE...
const fs = require("node:fs");
const {kinds, show, mean, line, head} = require("./markdown.cjs");

const [folder, split, ...rest] = process.argv.slice(2);
const [sizes, cases] = [rest.slice(0, 2), rest.slice(2)];

const figures = (name, size) => JSON.parse(fs.readFileSync(`${folder}/${name}/${split}-${size}.figures`, "utf8"));
const row = (name, size, kind) => figures(name, size).rows.find((r) => r.split === `${split}_${kind}`) ?? {};

for (const size of sizes) {
  console.log(`${size} × ${size} px, masked PSNR in dB (worst picture) / of faces / opened / outside / ꟻLIP:\n`);
  head(["", ...cases, "mean"]);
  for (const [kind, title] of kinds) {
    const all = cases.map((name) => row(name, size, kind));
    const cell = (r) => [`${show(r.psnr_masked, 1)} (${show(r.psnr_masked_worst, 1)})`, show(r.psnr_face, 1),
      show(r.psnr_opened, 1), show(r.psnr_outside, 1), show(r.flip, 3)].join(" / ");
    line([title, ...all.map(cell), show(mean(all.map((r) => r.psnr_masked)), 1)]);
  }
  const noise = (name) => Math.min(...Object.values(figures(name, size).masked_noise_floor_db));
  console.log(`\nNoise floor of the truth, masked, at least ${show(Math.min(...cases.map(noise)), 1)} dB.\n`);
}
console.log("Bytes and Gaussians:\n");
head(["", ...cases]);
line(["MB", ...cases.map((name) => show(figures(name, sizes[0]).bytes / 1e6, 2))]);
line(["Gaussians", ...cases.map((name) => figures(name, sizes[0]).splats)]);
