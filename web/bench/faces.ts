// What drawing cut faces from a section volume costs, against splats alone:
//
//   npm run bench -- CASE.sog [LINK]
//
// LINK is what follows # in the viewer's address; without it the view is the one that the viewer starts with. Frames
// of 1024 × 1024 px are drawn and read back, with and without the section in turns; sorting is not counted. While
// something moves, a pixel of a face gets one ray; at rest 8.

import { copyFileSync } from "node:fs";
import { join } from "node:path";
import { parseArgs } from "node:util";

import type { FaceSource } from "../src/model/faces";
import { Session } from "../test/browser/session";
import { kPage, median } from "./measure";

const kSize = 1024;
const kRounds = 9;

const { positionals } = parseArgs({ allowPositionals: true });
const [file, link = ""] = positionals;
if (!file) {
  throw new Error("name a case that has a section: npm run bench -- CASE.sog [LINK]");
}
const session = new Session();
await session.start(async (cases) => copyFileSync(file, join(cases, "case.sog")));
try {
  const page = await session.open(link ? `#${link}` : "", [], kPage);
  await page.evaluate(() => window.clipgs.ready);
  const stats = await page.evaluate(() => ({ ...window.clipgs.stats }));
  if (stats.sectionBytes === 0) {
    throw new Error(`${file} has no section`);
  }
  /** Share of the picture that is another with the section; the first frames also compile and upload. */
  const share = await page.evaluate(async (size) => {
    const pictures = [];
    for (const source of ["volume", "splats"] as const) {
      window.clipgs.setSection(source);
      pictures.push(await window.clipgs.renderToPixels(size, size));
    }
    const [a, b] = pictures.map(({ data }) => new Uint32Array(data.buffer)) as [Uint32Array, Uint32Array];
    return a.reduce((count, pixel, i) => count + (pixel === b[i] ? 0 : 1), 0) / a.length;
  }, kSize);
  /** What one frame takes without sorting, ms. */
  const time = (source: FaceSource, isMoving: boolean) =>
    page.evaluate(
      async ([section, size, moving]) => {
        window.clipgs.setSection(section);
        await window.clipgs.renderToPixels(size, size, moving); // nothing drawn before is left to wait for
        const start = performance.now();
        await window.clipgs.renderToPixels(size, size, moving);
        return performance.now() - start - window.clipgs.stats.sortMs;
      },
      [source, kSize, isMoving] as const,
    );
  const ways = [
    { name: "splats alone", source: "splats", moving: true, times: [] as number[] },
    { name: "with section", source: "volume", moving: true, times: [] as number[] },
    { name: "… at rest   ", source: "volume", moving: false, times: [] as number[] },
  ] as const;
  for (let round = 0; round < kRounds; ++round) {
    for (const { source, moving, times } of ways) {
      times.push(await time(source, moving));
    }
  }
  const alone = median(ways[0].times);
  console.log(
    `section      ${(stats.sectionBytes / 1e6).toFixed(1)} MB, decoded in ${Math.round(stats.sectionMs)} ms`,
  );
  console.log(`face         ${(100 * share).toFixed(0)} % of the picture`);
  for (const { name, times } of ways) {
    const ms = median(times);
    console.log(`${name} ${ms.toFixed(1)} ms a frame, ${(ms / alone).toFixed(2)} times as long as splats`);
  }
} finally {
  await session.stop();
}
