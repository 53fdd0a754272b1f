import { describe, expect, it } from "vitest";

import { parseSection, readMosaicVoxels, type SectionInfo, sectionOf } from "../../src/sog/section";
import type { Texels } from "../../src/sog/sog";
import { CaseError, crc32 } from "../../src/sog/zip";
import { makeSectionBlock, withValue } from "./section_fixture";

const archive = new Map([["section.webp", new Uint8Array(4)]]);

function parse(block: unknown): SectionInfo {
  return parseSection({ section: block }, archive)!;
}

describe("parseSection", () => {
  it("reads what the block says", () => {
    const info = parse(makeSectionBlock());
    expect(info.dims).toEqual([5, 18, 7]);
    expect(info.mosaic).toEqual({ tileWidth: 16, tileHeight: 32, columns: 3, rows: 3 });
    expect(info.axes[1]).toEqual([-1, 0, 0]);
    expect(info.curve[255]).toBe(1550);
    expect(info.materials.interior[0][255]).toBeCloseTo(1.9);
    expect(info.boundary?.to).toBe(80);
    expect(info.boundary?.reflectance[1][255]).toBeCloseTo(0.4);
    expect(info.rig.keys).toHaveLength(3);
    expect(info.exposure).toBe(1.2);
    expect(info.tone).toBe("srgb");
  });

  it("knows a video of version 3 from an image", () => {
    const block: Record<string, unknown> = { ...makeSectionBlock(), version: 3, coding: "av1" };
    delete block["tile"];
    delete block["columns"];
    expect(parse(block).mosaic).toBe(null);
    expect(() => parse({ ...block, coding: "vp9" })).toThrow(/coding/);
    expect(() => parse({ ...block, channels: 3 })).toThrow(/coding/);
  });

  it("takes cases without one, and modalities that it does not know", () => {
    expect(parseSection(undefined, archive)).toBeNull();
    expect(parseSection({ version: 1 }, archive)).toBeNull();
    expect(parse(withValue(makeSectionBlock(), "modality", "PET")).modality).toBe("PET");
    expect(parse(withValue(makeSectionBlock(), "modality", "thermography")).modality).toBe("unknown");
  });

  it("reads the tone curve of version 2", () => {
    const block = withValue({ ...makeSectionBlock(), version: 2 }, "lights.tone", "filmic");
    expect(parse(block).tone).toBe("filmic");
  });

  it.each([
    ["version", 4, /version/],
    ["version", undefined, /section\.version/],
    ["file", undefined, /section\.file/],
    ["file", "nowhere.webp", /nowhere\.webp is missing/],
    ["dims", [5, 18], /dims/],
    ["dims", [5, 0, 7], /dims/],
    ["dims", [5, 18.5, 7], /dims/],
    ["dims", [5, 18, 1025], /dims/],
    ["tile", [16, 16], /tile/],
    ["tile", [16], /tile/],
    ["columns", 0, /columns/],
    ["columns", 8, /columns/],
    ["columns", 1.5, /columns/],
    ["channels", 2, /channels/],
    ["channels", 4, /channels/],
    ["spacing", [2, 0, 1], /spacing/],
    ["spacing", [2, 1, "x"], /spacing/],
    ["source_spacing", [1, 1, -1], /source_spacing/],
    ["origin", [0, 0, null], /origin/],
    ["axis_x", [0, 2, 0], /axis_x/],
    ["axis_z", [0, 0, -1], /axis_z/],
    ["modality", 3, /modality/],
    ["curve", Array(256).fill(1), /curve/],
    ["curve", [1, 2], /curve/],
    ["value_errors", [1, 2], /value_errors/],
    ["value_errors", Array(16).fill(-1), /value_errors/],
    ["materials", [], /materials/],
    ["materials.extinction", Array(256).fill(-1), /materials\.extinction/],
    ["materials.specular", Array(256).fill(2), /materials\.specular/],
    ["materials.roughness", Array(255).fill(0.5), /materials\.roughness/],
    ["materials.surface_g", undefined, /materials\.surface_g/],
    ["materials.interior_b", Array(256).fill(1e9), /materials\.interior_b/],
    ["boundary.from", -1, /boundary\.from/],
    ["boundary.to", 20, /boundary\.to/],
    ["boundary.g", Array(256).fill(-1), /boundary\.g/],
    ["boundary.b", undefined, /boundary\.b/],
    ["lights", undefined, /lights/],
    ["lights.sky_top", [1, 1, -1], /lights\.sky_top/],
    ["lights.keys", Array(9).fill({}), /lights\.keys/],
    ["lights.keys", [{ radiance: [1, 1, 1], angular_radius: 0.1 }], /keys\[0\]\.direction/],
    ["lights.keys.0.radiance", [1, 1], /keys\[0\]\.radiance/],
    ["lights.keys.0.angular_radius", 2, /keys\[0\]\.angular_radius/],
    ["lights.exposure", 0, /lights\.exposure/],
    ["lights.tone", "agfa", /tone curve "agfa" that this viewer does not know; use a newer clipgs/],
    ["lights.tone", 2, /lights\.tone/],
  ])("refuses %s = %j", (path, value, message) => {
    const block = withValue(makeSectionBlock(), path, value);
    expect(() => parse(block)).toThrow(CaseError);
    expect(() => parse(block)).toThrow(message);
  });

  it("refuses more than an image can hold, and what is no object", () => {
    const tall = { ...makeSectionBlock(), dims: [5, 1024, 17], tile: [16, 1024], columns: 1 };
    expect(() => parse(tall)).toThrow(/columns/);
    for (const block of [null, 5, "text", []]) {
      expect(() => parse(block)).toThrow(CaseError);
    }
  });
});

