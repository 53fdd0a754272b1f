// The tables of paper_tables.sh, from what it left of each case: NAME.figures, NAME.seconds, NAME.bytes and bake.json.
//
//   node bench/paper_tables.cjs FOLDER CASE...
const fs = require("node:fs");
const {known, show, mean, line, head} = require("./markdown.cjs");

const [folder, ...cases] = process.argv.slice(2);
const read = (name, file) => JSON.parse(fs.readFileSync(`${folder}/${name}/${file}`, "utf8"));
const figures = Object.fromEntries(["refined", "case", "unpacked"].map((table) =>
  [table, Object.fromEntries(cases.map((name) => [name, read(name, `${table}.figures`)]))]));

// A kind of picture: a table of figures, and what its rows say of themselves.
const find = (kind, name, split) => figures[kind.table][name].rows.find((row) =>
  row.split === split && ["subject", "clip", "section", "against"].every((key) => row[key] === kind[key]));
const of = (kind, split, metric) => cases.map((name) => find(kind, name, split)?.[metric]);
const exists = (kind, split) => cases.some((name) => find(kind, name, split));

const metrics = [["PSNR, dB", "psnr", 2], ["masked PSNR, dB", "psnr_masked", 2], ["SSIM", "ssim", 4],
  ["band SSIM", "band_ssim", 4], ["leak, 10⁻²", "leak", 3]];
const clips = ["hard", "soft", "exact"];

// Means of `kinds`, then lines of the papers, then the main columns case by case for those of `kinds` that `main` picks.
function tables(kinds, split, columns, labels, papers, main) {
  const present = kinds.filter((kind) => exists(kind, split));
  const name = (kind) => labels.map((key) => kind[key]);
  head([...labels.map((key) => ({subject: "scene", section: "faces"})[key] ?? key), ...columns.map(([title]) => title)]);
  for (const kind of present) {
    line([...name(kind), ...columns.map(([, metric, digits]) => show(mean(of(kind, split, metric)), digits))]);
  }
  for (const paper of papers) {
    line([`*${paper.name}*`, paper.clip ?? "", ...labels.slice(2).map(() => ""),
      ...columns.map(([, metric, digits]) => (known(paper[metric]) ? `*${show(paper[metric], digits)}*` : "–"))]);
  }
  console.log(`\nCase by case, ${main.title}:\n`);
  head([...labels.map((key) => ({subject: "scene", section: "faces"})[key] ?? key), ...cases]);
  for (const kind of present.filter(main.picks)) {
    const [first, second] = main.metrics.map((metric) => of(kind, split, metric));
    line([...name(kind), ...cases.map((_, i) => `${show(first[i], main.digits[0])} / ${show(second[i], main.digits[1])}`)]);
  }
  return present;
}

// The truth's noise floor as a sentence.
function noise(split) {
  const floors = cases.map((name) => figures.refined[name]);
  const per = cases.map((name, i) =>
    `${name} ${show(floors[i].noise_floor_db[split], 1)} (${show(floors[i].masked_noise_floor_db[split], 1)})`);
  const [all, masked] = ["noise_floor_db", "masked_noise_floor_db"].map((key) => mean(floors.map((f) => f[key][split])));
  console.log(`\nNoise floor of the truth, dB (masked): mean ${show(all, 1)} (${show(masked, 1)}); ${per.join(", ")}. ` +
    "No PSNR above it can be trusted.\n");
}

console.log("### Against the neural model's pictures\n");
console.log("Axis planes, faces by splats: what one explicit scene loses of the model.\n");
tables(
  ["layered", "deep", "refined"].flatMap((subject) =>
    clips.map((clip) => ({table: "refined", subject, clip, section: "splats", against: "neural"}))),
  "test_axis", metrics.slice(0, 4), ["subject", "clip"],
  [{name: "ClipGS-VR", clip: "hard", psnr: 30.55, ssim: 0.9542}, {name: "ClipGS-VR", clip: "soft", psnr: 33.4, ssim: 0.9698}],
  {title: "PSNR in dB / SSIM", picks: () => true, metrics: ["psnr", "ssim"], digits: [2, 4]});
console.log();

