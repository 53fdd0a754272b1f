import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type { TestProject } from "vitest/node";

import { clipgs, missing } from "./program";

declare module "vitest" {
  interface ProvidedContext {
    /** A folder with the phantom's scene.ply, and phantom.sog, instant.sog, solid.sog, layered.sog, filmic.sog and photo.sog in `cases`. */
    made: string;
  }
}

/** Nine times fewer voxels than by default, further apart along two axes: every page and every `clipgs render` loads them. */
const kSection = ["--section-size", "128"];

/** Makes the cases that all these tests show, once. */
export default async function makeCases({ provide }: TestProject): Promise<(() => void) | undefined> {
  if (missing) {
    return undefined;
  }
  const made = mkdtempSync(join(tmpdir(), "clipgs-cases-"));
  const cases = join(made, "cases");
  mkdirSync(cases);
  await makePhantomCase(made, join(cases, "phantom.sog"));
  await makeInstantCase(made, join(cases, "instant.sog"));
  await makeSolidCase(made, join(cases, "solid.sog"));
  await makeLayeredCase(made, join(cases, "layered.sog"));
  await makeFilmicCase(made, join(made, "filmic"), join(cases, "filmic.sog"));
  await makePhotoCase(join(made, "photo"), join(cases, "photo.sog"));
  provide("made", made);
  return () => rmSync(made, { recursive: true });
}

/** A case of a volume, in the folder `work`: hardly trained, but with everything a case has. */
async function makeCase(
  volume: string,
  preset: string,
  title: string,
  work: string,
  out: string,
  quality: string, // of its section: below 100 it is a video
  ...look: string[]
): Promise<void> {
  const dataset = join(work, "dataset");
  const scene = join(work, "scene.ply");
  const pictures =
    "--size 96 --train-frames 24 --train-spp 4 --test-frames 1 --test-noise-db 15 --test-spp 8 --points 20000";
  await clipgs(
    "dataset",
    volume,
    "-o",
    dataset,
    "--preset",
    preset,
    ...look,
    ...pictures.split(" "),
    ...kSection,
  );
  await clipgs("train", dataset, "-o", scene, ..."--steps 100 --budget 8000 --sh-degree 3".split(" "));
  await clipgs("pack", scene, "-o", out, "--title", title, "--section-quality", quality);
}

async function makePhantomCase(work: string, out: string): Promise<void> {
  const volume = join(work, "phantom.nii.gz");
  await clipgs("phantom", volume, "--size", "96");
  await makeCase(volume, "skin-and-bone", "Torso phantom", work, out, "97");
}

/** A case of the same volume in which nothing is learnt. */
async function makeInstantCase(made: string, out: string): Promise<void> {
  const look = ["--preset", "skin-and-bone", "--title", "Instant phantom"];
  await clipgs(
    "build",
    join(made, "phantom.nii.gz"),
    "-o",
    out,
    "--quality",
    "instant",
    ...look,
    ...kSection,
  );
}

/** A case of the same volume with a tone curve, lit so that much is brighter than white, and a boundary's look. */
async function makeFilmicCase(made: string, work: string, out: string): Promise<void> {
  const look = "--tone filmic --exposure 2".split(" ");
  mkdirSync(work);
  await makeCase(join(made, "phantom.nii.gz"), "anatomy", "Filmic phantom", work, out, "100", ...look);
}

/** A case of the same pictures without a section: its splats are solid and have face colours. */
async function makeSolidCase(work: string, out: string): Promise<void> {
  const scene = join(work, "solid.ply");
  const options = "--no-section --steps 200 --budget 8000 --sh-degree 1".split(" ");
  await clipgs("train", join(work, "dataset"), "-o", scene, ...options);
  await clipgs("pack", scene, "-o", out, "--title", "Solid phantom");
}

/** A case of the same pictures with layers: the states of a neural model. */
async function makeLayeredCase(work: string, out: string): Promise<void> {
  const [model, scene] = [join(work, "neural.ply"), join(work, "layered.ply")];
  const options = "--model clipgs --no-section --steps 150 --budget 8000 --sh-degree 1".split(" ");
  await clipgs("train", join(work, "dataset"), "-o", model, ...options);
  await clipgs("bake", model, "-o", scene);
  await clipgs("pack", scene, "-o", out, "--title", "Layered phantom");
}

/** A case of colour photographs: a ball with stripes of three colours, and a hole in it, on black. */
async function makePhotoCase(work: string, out: string): Promise<void> {
  const n = 48;
  const colors = [
    [200, 120, 90],
    [90, 160, 110],
    [230, 220, 200],
  ] as const;
  const rgb = Buffer.alloc(3 * n ** 3);
  for (let i = 0; i < n ** 3; ++i) {
    const [x, y, z] = [i % n, Math.floor(i / n) % n, Math.floor(i / n ** 2)].map((at) => at - 0.5 * (n - 1));
    const radius = Math.hypot(x!, y!, z!);
    if (radius < 20 && Math.hypot(x! - 5, y! + 4) > 5) {
      rgb.set(colors[Math.floor((x! + 2 * z! + 90) / 7) % 3]!, 3 * i);
    }
  }
  const header = [
    "NRRD0004",
    "type: uchar",
    "dimension: 4",
    `sizes: 3 ${n} ${n} ${n}`,
    "space: right-anterior-superior",
    "space directions: none (2,0,0) (0,2,0) (0,0,2)",
    "space origin: (-47,-47,-47)",
    "kinds: RGB-color domain domain domain",
    "encoding: raw",
  ];
  mkdirSync(work);
  const volume = join(work, "photo.nrrd");
  writeFileSync(volume, Buffer.concat([Buffer.from(`${header.join("\n")}\n\n`), rgb]));
  await makeCase(volume, "photo", "Striped ball", work, out, "100");
}