describe("a section in one image", () => {
  const read = (info: SectionInfo, texels: Texels) =>
    sectionOf(info, readMosaicVoxels(info, info.mosaic!, texels));

  /** What voxel (x, y, z) of the fixture holds. */
  const value = (x: number, y: number, z: number) => (x + 5 * y + 90 * z) % 251;

  /** The image of its slices; 99 where there is no voxel. */
  function mosaic(info: SectionInfo): Texels {
    const { dims } = info;
    const { tileWidth, tileHeight, columns, rows } = info.mosaic!;
    const width = columns * tileWidth;
    const height = rows * tileHeight;
    const rgba = new Uint8Array(4 * width * height).fill(99);
    for (let z = 0; z < dims[2]; ++z) {
      for (let y = 0; y < dims[1]; ++y) {
        for (let x = 0; x < dims[0]; ++x) {
          const row = Math.floor(z / columns) * tileHeight + y;
          const v = value(x, y, z);
          rgba.set([v, 255 - v, v >> 1, 255], 4 * (row * width + (z % columns) * tileWidth + x));
        }
      }
    }
    return { width, height, rgba };
  }

  for (const channels of [1, 3]) {
    it(`puts every voxel in its place and checks them (${channels} channels)`, () => {
      const info = parse({ ...makeSectionBlock(), channels });
      const { voxels, counts } = read(info, mosaic(info));
      expect(voxels.length).toBe(5 * 18 * 7 * channels);
      for (let i = 0; i < voxels.length / channels; ++i) {
        const v = value(i % 5, Math.floor(i / 5) % 18, Math.floor(i / 90));
        const expected = channels === 3 ? [v, 255 - v, v >> 1] : [v];
        expect([...voxels.subarray(channels * i, channels * (i + 1))]).toEqual(expected);
      }
      expect(counts.reduce((sum, n) => sum + n)).toBe(voxels.length);
      expect(counts[7]).toBe(voxels.filter((v) => v === 7).length);

      const checksum = crc32(voxels).toString(16).padStart(8, "0");
      const checked = parse({ ...makeSectionBlock(), channels, checksum });
      expect(read(checked, mosaic(checked)).voxels).toEqual(voxels);
      const shifted = mosaic(checked);
      shifted.rgba.copyWithin(4, 0); // as by a decoder that loses an offset
      expect(() => read(checked, shifted)).toThrow(/section\.webp .* checksum differs.*not shown/);
      const other = mosaic(checked);
      other.rgba[0]! ^= 1;
      expect(() => read(checked, other)).toThrow(CaseError);
    });
  }

  it("takes no image of another size", () => {
    const info = parse(makeSectionBlock());
    const { width, height, rgba } = mosaic(info);
    expect(() => read(info, { width: height, height: width, rgba })).toThrow(/does not fit/);
  });
});