const truth = ["splats", "volume"].flatMap((section) => [
  {table: "refined", subject: "neural", clip: "own", section, against: "truth"},
  ...[["refined", "layered"], ["refined", "deep"], [section === "splats" ? "refined" : "case", "refined"], ["case", "case"]].flatMap(
    ([table, subject]) => clips.map((clip) => ({table, subject, clip, section, against: "truth"}))),
]);
const main = {title: "PSNR / masked PSNR in dB, operators `own` and `exact`",
  picks: (kind) => ["own", "exact"].includes(kind.clip), metrics: ["psnr", "psnr_masked"], digits: [2, 2]};

console.log("### Against path-traced truth, axis planes\n");
tables(truth, "test_axis", metrics, ["subject", "clip", "section"], [
  {name: "ClipGS", psnr: 36.64, ssim: 0.974},
  {name: "ClipGS, by XClipGS", psnr: 32.34, ssim: 0.954, band_ssim: 0.809, leak: 16.42},
  {name: "XClipGS", psnr: 33.56, ssim: 0.96, band_ssim: 0.86, leak: 0.4},
], main);
noise("test_axis");
console.log("XClipGS defines its leak and its band in its own way; ours follow the idea.\n");

console.log("### Against path-traced truth, oblique planes\n");
console.log("The neural model cannot draw them. Of XClipGS, planes of arbitrary normals.\n");
tables(truth, "test_oblique", metrics, ["subject", "clip", "section"], [
  {name: "ClipGS, by XClipGS", band_ssim: 0.844, leak: 17.24}, {name: "XClipGS", band_ssim: 0.874, leak: 0.13}], main);
noise("test_oblique");

console.log("### Bytes\n");
console.log("Megabytes after each step; as raw floats until the scene is packed. ClipGS-VR: about 6,000 MB to about 40 MB.\n");
const baked = Object.fromEntries(cases.map((name) => [name, read(name, "bake.json")]));
const size = (name, file) => Number(fs.readFileSync(`${folder}/${name}/${file}.bytes`, "utf8"));
const stages = [
  ["states as PLYs", (name) => baked[name].bytes.raw],
  ["SH above order 0 once", (name) => baked[name].bytes.shared_sh],
  ["of each state its slab", (name) => baked[name].bytes.slabs],
  ["one scene with layers", (name) => baked[name].bytes.consolidated],
  ["`refined.sog`", (name) => size(name, "refined.sog")],
  ["`case.sog`, its section included", (name) => size(name, "case.sog")],
  ["beside them: the neural model, PLY and JSON", (name) => size(name, "neural")],
];
head(["", ...cases, "mean"]);
for (const [title, bytes] of stages) {
  const values = cases.map(bytes);
  line([title, ...[...values, mean(values)].map((value) => show(value / 1e6, 2))]);
}
console.log("\nWhat packing loses, operator `exact`, dB of PSNR / masked PSNR:\n");
head(["case", "faces", "planes", ...cases, "mean"]);
for (const [title, packed, unpacked, section] of [
  ["`refined.sog`", {table: "refined", subject: "refined"}, {subject: "refined"}, "splats"],
  ["`case.sog`", {table: "case", subject: "case"}, {subject: "section"}, "volume"]]) {
  for (const split of ["test_axis", "test_oblique"]) {
    const lost = ["psnr", "psnr_masked"].map((metric) => {
      const common = {clip: "exact", section, against: "truth"};
      const before = of({...common, table: "unpacked", ...unpacked}, split, metric);
      const after = of({...common, ...packed}, split, metric);
      const values = before.map((value, i) => (known(value) && known(after[i]) ? value - after[i] : null));
      return [...values, mean(values)];
    });
    line([title, section, split.replace("test_", ""), ...lost[0].map((_, i) => `${show(lost[0][i], 2)} / ${show(lost[1][i], 2)}`)]);
  }
}

console.log("\n### Minutes\n");
head(["step", ...cases, "mean"]);
for (const [title, ...names] of [["pictures", "dataset"], ["neural model", "neural"], ["baking", "bake"],
  ["refinement", "refined"], ["refinement with the section", "section"], ["packing both", "refined.sog", "case.sog"],
  ["evaluation", "refined.figures", "case.figures", "unpacked.figures"]]) {
  const minutes = cases.map((name) => {
    const files = names.map((step) => `${folder}/${name}/${step}.seconds`);
    return files.every(fs.existsSync) ? files.reduce((sum, file) => sum + Number(fs.readFileSync(file, "utf8")), 0) / 60 : null;
  });
  line([title, ...[...minutes, mean(minutes)].map((value) => show(value, 1))]);
}
