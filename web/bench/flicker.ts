// Whether pictures stay calm while the head or the plane moves, against path-traced truth; run by bench/flicker.sh,
// which says how.
//
// Two sweeps: a camera that turns by 0.2° a step, as a head does, around the body cut by an oblique plane, and a plane
// that moves through it from its first to its third quarter. Of pictures in display sRGB over black, L is the mean of
// the channels. Said are, in 10⁻²:
//
// - how much a step changes, as XClipGS's public scripts have it: mean |L′ − L| over mean L;
// - the root mean square of what a step changes, √⟨(L′ − L)²⟩, and of what it changes otherwise than in the truth,
//   √⟨(E′ − E)²⟩ with E = L − L_truth: shimmer and pops. A truth is traced twice, with other seeds; the product of both
//   differences in place of a square has no share of the tracer's noise.

import { copyFileSync, existsSync, mkdirSync, renameSync } from "node:fs";
import { join } from "node:path";
import { parseArgs } from "node:util";
import type { Page } from "playwright-core";

import type { FaceSource } from "../src/model/faces";
import { readPng } from "../test/browser/picture";
import { clipgs } from "../test/browser/program";
import { Session } from "../test/browser/session";
import { kPage, table } from "./measure";

const { positionals, values } = parseArgs({
  allowPositionals: true,
  options: {
    size: { type: "string", default: "512" }, // px
    steps: { type: "string", default: "12" },
    spp: { type: "string", default: "32" }, // of each of the two truths
    folder: { type: "string" }, // where those are kept
    options: { type: "string", default: "" }, // of clipgs cinema, to read the volume
  },
});
const [file, volume] = positionals;
if (!file || !volume || !values.folder) {
  throw new Error("name a case and its volume, and a folder for what is traced: bench/flicker.sh says how");
}
const kSize = Number(values.size);
const kSteps = Number(values.steps);
const kAzimuth = 28; // degrees
const kElevation = 20;
const kZoom = 1.4;
const kNormal = [0.6, 0.5, -0.62] as const;

interface Moment {
  azimuth: number;
  plane: readonly [number, number, number, number];
}

/** Brightness, 0 … 1. */
type Luminance = Float32Array;

function luminanceOf(data: ArrayLike<number>): Luminance {
  return Float32Array.from(
    { length: data.length / 4 },
    (_, i) => ((data[4 * i]! + data[4 * i + 1]! + data[4 * i + 2]!) * data[4 * i + 3]!) / (3 * 65025),
  );
}

/** A truth, traced unless it is there. */
async function traced({ azimuth, plane }: Moment, name: string, seed: number): Promise<Luminance> {
  const path = join(values.folder!, `${name}-${seed}.png`);
  if (!existsSync(path)) {
    const part = path.replace(/\.png$/, ".part.png");
    const view = `--view=${azimuth},${kElevation},${kZoom}`;
    const picture = ["--size", `${kSize}x${kSize}`, "--spp", values.spp, "--seed", String(seed)];
    const read = values.options.split(" ").filter(Boolean);
    await clipgs("cinema", volume!, "-o", part, view, "--plane", plane.join(","), ...picture, ...read);
    renameSync(part, path);
  }
  return luminanceOf(readPng(path).data);
}

interface Way {
  name: string;
  section: FaceSource;
  moving: boolean;
}
const kWays: readonly Way[] = [
  { name: "at rest", section: "volume", moving: false },
  { name: "while something moves", section: "volume", moving: true },
  { name: "splats alone", section: "splats", moving: true },
];

async function shown(page: Page, { azimuth, plane }: Moment, way: Way): Promise<Luminance> {
  const data = await page.evaluate(
    async ([view, [x, y, z, offset], { section, moving }, size]) => {
      window.clipgs.setView(view);
      window.clipgs.setPlane({ normal: [x, y, z], offset });
      window.clipgs.setSection(section);
      return Array.from((await window.clipgs.renderToPixels(size, size, moving)).data);
    },
    [{ azimuth, elevation: kElevation, zoom: kZoom }, plane, way, kSize] as const,
  );
  return luminanceOf(data);
}

const mean = (values: Float32Array | number[]) =>
  (values as number[]).reduce((sum, v) => sum + v, 0) / values.length;
const minus = (a: Luminance, b: Luminance): Luminance => a.map((v, i) => v - b[i]!);
const product = (a: Luminance, b: Luminance): number => mean(a.map((v, i) => v * b[i]!));

/** Over the steps of a sweep, of pictures and two truths of each. */
function measure(pictures: readonly Luminance[], truths: readonly (readonly [Luminance, Luminance])[]) {
  const steps = pictures.slice(1).map((after, k) => {
    const before = pictures[k]!;
    const [changeA, changeB] = [0, 1].map((i) => minus(truths[k + 1]![i]!, truths[k]![i]!)) as [
      Luminance,
      Luminance,
    ];
    const change = minus(after, before);
    return {
      flicker: mean(change.map(Math.abs)) / mean(before),
      square: product(change, change),
      truth: product(changeA, changeB),
      other: product(minus(change, changeA), minus(change, changeB)),
    };
  });
  const root = (of: "square" | "truth" | "other") =>
    Math.sqrt(Math.max(0, mean(steps.map((step) => step[of]))));
  return {
    flicker: mean(steps.map(({ flicker }) => flicker)),
    own: root("square"),
    truth: root("truth"),
    other: root("other"),
  };
}

const session = new Session();
await session.start(async (cases) => copyFileSync(file, join(cases, "case.sog")));
try {
  mkdirSync(values.folder, { recursive: true });
  const page = await session.open("", [], kPage);
  await page.evaluate(() => window.clipgs.ready);
  const { min, max } = await page.evaluate(() => window.clipgs.bounds!);
  const ends = kNormal.map((n, k) => [n * min[k]!, n * max[k]!] as const);
  const low = ends.reduce((sum, both) => sum + Math.min(...both), 0);
  const high = ends.reduce((sum, both) => sum + Math.max(...both), 0);
  const at = (share: number) => [...kNormal, low + share * (high - low)] as const;
  const sweep = (moment: (share: number, step: number) => Moment) =>
    Array.from({ length: kSteps + 1 }, (_, step) => moment(step / kSteps, step));
  const sweeps = {
    "camera, 0.2° a step": sweep((_, step) => ({ azimuth: kAzimuth + 0.2 * step, plane: at(0.5) })),
    "plane, from its first to its third quarter": sweep((share) => ({
      azimuth: kAzimuth,
      plane: at(0.25 + 0.5 * share),
    })),
  };
  const rows: string[][] = [];
  for (const [name, moments] of Object.entries(sweeps)) {
    const truths: [Luminance, Luminance][] = [];
    for (const [k, moment] of moments.entries()) {
      process.stderr.write(`\r${name}: truth ${k + 1} of ${moments.length} `);
      const trace = (seed: number) => traced(moment, `${name.split(",")[0]!}-${k}`, seed);
      truths.push([await trace(1), await trace(2)]);
    }
    process.stderr.write("\n");
    for (const way of kWays) {
      const pictures: Luminance[] = [];
      for (const moment of moments) {
        pictures.push(await shown(page, moment, way));
      }
      const { flicker, own, truth, other } = measure(pictures, truths);
      rows.push([name, way.name, ...[flicker, own, truth, other].map((v) => (100 * v).toFixed(2))]);
    }
  }
  console.log(table(["sweep", "drawn", "flicker", "change", "change of the truth", "other change"], rows));
} finally {
  await session.stop();
}
