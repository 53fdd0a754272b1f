import { describe, expect, it } from "vitest";

import { packScene, parseSogMeta } from "../../src/sog/sog";
import { CaseError } from "../../src/sog/zip";
import { makeArchive, makeImages, makeMeta } from "./sog_fixture";

/** meta.json with the value at `path` replaced (undefined: left out). */
function changed(path: string, value: unknown): Map<string, Uint8Array> {
  const meta = makeMeta(20);
  const keys = path.split(".");
  const last = keys.pop()!;
  const parent = keys.reduce<Record<string, unknown>>((o, key) => o[key] as Record<string, unknown>, meta);
  parent[last] = value;
  return makeArchive(meta);
}

describe("parseSogMeta", () => {
  it("reads a scene with and without higher harmonics", () => {
    const meta = parseSogMeta(makeArchive(makeMeta(20)));
    expect(meta.count).toBe(20);
    expect(meta.shN?.coefficients).toBe(3);
    expect(parseSogMeta(changed("shN", undefined)).shN).toBeNull();
    expect(meta.faces?.coefficients).toBe(4);
    expect(parseSogMeta(changed("clipgs_faces", undefined)).faces).toBeNull();
    expect(meta.layers).toEqual({ count: 200, file: "layers.webp" });
    for (const absent of ["clipgs", "clipgs.states", "clipgs.states.file"]) {
      expect(parseSogMeta(changed(absent, undefined)).layers).toBeNull();
    }
  });

  it.each([
    ["version", 1, /version 1/],
    ["count", 0, /count/],
    ["count", 1.5, /count/],
    ["count", 1e9, /count/],
    ["count", "20", /count/],
    ["means", undefined, /"means"/],
    ["means.mins", [0, 0], /means\.mins/],
    ["means.maxs", [0, 0, "x"], /means\.maxs/],
    ["means.files", ["means_l.webp"], /means\.files/],
    ["means.files", ["means_l.webp", "nowhere.webp"], /nowhere\.webp is missing/],
    ["scales.codebook", [1, 2], /scales\.codebook/],
    ["sh0.codebook", Array(256).fill(null), /sh0\.codebook/],
    ["quats", [], /"quats"/],
    ["shN.bands", 4, /shN\.bands/],
    ["shN.count", 65537, /shN\.count/],
    ["clipgs_faces.bands", 2, /clipgs_faces\.bands/],
    ["clipgs_faces.files", [], /clipgs_faces\.files/],
    ["clipgs.states.file", 1, /states\.file/],
    ["clipgs.states.file", "nowhere.webp", /nowhere\.webp is missing/],
    ["clipgs.states.count", 0, /states\.count/],
  ])("refuses %s = %j", (path, value, message) => {
    expect(() => parseSogMeta(changed(path, value))).toThrow(CaseError);
    expect(() => parseSogMeta(changed(path, value))).toThrow(message);
  });

  it("refuses what is no JSON, or none at all", () => {
    for (const text of ["", "{", "null", "[]", '"text"']) {
      expect(() => parseSogMeta(makeArchive(text))).toThrow(CaseError);
    }
    expect(() => parseSogMeta(new Map())).toThrow(/no meta\.json/);
  });
});

describe("packScene", () => {
  const meta = parseSogMeta(makeArchive(makeMeta(20)));

  it("keeps every number of every splat", () => {
    const images = makeImages(meta);
    const scene = packScene(meta, images);
    for (let i = 0; i < meta.count; ++i) {
      const b = 4 * i;
      const mean = (c: number) => images.meansLow.rgba[b + c]! + 256 * images.meansHigh.rgba[b + c]!;
      const [x, y, z, w] = scene.packed.subarray(b, b + 4) as unknown as [number, number, number, number];
      expect([x & 0xffff, x >>> 16, y & 0xffff]).toEqual([mean(0), mean(1), mean(2)]);
      expect(y >>> 16).toBe(images.shN!.labels.rgba[b]);
      expect([z & 255, (z >> 8) & 255, (z >> 16) & 255]).toEqual([...images.quats.rgba.subarray(b, b + 3)]);
      expect((z >>> 24) + 252).toBe(images.quats.rgba[b + 3]);
      expect([w & 255, (w >> 8) & 255, (w >> 16) & 255]).toEqual([...images.scales.rgba.subarray(b, b + 3)]);
      expect(w >>> 24).toBe(images.sh0.rgba[b + 3]);
      expect([...scene.sh0.subarray(b, b + 3)]).toEqual([...images.sh0.rgba.subarray(b, b + 3)]);
    }
    expect([...scene.faces!.labels]).toEqual(
      Array.from({ length: 20 }, (_, i) => images.faces!.labels.rgba[4 * i]),
    );
    expect([...scene.layers!]).toEqual(Array.from({ length: 20 }, (_, i) => images.layers!.rgba[4 * i]));
    const code = images.faces!.centroids.rgba[0]!;
    expect(scene.faces!.palette.rgba[0]).toBeCloseTo(code / 255 - 0.5, 6);
    expect(scene.scaleCodebook[0]).toBeCloseTo(Math.exp(-7), 8);
  });

  it("refuses images that do not fit", () => {
    for (const key of ["meansLow", "meansHigh", "scales", "quats", "sh0"] as const) {
      const images = makeImages(meta);
      images[key] = { width: 4, height: 4, rgba: images[key].rgba.slice(0, 64) };
      expect(() => packScene(meta, images), key).toThrow(/too small/);
    }
    const small = makeImages(meta);
    small.shN!.centroids = { width: 64, height: 1, rgba: new Uint8Array(256) };
    expect(() => packScene(meta, small)).toThrow(/palette/);
  });

  it("refuses rotations and palette entries that do not exist", () => {
    const rotation = makeImages(meta);
    rotation.quats.rgba[4 * 7 + 3] = 251;
    expect(() => packScene(meta, rotation)).toThrow(/splat 7/);
    const label = makeImages(meta);
    label.shN!.labels.rgba[4 * 5 + 1] = 1;
    expect(() => packScene(meta, label)).toThrow(/splat 5 .* of 3/);
    const face = makeImages(meta);
    face.faces!.labels.rgba[4 * 6] = 2;
    expect(() => packScene(meta, face)).toThrow(/splat 6 .* of 2/);
    const layer = makeImages(meta);
    layer.layers!.rgba[4 * 8] = 200;
    expect(() => packScene(meta, layer)).toThrow(/splat 8 is of layer 200 of 200/);
  });
});
