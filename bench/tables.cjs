// Puts tables in their places in a document: what lies between <!-- NAME --> and <!-- end of NAME --> becomes what
// FOLDER/NAME.md says. A table that is not made yet leaves its place as it is.
//
//   node bench/tables.cjs DOCUMENT FOLDER
const fs = require("node:fs");

const [file, folder] = process.argv.slice(2);
let text = fs.readFileSync(file, "utf8");
for (const table of fs.readdirSync(folder).filter((name) => name.endsWith(".md")).sort()) {
  const name = table.slice(0, -".md".length);
  const place = new RegExp(`(<!-- ${name} -->\n)[^]*?(\n<!-- end of ${name} -->)`);
  if (!place.test(text)) {
    console.error(`tables: ${file} has no place <!-- ${name} --> for ${folder}/${table}`);
    process.exitCode = 1;
    continue;
  }
  const made = fs.readFileSync(`${folder}/${table}`, "utf8").trim();
  text = text.replace(place, (_, begin, end) => `${begin}\n${made}\n${end}`);
}
fs.writeFileSync(file, text);
