// Two minutes of random input: what a page holds before, and after each quarter. `npx vite-node bench/monkey.ts [CASES [SECONDS]]`,
// of a folder with a case phantom.sog, or of one that is made.

import { copyFileSync, readdirSync } from "node:fs";
import { join } from "node:path";

import { holdings, kCountGpu, useAtRandom } from "../test/browser/monkey";
import { clipgs } from "../test/browser/program";
import { Session } from "../test/browser/session";

const [folder, seconds = "120"] = process.argv.slice(2);
const kQuarters = 4;

const session = new Session();
const errors: string[] = [];
await session.start(async (cases) => {
  if (folder) {
    readdirSync(folder)
      .filter((name) => name.endsWith(".sog"))
      .forEach((name) => copyFileSync(join(folder, name), join(cases, name)));
    return;
  }
  const volume = join(session.folder, "phantom.nii.gz");
  await clipgs("phantom", volume, "--size", "96");
  for (const [name, preset] of [
    ["phantom", "skin-and-bone"],
    ["bones", "skeleton"],
  ] as const) {
    await clipgs(
      "build",
      volume,
      "-o",
      join(cases, `${name}.sog`),
      "--preset",
      preset,
      "--quality",
      "instant",
    );
  }
});
const page = await session.open("#case=phantom", errors, { width: 760, height: 560 }, [kCountGpu]);
page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
page.on("filechooser", () => {});
await page.evaluate(() => window.clipgs.ready);
await useAtRandom(page, 1, 5000);
let actions = 0;
for (let i = 0; i <= kQuarters; ++i) {
  const { heap, buffers, nodes, listeners, gpu } = await holdings(page, "phantom");
  const objects = Object.values(gpu).reduce((sum, n) => sum + n, 0);
  console.log(
    `${String(actions).padStart(5)} actions: ${(heap / 1e6).toFixed(1)} MB heap, ${(buffers / 1e6).toFixed(1)} MB buffers, ` +
      `${nodes} nodes, ${listeners} listeners, ${objects} GPU objects ${JSON.stringify(gpu)}`,
  );
  if (i < kQuarters) {
    actions += await useAtRandom(page, 100 + i, (1000 * Number(seconds)) / kQuarters);
  }
}
console.log(errors.length === 0 ? "no errors" : errors.join("\n"));
await session.stop();
