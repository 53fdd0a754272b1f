// Writes the licences of the packages that the viewer is made of.
//
//   node licenses_of_others.mjs WEB OUTPUT

import { execFileSync } from "node:child_process";
import { existsSync, readFileSync, writeFileSync } from "node:fs";

const [web, output] = process.argv.slice(2);

const list = execFileSync("npm", ["ls", "--omit=dev", "--all", "--parseable"], { cwd: web, encoding: "utf8" });
const [, ...folders] = list.trim().split("\n");
const held = {
  // beside their own
  "@cwasm/webp": `${web}/package/LICENSE-libwebp`,
  ogv: `${web}/node_modules/ogv/dist/COPYING-dav1d.txt`,
};

/** What a package says of itself, whole. */
function licenceOf(folder) {
  const { name, version, license = "" } = JSON.parse(readFileSync(`${folder}/package.json`, "utf8"));
  const file = ["LICENSE", "LICENSE.md", "LICENSE.txt", "license", "COPYING"].find((one) => existsSync(`${folder}/${one}`));
  const text = file ? readFileSync(`${folder}/${file}`, "utf8").trim() : license;
  const more = held[name] ? `\n\n${readFileSync(held[name], "utf8").trim()}` : "";
  return `${name} ${version}\n\n${text}${more}\n`;
}

writeFileSync(output, folders.map(licenceOf).join(`\n${"-".repeat(80)}\n\n`));
