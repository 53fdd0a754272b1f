// The tables of ablation.sh, from what it left of each row: ROW.figures, ROW.seconds, ROW.bytes and ROW.picture.
//
//   node bench/ablation.cjs FOLDER CASE...
const fs = require("node:fs");
const {known, show, mean, line, head} = require("./markdown.cjs");

const [folder, ...cases] = process.argv.slice(2);
const allRows = [
  ["lt", "LT only", 34.58],
  ["aam", "AAM only, everywhere", 35.95],
  ["aam-hard", "AAM, hard truncation", 36.26],
  ["aam-lt", "**AAM, LT**", 36.64, 0.974],
  ["everywhere", "AAM everywhere, LT"],
  ["position", "AAM that sees centre and plane alone, LT"],
];
const path = (name, row, end) => `${folder}/${name}/ablation/${row}.${end}`;
/** Those that are made. */
const rows = allRows.filter(([row]) => cases.every((name) => fs.existsSync(path(name, row, "figures"))));
const number = (file) => (fs.existsSync(file) ? Number(fs.readFileSync(file, "utf8")) : null);
const figures = (name, row) => JSON.parse(fs.readFileSync(path(name, row, "figures"), "utf8"));
const axis = (row) => cases.map((name) => figures(name, row).rows.find((r) => r.split === "test_axis"));
const minutes = (row) => cases.map((name) => {
  const seconds = number(path(name, row, "seconds"));
  return known(seconds) ? seconds / 60 : null;
});

head(["", "PSNR, dB", "masked PSNR, dB", "SSIM", "band SSIM", "leak, 10⁻²", "training, min", "a picture, s", "MB",
  "*ClipGS: PSNR, dB / SSIM*"]);
for (const [row, title, psnr, ssim] of rows) {
  const all = axis(row);
  const metric = (key, digits) => show(mean(all.map((r) => r[key])), digits);
  line([title, metric("psnr", 2), metric("psnr_masked", 2), metric("ssim", 4), metric("band_ssim", 4), metric("leak", 3),
    show(mean(minutes(row)), 1), show(mean(cases.map((name) => number(path(name, row, "picture")))), 2),
    show(mean(cases.map((name) => number(path(name, row, "bytes")))) / 1e6, 1), known(psnr) ? `*${show(psnr, 2)} / ${show(ssim, 3)}*` : "–"]);
}

console.log("\nCase by case, PSNR / masked PSNR in dB:\n");
head(["", ...cases]);
for (const [row, title] of rows) {
  line([title, ...axis(row).map((r) => `${show(r.psnr, 2)} / ${show(r.psnr_masked, 2)}`)]);
}
const floors = cases.map((name) => figures(name, "lt"));
line(["noise floor of the truth", ...floors.map((f) =>
  `${show(f.noise_floor_db.test_axis, 1)} / ${show(f.masked_noise_floor_db.test_axis, 1)}`)]);
