// What the viewer costs a browser besides frames; run by bench/web.sh, which says how.

import { execFileSync } from "node:child_process";
import { copyFileSync, existsSync, readdirSync, readFileSync, statSync } from "node:fs";
import { basename, join, resolve } from "node:path";
import { parseArgs } from "node:util";
import { gzipSync } from "node:zlib";
import type { Page } from "playwright-core";
import { PerspectiveCamera, Vector4 } from "three";

import { makeSceneCamera, setSceneCamera, writeSortView } from "../src/render/scene_camera";
import type { PackedScene } from "../src/sog/sog";
import { kClipOperators, kViewFloats } from "../src/worker/protocol";
import { SplatOrder } from "../src/worker/splat_order";
import { kProgram } from "../test/browser/program";
import { Session } from "../test/browser/session";
import { kCountVolumes, volumesOf } from "../test/browser/volume_memory";
import { Wearer } from "../test/browser/wearer";
import { kPage, median, table } from "./measure";

const kRounds = 5;
const kSorted = 300_000;
const kLongTaskMs = 8;
const kHeadsetFrames = 30;
const [file = "", other = file] = parseArgs({ allowPositionals: true }).positionals;
const out = resolve(process.env["CLIPGS_WEB_OUT"] ?? "../build/release/web");

function gzippedKb(paths: readonly string[]): string {
  const bytes = paths.reduce((sum, path) => sum + gzipSync(readFileSync(path), { level: 9 }).length, 0);
  return `${(bytes / 1024).toFixed(0)} KB`;
}

function seconds(times: readonly number[]): string {
  return `${(median([...times]) / 1000).toFixed(2)} s`;
}

function filesIn(folder: string): string[] {
  return readdirSync(folder, { withFileTypes: true, recursive: true })
    .filter((entry) => entry.isFile())
    .map((entry) => join(entry.parentPath, entry.name));
}

/** Not one of those that are compressed beside them when the viewer is built. */
function isServedPlain(path: string): boolean {
  return !/\.(br|gz)$/.test(path);
}

/** What is sent of the viewer's files where the browser takes Brotli: those that are given are kept apart. */
function sentKb(without: RegExp): string {
  const files = filesIn(join(out, "dist")).filter((path) => isServedPlain(path) && !without.test(path));
  const sizes = files.map((path) => statSync(existsSync(`${path}.br`) ? `${path}.br` : path).size);
  return `${(sizes.reduce((sum, size) => sum + size, 0) / 1000).toFixed(0)} KB`;
}

/** The study's code, models of hands and controllers, the languages that are fetched by whom they are for, and what decodes videos, which is fetched beside the first. */
const kApart = /\/begin-[^/]*$|\.glb$|\/(study_)?de-[^/]*\.js$|-av1-wasm-[^/]*\.wasm$/;

function bundles(): string[][] {
  const peers = "bench/peers/node_modules";
  const three = ["core", "module"].map((part) => `${peers}/three/build/three.${part}.min.js`);
  return [
    ["page and headset, Brotli", sentKb(kApart), "350 KB"],
    [
      "all but models, gzipped",
      gzippedKb(filesIn(join(out, "dist")).filter((path) => isServedPlain(path) && !path.endsWith(".glb"))),
      "",
    ],
    [
      "Spark 2.2.0 and three.js",
      gzippedKb([`${peers}/@sparkjsdev/spark/dist/spark.module.min.js`, ...three]),
      "",
    ],
    ["PlayCanvas 2.23.3", gzippedKb([`${peers}/playcanvas/build/playcanvas.min.mjs`]), ""],
    [
      "GaussianSplats3D 0.4.7 and three.js",
      gzippedKb([`${peers}/@mkkellogg/gaussian-splats-3d/build/gaussian-splats-3d.module.js`, ...three]),
      "",
    ],
  ];
}

