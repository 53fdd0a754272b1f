// What the viewer looks like, on a desk, with slices, on a telephone and in an emulated headset: PNG for docs/gallery.
//
//   npx vite-node bench/pictures.ts -- CASE.sog FOLDER

import { copyFileSync, mkdirSync } from "node:fs";
import { join } from "node:path";

import type { Page } from "playwright-core";
import { Vector3 } from "three";

import { Session } from "../test/browser/session";
import { Wearer } from "../test/browser/wearer";

const [file = "", folder = ""] = process.argv.slice(2);
if (!folder) {
  throw new Error("usage: npx vite-node bench/pictures.ts -- CASE.sog FOLDER");
}
mkdirSync(folder, { recursive: true });
/** As people have it at first. */
const kSimple = { content: `try { localStorage.setItem("clipgs.level", "simple"); } catch {}` };
const kDesk = { width: 1280, height: 760, scale: 1 };
const kPhone = { width: 390, height: 844, scale: 2 };
const kEyes = { width: 1600, height: 760, scale: 1 };

const session = new Session();
await session.start((cases) => copyFileSync(file, join(cases, "case.sog")), "--headset");

/** Its planes as shares of the case: across the body, and aslant. */
async function cut(page: Page, ...normals: [number, number, number][]): Promise<void> {
  await page.evaluate((all) => {
    const { min, max } = window.clipgs.bounds!;
    const middle = min.map((low, k) => 0.5 * (low + max[k]!));
    window.clipgs.setCuts(
      all.map((normal) => ({ normal, offset: normal.reduce((sum, n, k) => sum + n * middle[k]!, 0) })),
    );
  }, normals);
}

async function take(page: Page, name: string): Promise<void> {
  await page.waitForFunction(() => window.clipgs.stats.settled);
  await page.waitForTimeout(500); // what fades has
  await page.screenshot({ path: join(folder, `${name}.png`) });
}

async function open(viewport: typeof kDesk): Promise<Page> {
  const page = await session.open("#case=case", [], viewport, [kSimple]);
  await page.evaluate(() => window.clipgs.ready);
  return page;
}

const desk = await open(kDesk);
await desk.evaluate(() => window.clipgs.setView({ azimuth: 35, elevation: 28 }));
await cut(desk, [0.3, -0.75, -0.55]);
await take(desk, "desk");
await desk.evaluate(() => window.clipgs.setView({ azimuth: 20, elevation: 35 }));
await cut(desk, [0, 0, -1]);
await desk.evaluate(() => {
  const { min, max } = window.clipgs.bounds!;
  const at = (...shares: [number, number]) =>
    [0, 1, 2].map((k) => min[k]! + (shares[k] ?? 0.5) * (max[k]! - min[k]!)) as [number, number, number];
  window.clipgs.addMark({ kind: "length", points: [at(0.4, 0.45), at(0.6, 0.45)], name: "Width" });
});
await desk.locator("canvas.stage").focus();
await desk.keyboard.press("q");
await desk.locator(".slice-tools .segments button").last().click();
await take(desk, "slices");
await desk.close();

const phone = await open(kPhone);
await phone.evaluate(() => window.clipgs.setView({ azimuth: 35, elevation: 28 }));
await cut(phone, [0, 0, -1], [0, -1, 0]);
await take(phone, "phone");
await phone.close();

const worn = await session.openInHeadset("#case=case", [], kEyes);
await worn.evaluate(() => window.clipgs.ready);
await worn.evaluate(() => window.clipgs.setView({ azimuth: 35, elevation: 0 }));
await cut(worn, [0.3, -0.75, -0.55]);
const wearer = new Wearer(worn);
await wearer.wear();
await wearer.stand([0, 1.6, 0], -0.3); // looks down at it
await wearer.reach("right", new Vector3(0.12, 1.25, -0.45));
await wearer.reach("left", new Vector3(-0.3, 1.2, -0.35));
await wearer.settle();
await worn.screenshot({ path: join(folder, "headset.png") });
await worn.close();
await session.stop();
