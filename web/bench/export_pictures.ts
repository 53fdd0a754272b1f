// What other viewers show of exported cases, beside the case itself: pictures, and how alike they are.
//
//   npx vite-node bench/export_pictures.ts -- CASE.sog FOLDER
//
// The case is exported whole and cut, by `clipgs export`; each viewer opens a format that it reads and is looked at from
// the same places. FOLDER gets a PNG for each, and a table of dB over black is printed. Needs what bench/web.sh needs.

import { copyFileSync, mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";

import { Matrix4, Vector3 } from "three";

import type { Triple } from "../src/model/geometry";
import { clipgs } from "../test/browser/program";
import { decodePng, psnr, readPng } from "../test/browser/picture";
import { Session } from "../test/browser/session";
import { readCaseInfo } from "./case_file";
import { table } from "./measure";
import {
  kPeers,
  openPeer,
  type Peer,
  type PeerName,
  sceneCamera,
  serveFiles,
  waitUntilShown,
} from "./peer_pages";

const [file = "", folder = ""] = process.argv.slice(2);
if (!folder) {
  throw new Error("usage: npx vite-node bench/export_pictures.ts -- CASE.sog FOLDER");
}
mkdirSync(folder, { recursive: true });

const kSize = 1024; // px
const kElevation = 20; // degrees
const kAzimuth = 28;
/** What is kept lies where the normal points, from the middle of the case. */
const kCuts: Record<string, Triple | null> = {
  whole: null,
  across: [0, 0, -1],
  oblique: [0.3, -0.75, -0.55],
};
/** Formats that they read; Spark knows SPZ up to 3. */
const kShown: { peer: PeerName; format: string; options: string[] }[] = [
  { peer: "spark", format: "ply", options: [] },
  { peer: "spark", format: "spz", options: ["--spz-version", "3"] },
  { peer: "playcanvas", format: "ply", options: [] },
  { peer: "playcanvas", format: "sog", options: [] },
];
/** SPZ has y up, where a PLY of 3DGS has it down. */
const kYUp = new Matrix4().makeRotationX(Math.PI);

const info = await readCaseInfo(file);
const session = new Session();
await session.start((cases) => copyFileSync(file, join(cases, "case.sog")));
const server = await serveFiles();

/** The plane through the case's middle, as the program takes it. */
function planeOption(normal: Triple | null): string[] {
  if (!normal) {
    return [];
  }
  const unit = new Vector3(...normal).normalize();
  return ["--plane", [...unit.toArray(), unit.dot(info.sphere.center)].join(",")];
}

async function shot(name: PeerName, scene: string, camera: Matrix4): Promise<Buffer> {
  const page = await openPeer(session, server, name, scene, kSize);
  const draw = () =>
    page.evaluate(async (matrix) => {
      const viewer = await (window as unknown as { peer: Promise<Peer> }).peer;
      for (let frame = 0; frame < 10; ++frame) {
        viewer.setCamera(matrix);
        viewer.draw();
        await new Promise(requestAnimationFrame);
      }
    }, camera.toArray());
  await waitUntilShown(page, draw);
  await page.waitForTimeout(1000); // those that sort beside the page have
  await draw();
  const picture = await page.screenshot();
  await page.close();
  return picture;
}

const rows: string[][] = [];
try {
  for (const [cut, normal] of Object.entries(kCuts)) {
    const truth = join(folder, `${cut}-clipgs.png`);
    const view = ["--view", `${kAzimuth},${kElevation}`, "--size", `${kSize}x${kSize}`];
    await clipgs("render", file, "-o", truth, ...view, "--background", "0,0,0", ...planeOption(normal));
    for (const { peer, format, options } of kShown) {
      const scene = join(folder, `${cut}.${format}`);
      await clipgs("export", file, "-o", scene, ...options, ...planeOption(normal));
      const camera = sceneCamera(info, kAzimuth, kElevation, kSize);
      const picture = await shot(peer, scene, format === "spz" ? camera.premultiply(kYUp) : camera);
      writeFileSync(join(folder, `${cut}-${peer}-${format}.png`), picture);
      const { color } = psnr(decodePng(picture), readPng(truth));
      rows.push([cut, kPeers[peer], format, color.toFixed(1)]);
    }
  }
} finally {
  server.close();
  await session.stop();
}
console.log(table(["cut", "viewer", "format", "dB to clipgs's own picture"], rows));
