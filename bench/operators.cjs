// The tables of operators.sh, from what it left of each case: TRAINED-FACES.figures.
//
//   node bench/operators.cjs FOLDER SPLIT CASE...
const fs = require("node:fs");
const {show, mean, line, head} = require("./markdown.cjs");

const [folder, split, ...cases] = process.argv.slice(2);
const clips = ["hard", "soft", "exact"];

for (const faces of ["splats", "volume"]) {
  console.log(`Faces by ${faces === "splats" ? "splats alone" : "the volume"}, masked PSNR in dB, across the axis / oblique; means over ${cases.join(", ")}:\n`);
  head(["trained with", ...clips.map((clip) => `shown by \`${clip}\``)]);
  for (const trained of clips) {
    const cell = (shown) => ["axis", "oblique"].map((kind) => show(mean(cases.map((name) =>
      JSON.parse(fs.readFileSync(`${folder}/${name}/${trained}-${faces}.figures`, "utf8"))
        .rows.find((row) => row.split === `${split}_${kind}` && row.clip === shown)?.psnr_masked)), 2)).join(" / ");
    const bold = (shown) => (shown === trained ? `**${cell(shown)}**` : cell(shown));
    line([`\`${trained}\``, ...clips.map(bold)]);
  }
  console.log();
}
