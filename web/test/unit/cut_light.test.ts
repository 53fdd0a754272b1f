import { readFileSync } from "node:fs";
import { resolve } from "node:path";
import { beforeAll, describe, expect, it } from "vitest";

import { parseSection, type Section } from "../../src/sog/section";
import { CutLight } from "../../src/worker/cut_light";
import type { CutLightTexels } from "../../src/worker/protocol";
import { makeSectionBlock } from "./section_fixture";

const kSide = 40;
const kHalf = 0.5 * (kSide - 1);
const kRadius = 12; // voxels

/** A block with a hollow ball in it, opaque but for `extinction`. */
function hollowBlock(extinction: number): Section {
  const table = (value: number) => Array.from({ length: 256 }, (_, code) => (code >= 100 ? value : 0));
  const block = makeSectionBlock();
  Object.assign(block, {
    dims: [kSide, kSide, kSide],
    tile: [48, 48],
    columns: 7,
    spacing: [2, 2, 2],
    source_spacing: [2, 2, 2],
    origin: [-2 * kHalf, -2 * kHalf, -2 * kHalf],
    axis_x: [1, 0, 0],
    axis_y: [0, 1, 0],
  });
  Object.assign(block["materials"] as object, {
    extinction: table(extinction),
    surface_r: table(0.8),
    surface_g: table(0.4),
    surface_b: table(0.2),
  });
  const info = parseSection({ section: block }, new Map([["section.webp", null]]))!;
  const voxels = new Uint8Array(kSide ** 3);
  for (let i = 0; i < voxels.length; ++i) {
    const [x, y, z] = [i % kSide, Math.floor(i / kSide) % kSide, Math.floor(i / kSide ** 2)];
    voxels[i] = Math.hypot(x - kHalf, y - kHalf, z - kHalf) < kRadius ? 20 : 200;
  }
  return { ...info, voxels, counts: [] };
}

function linearFromSrgb(texel: number): number {
  const x = texel / 255;
  return x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4;
}

/** Means of r, g and b over the cells of walls that have any light, and how many those are. */
function meanLight({ texels, scale }: CutLightTexels): { mean: number[]; cells: number } {
  const sum = [0, 0, 0];
  let cells = 0;
  for (let i = 0; i < texels.length / 2; i += 4) {
    if (texels[i + 3]! > 0) {
      ++cells;
      sum.forEach((_, c) => (sum[c]! += scale * linearFromSrgb(texels[i + c]!)));
    }
  }
  return { mean: sum.map((all) => all / cells), cells };
}

describe("the light of cuts, as WebAssembly", () => {
  let module: WebAssembly.Module;
  const lower = new Float32Array([0, 0, -1, 0]); // keeps z <= 0

  beforeAll(async () => {
    const file = resolve(process.env["CLIPGS_WEB_OUT"] ?? "build", "cut_light.wasm");
    module = await WebAssembly.compile(readFileSync(file));
  });

  it("finds walls, which are dark in a closed hollow and lit in an opened one", () => {
    const section = hollowBlock(5);
    const light = new CutLight(module, section);
    const openings = light.prepare(section);
    const { ownLight, cells } = openings.light!;
    expect(openings.blockDims).toEqual([20, 20, 20]);
    expect(openings.blocks).toHaveLength(20 ** 3);
    expect(openings.blocks[10 + 20 * (10 + 20 * 10)]! & 127).toBeGreaterThan(2); // empty all around the middle
    expect(openings.blocks[0]! & 127).toBe(0);
    expect(openings.outlined).toBe(true);
    expect(ownLight.texels).toHaveLength(2 * 6 * 4 * cells.reduce((a, b) => a * b));
    const closed = meanLight(ownLight);
    expect(closed.cells).toBeGreaterThan(50);
    expect(closed.mean).toEqual([0, 0, 0]);

    const opened = meanLight(light.solve(lower, false));
    expect(opened.cells).toBe(closed.cells);
    expect(opened.mean.every((v) => v > 0.1 && v < 1)).toBe(true);
    // What walls throw back is theirs to colour.
    expect(opened.mean[0]).toBeGreaterThan(opened.mean[2]!);
    // From there a few bounces are enough for the same plane.
    meanLight(light.solve(lower, true)).mean.forEach((v, c) => expect(v).toBeCloseTo(opened.mean[c]!, 2));
  });

  it("follows the lights", () => {
    const section = hollowBlock(5);
    const light = new CutLight(module, section);
    light.prepare(section);
    const { rig } = section;
    light.setRig({ skyTop: [1, 1, 1], skyHorizon: [1, 1, 1], skyBottom: [1, 1, 1], keys: [] });
    const white = meanLight(light.solve(lower, false)).mean;
    light.setRig({ skyTop: [2, 2, 2], skyHorizon: [2, 2, 2], skyBottom: [2, 2, 2], keys: [] });
    meanLight(light.solve(lower, false)).mean.forEach((v, c) => expect(v / white[c]!).toBeCloseTo(2, 2));
    light.setRig(rig);
    expect(meanLight(light.solve(new Float32Array(0), false)).mean).toEqual([0, 0, 0]);
  });

  it("leaves what is translucent to the splats", () => {
    const section = hollowBlock(0.05);
    const { outlined, light } = new CutLight(module, section).prepare(section);
    expect(outlined).toBe(false);
    expect(light).toBe(null);
  });
});
