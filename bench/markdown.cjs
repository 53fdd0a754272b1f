// What the tables of the benchmarks have in common: figures, their means, lines of Markdown.
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

module.exports = { known, show, mean, line, head };