/** Gaussians in a cube of 2 units, all of which are seen from where the camera is. */
function makeScene(count: number): PackedScene {
  let state = 1;
  const random = () => (state = (Math.imul(state, 1664525) + 1013904223) >>> 0);
  const packed = Uint32Array.from({ length: 4 * count }, random);
  for (let i = 0; i < count; ++i) {
    packed[4 * i + 2] = (packed[4 * i + 2]! & 0x00ffffff) | ((random() >>> 30) << 24);
    packed[4 * i + 3]! |= 0x10000000; // opacity
  }
  return {
    count,
    packed,
    meanMin: [-0.69, -0.69, -0.69],
    meanMax: [0.69, 0.69, 0.69],
    scaleCodebook: Float32Array.from({ length: 256 }, (_, i) => 0.001 + 0.0001 * i),
    sh0: new Uint8Array(4 * count),
    sh0Codebook: new Float32Array(256),
    shN: null,
    faces: null,
    layers: null,
  };
}

/** Culling and sorting, ms, and how many are drawn: uncut, and with a plane through the middle. */
async function sorting(): Promise<string[][]> {
  const wasm = await WebAssembly.compile(readFileSync(join(out, "splat_order.wasm")));
  const order = new SplatOrder(wasm);
  order.load(makeScene(kSorted));
  const camera = new PerspectiveCamera(40, 1, 0.01, 100);
  camera.position.set(0, 0, 6);
  camera.updateMatrixWorld();
  const seen = makeSceneCamera();
  setSceneCamera(seen, camera, camera.matrixWorld.clone().identity(), 1024, 1024, 1000);
  const result = new Uint32Array(kSorted);
  return [0, 1].map((planes) => {
    const view = new Float32Array(kViewFloats);
    writeSortView(view, seen, planes ? [new Vector4(0.6, 0, 0.8, 0)] : []);
    let drawn = 0;
    const times = Array.from({ length: 41 }, () => {
      const start = performance.now();
      drawn = order.sort(view, planes ? kClipOperators.exact : kClipOperators.none, result);
      return performance.now() - start;
    });
    const what = `culling and sorting ${kSorted / 1000} k splats${planes ? ", half of them cut away" : ""}`;
    return [`${what} (${drawn / 1000} k drawn)`, `${median(times).toFixed(1)} ms`, "6 ms"];
  });
}

/** When the newest case was first seen, ms from the beginning of navigation, once it is there as a whole. */
function pictured(): number {
  return performance.getEntriesByName("clipgs: picture").at(-1)!.startTime;
}

/** From the beginning of navigation, with nothing in the browser's cache: until it is seen, and is whole. */
async function firstPicture(session: Session): Promise<string[]> {
  const seen: number[] = [];
  const whole: number[] = [];
  for (let round = 0; round < kRounds; ++round) {
    const page = await session.open("#case=first", [], kPage);
    whole.push(await page.evaluate(() => window.clipgs.ready.then(() => performance.now())));
    seen.push(await page.evaluate(pictured));
    await page.waitForFunction(() => window.clipgs.stats.settled); // the GPU has nothing left to do
    await page.close();
  }
  const megabytes = (readFileSync(file).length / 1e6).toFixed(1);
  return [
    `first picture of a case of ${megabytes} MB (with all that cuts need)`,
    `${seconds(seen)} (${seconds(whole)})`,
    "1.5 s",
  ];
}

/** To a case that was open before, until it is seen. */
async function switching(session: Session): Promise<string[]> {
  const page = await session.open("#case=first", [], kPage);
  const open = (name: string) =>
    page.evaluate(async (name) => {
      await window.clipgs.ready;
      const start = performance.now();
      await window.clipgs.open(name);
      return { start, end: performance.now() };
    }, name);
  await open("second");
  const seen: number[] = [];
  const whole: number[] = [];
  for (let round = 0; round < kRounds; ++round) {
    const { start, end } = await open(round % 2 ? "second" : "first");
    seen.push((await page.evaluate(pictured)) - start);
    whole.push(end - start);
  }
  await page.close();
  return ["switching the case (with all that cuts need)", `${seconds(seen)} (${seconds(whole)})`, "1 s"];
}

interface TraceEvent {
  name: string;
  cat: string;
  pid: number;
  tid: number;
  dur?: number; // μs
  tdur?: number;
  args: { name?: string };
}

