// What the tables of the benchmarks have in common: figures, their means, lines of Markdown.
// Of pictures at a headset's size: the end of a split's name, and a title.
const kinds = [["axis", "cut across the axis"], ["oblique", "oblique"], ["uncut", "uncut"], ["close", "close up"]];
const known = (value) => value !== null && value !== undefined;
const show = (value, digits) => (known(value) ? value.toFixed(digits) : "–");
const mean = (values) => {
  const defined = values.filter(known);
  return defined.length > 0 ? defined.reduce((a, b) => a + b, 0) / defined.length : null;
};
const line = (cells) => console.log(`| ${cells.join(" | ")} |`);
const head = (cells) => {
  line(cells);
  console.log(`|${"---|".repeat(cells.length)}`);
};

module.exports = { kinds, known, show, mean, line, head };
