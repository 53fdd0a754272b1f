// The table and the plot of curve.sh: masked PSNR of each version of each case, and when it was there.
//
//   node bench/curve.cjs FOLDER SPLIT SIZE SMALL BESIDE CASE...
const fs = require("node:fs");
const {kinds, show, mean, line, head} = require("./markdown.cjs");

const [folder, split, size, small, beside, ...cases] = process.argv.slice(2);
const kSeconds = [5, 10, 30, 60, 120, 300, 600];
const kLevels = [24, 28, 32, 36, 40, 44]; // dB
const kColors = ["#1b6ca8", "#c8553d", "#3a7d44", "#8e5ea2", "#b8860b", "#555555"];

/** Of a case, in the order in which they were there: seconds, and dB by kind of picture at a size. */
function versions(from, name, px) {
  const at = `${from}/${name}/versions`;
  const files = fs.existsSync(at) ? fs.readdirSync(at).filter((file) => file.endsWith(".sog")).sort() : [];
  return files.map((file) => {
    const stem = file.slice(0, -".sog".length);
    const {rows} = JSON.parse(fs.readFileSync(`${at}/${stem}-${split}-${px}.figures`, "utf8"));
    const of = (kind) => rows.find((row) => row.split === `${split}_${kind}`)?.psnr_masked;
    const byKind = kinds.map(([kind]) => of(kind));
    return {seconds: Number(stem), byKind, mean: mean(byKind)};
  });
}

const cell = (version) => version ? `${show(version.mean, 1)} (${version.byKind.map((v) => show(v, 1)).join(" / ")})` : "–";

for (const px of [size, small]) {
  console.log(`${px} × ${px} px, masked PSNR in dB, mean (axis / oblique / uncut / close up), of what is there after so many seconds:\n`);
  head(["s", ...cases]);
  const all = cases.map((name) => versions(folder, name, px));
  for (const seconds of kSeconds) {
    line([seconds, ...all.map((of) => cell(of.filter((version) => version.seconds <= seconds).at(-1)))]);
  }
  console.log();
}
console.log("Versions, s:\n");
head(["", ...cases]);
line(["", ...cases.map((name) => versions(folder, name, size).map(({seconds}) => show(seconds, 0)).join(", "))]);

/** Stairs of what there is to look at, over a logarithmic axis of seconds. */
function plot() {
  const [w, h, left, bottom, dB] = [760, 470, 50, 40, [24, 44]];
  const x = (seconds) => left + ((w - left - 120) * Math.log(seconds / 3)) / Math.log(800 / 3);
  const y = (value) => h - bottom - ((h - bottom - 20) * (value - dB[0])) / (dB[1] - dB[0]);
  const stairs = (from, name, style) => {
    const all = versions(from, name, size);
    const points = all.flatMap(({seconds, mean: value}, i) => [
      ...(i > 0 ? [`${x(seconds)},${y(all[i - 1].mean)}`] : []), `${x(seconds)},${y(value)}`]);
    return all.length === 0 ? "" : `<polyline fill="none" ${style} points="${[...points, `${x(800)},${y(all.at(-1).mean)}`].join(" ")}"/>`;
  };
  const text = (at, of, anchor) => `<text x="${at[0]}" y="${at[1]}" text-anchor="${anchor}">${of}</text>`;
  const grid = [
    ...kSeconds.map((s) => `<path d="M${x(s)} 20V${h - bottom}"/>`),
    ...kLevels.map((v) => `<path d="M${left} ${y(v)}H${x(800)}"/>`)];
  const labels = [
    ...kSeconds.map((s) => text([x(s), h - bottom + 18], s, "middle")),
    ...kLevels.map((v) => text([left - 6, y(v) + 4], v, "end")),
    text([x(60), h - 6], `seconds from the command; masked PSNR, dB, ${size} px, mean of all pictures`, "middle"),
    ...cases.map((name, i) => `<g fill="${kColors[i % kColors.length]}">${text([x(800) + 8, 40 + 20 * i], name, "start")}</g>`)];
  const curves = cases.flatMap((name, i) => {
    const stroke = `stroke="${kColors[i % kColors.length]}" stroke-width="2"`;
    return [stairs(folder, name, stroke), beside && stairs(beside, name, `${stroke} stroke-dasharray="5 4"`)];
  });
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${w} ${h}" font-family="sans-serif" font-size="12">
<rect width="${w}" height="${h}" fill="#fff"/>
<g stroke="#ddd">${grid.join("")}</g>
${curves.filter(Boolean).join("\n")}
<g fill="#333">${labels.join("\n")}</g>
</svg>
`;
}
fs.writeFileSync(`${folder}/curve.svg`, plot());