/** What `act` makes a page's main thread do, task by task: ms of the thread's own time. */
async function mainThreadTasks(page: Page, act: () => Promise<void>): Promise<number[]> {
  const client = await page.context().newCDPSession(page);
  const events: TraceEvent[] = [];
  client.on("Tracing.dataCollected", ({ value }) => events.push(...(value as unknown as TraceEvent[])));
  const complete = new Promise((done) => client.once("Tracing.tracingComplete", done));
  await client.send("Tracing.start", {
    transferMode: "ReportEvents",
    traceConfig: { includedCategories: ["toplevel", "blink.user_timing", "__metadata"] },
  });
  await act();
  await client.send("Tracing.end");
  await complete;
  const marked = events.find(({ name }) => name === "plane moved");
  return events
    .filter(
      ({ name, pid, tid }) =>
        name === "ThreadControllerImpl::RunTask" && pid === marked?.pid && tid === marked.tid,
    )
    .map(({ tdur = 0 }) => tdur / 1000);
}

async function planeTasks(session: Session): Promise<string[]> {
  const page = await session.open("#case=first", [], kPage);
  await page.evaluate(() => window.clipgs.ready);
  const move = (frames: number) =>
    page.evaluate(async (frames) => {
      const { clipgs } = window;
      const { min, max } = clipgs.bounds!;
      for (let i = 0; i < frames; ++i) {
        clipgs.setPlane({
          normal: [0.6, 0, 0.8],
          offset: min[2] + ((i + 1) / (frames + 1)) * (max[2] - min[2]),
        });
        performance.mark("plane moved");
        await new Promise(requestAnimationFrame);
      }
    }, frames);
  await move(10); // compiles
  const tasks = await mainThreadTasks(page, () => move(60));
  await page.close();
  const long = tasks.filter((ms) => ms > kLongTaskMs).length;
  return [
    `longest task of the main thread while the plane moves (${long} of ${tasks.length} over ${kLongTaskMs} ms)`,
    `${Math.max(...tasks).toFixed(1)} ms`,
    `${kLongTaskMs} ms`,
  ];
}

/** Counts, in the page, the frames between a cut whose light is asked for and that light, whole, with the GPU. */
const kCountLight = {
  content: `{
    window.lightFrames = [];
    window.prepareMs = 0;
    let frame = 1, givenAt = 0;
    const tick = () => (++frame, requestAnimationFrame(tick));
    tick();
    const give = WebGL2RenderingContext.prototype.texSubImage3D;
    WebGL2RenderingContext.prototype.texSubImage3D = function (...all) {
      givenAt = frame;
      return give.apply(this, all);
    };
    const post = Worker.prototype.postMessage;
    Worker.prototype.postMessage = function (message, ...rest) {
      if (message.kind === "light") {
        if (this.askedAt) window.lightFrames.push(givenAt - this.askedAt);
        this.askedAt = frame;
      }
      if (message.kind === "decode") {
        let decoded;
        this.addEventListener("message", ({ data }) => {
          if (data.kind === "section") decoded = performance.now();
          if (data.kind === "openings") window.prepareMs = performance.now() - decoded;
        });
      }
      return post.call(this, message, ...rest);
    };
  }`,
};

/** How far the light is behind a plane that moves, and how long it takes to come when a case is opened. */
async function light(session: Session): Promise<string[][]> {
  const page = await session.open("#case=first", [], kPage, [kCountLight]);
  await page.evaluate(() => window.clipgs.ready);
  await page.waitForFunction(() => window.clipgs.stats.settled);
  const { prepareMs, frames } = await page.evaluate(async () => {
    const { clipgs } = window;
    const watched = window as unknown as { lightFrames: number[]; prepareMs: number };
    const { min, max } = clipgs.bounds!;
    watched.lightFrames.length = 0;
    for (let i = 0; i < 60; ++i) {
      clipgs.setPlane({ normal: [0.6, 0, 0.8], offset: min[2] + ((i + 1) / 61) * (max[2] - min[2]) });
      await new Promise(requestAnimationFrame);
    }
    return { prepareMs: watched.prepareMs, frames: [...watched.lightFrames] };
  });
  await page.close();
  const most = frames.length > 0 ? Math.max(...frames) : 0;
  return [
    [
      `light of a moving plane: ${frames.length} solutions in 60 frames, the latest of them`,
      `${most} frames late`,
      "2",
    ],
    ["walls and horizons of the case, in the worker", `${(prepareMs / 1000).toFixed(1)} s`, ""],
  ];
}

interface AllocationNode {
  selfSize: number;
  children: AllocationNode[];
}

function allocated({ selfSize, children }: AllocationNode): number {
  return children.reduce((sum, child) => sum + allocated(child), selfSize);
}

/** What frames in a headset leave to collect while its wearer moves: of the viewer, its libraries and the emulator. */
async function garbage(session: Session): Promise<string[]> {
  const page = await session.openInHeadset("#case=first");
  await page.evaluate(() => window.clipgs.ready);
  const wearer = new Wearer(page);
  await wearer.wear();
  await wearer.frames(kHeadsetFrames);
  const client = await page.context().newCDPSession(page);
  const collected = { includeObjectsCollectedByMajorGC: true, includeObjectsCollectedByMinorGC: true };
  await client.send("HeapProfiler.startSampling", { samplingInterval: 256, ...collected });
  await page.evaluate(async (frames) => {
    for (let i = 0; i < frames; ++i) {
      window.headset.position.set(0.002 * i, 1.6, 0);
      await new Promise(requestAnimationFrame);
    }
  }, kHeadsetFrames);
  const { profile } = await client.send("HeapProfiler.stopSampling");
  await page.close();
  const kilobytes = allocated(profile.head) / kHeadsetFrames / 1000;
  return ["garbage a frame in a headset", `${kilobytes.toFixed(0)} KB`, ""];
}

/** What the section takes: of the page and its workers, and on the GPU. */
async function sectionMemory(session: Session): Promise<string[][]> {
  const scene = join(session.folder, "bare.ply");
  execFileSync(kProgram, ["--quiet", "unpack", file, "-o", scene]);
  execFileSync(kProgram, ["--quiet", "pack", scene, "--no-section", "-o", join(session.cases, "bare.sog")]);
  const small = { width: 64, height: 64, scale: 1 };
  const measured = [];
  for (const name of ["first", "bare"]) {
    const page = await session.open(`#case=${name}&size=64x64`, [], small, [kCountVolumes]);
    await page.evaluate(() => window.clipgs.ready);
    const { sectionBytes } = await page.evaluate(() => window.clipgs.stats);
    const { bytes } = await page.evaluate<{ bytes: number }>("performance.measureUserAgentSpecificMemory()");
    const volumes = (await volumesOf(page)).bytes.reduce((sum, n) => sum + n, 0);
    measured.push({ sectionBytes, bytes, volumes });
    await page.close();
  }
  const [whole, bare] = measured as [(typeof measured)[0], (typeof measured)[0]];
  const megabytes = (bytes: number) => `${(bytes / 1e6).toFixed(1)} MB`;
  const voxels = megabytes(whole.sectionBytes);
  return [
    [`memory of a section of ${voxels}`, megabytes(whole.bytes - bare.bytes), "60 MB"],
    ["... on the GPU", megabytes(whole.volumes), "60 MB"],
  ];
}

function overdraw(session: Session): string[] {
  const scene = join(session.folder, "scene.ply");
  execFileSync(kProgram, ["--quiet", "unpack", file, "-o", scene]);
  const info = execFileSync(kProgram, ["info", scene, "--json"], { encoding: "utf8" });
  const { fragments_a_pixel: fragments } = JSON.parse(info) as { fragments_a_pixel: number };
  return ["fragments a pixel, uncut", fragments.toFixed(1), ""];
}

const rows = [...bundles(), ...(await sorting())];
const session = new Session();
await session.start((cases) => {
  copyFileSync(file, join(cases, "first.sog"));
  copyFileSync(other, join(cases, "second.sog"));
});
try {
  rows.push(await firstPicture(session), await switching(session), await planeTasks(session));
  rows.push(...(await light(session)));
  rows.push(await garbage(session), ...(await sectionMemory(session)), overdraw(session));
} finally {
  process.exitCode = (await session.stop()) ?? 0;
}
console.log(table([basename(file), "measured", "limit"], rows));
