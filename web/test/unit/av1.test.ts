import { readFileSync } from "node:fs";

import { describe, expect, it } from "vitest";

import { decodeAv1 } from "../../src/sog/av1";
import { CaseError } from "../../src/sog/zip";

/** 7 slices of 5 × 18 voxels, 40 + 10x + 5y + 3z, as encode_av1() of src/asset/av1.h codes them: none is another. */
const stream = new Uint8Array(
  Buffer.from(
    "EgAKCgAAAAEkibXwEIAyKRAAgQAAAgCxLL3k7bsmDzpYFL/+b/6mod4mfxuR1DZ7nI62SXab9U9NEgAyGygF4EAAACNBgAABEADnHicnIFW/EIqlkAVdoDIS" +
      "KALggAAAo0LAAAEoAPQq2Yv0MhAwA8IAAIFGiAAAAnAA9DTAEgAaAagSADIWMAZECYABRogAAAIgAOdhdfOXGlXSgBIAMhMwCAgRMAFGiAAAAnAA5qsWIwwg" +
      "EgAyEjAKABYgwUaIAAACIAD1uwJ0mBIAMhgwDZAWIhhGiAAAAiAA5z7ozL/zA6IMTOA=",
    "base64",
  ),
);
const dav1d = new WebAssembly.Module(readFileSync("node_modules/ogv/dist/ogv-decoder-video-av1-wasm.wasm"));
const decode = (bytes: Uint8Array, dims: [number, number, number] = [5, 18, 7]) =>
  decodeAv1(dav1d, bytes, dims, "section.obu");

describe("decodeAv1", () => {
  it("puts every voxel in its place", async () => {
    const voxels = await decode(stream);
    expect(voxels).toHaveLength(5 * 18 * 7);
    voxels.forEach((voxel, i) =>
      expect(voxel).toBe(40 + 10 * (i % 5) + 5 * (Math.floor(i / 5) % 18) + 3 * Math.floor(i / 90)),
    );
  });

  it.each([
    [[6, 18, 7], /other slices/],
    [[5, 17, 7], /other slices/],
    [[5, 18, 6], /other slices/],
    [[5, 18, 8], /other slices/],
  ] as const)("refuses slices that are not %j", async (dims, message) => {
    await expect(decode(stream, [...dims])).rejects.toThrow(message);
  });

  it("refuses what is damaged, in a line", async () => {
    for (const bytes of [
      new Uint8Array(50).fill(255),
      new TextEncoder().encode("not a video"),
      stream.subarray(0, 100),
      stream.subarray(stream.length / 2),
    ]) {
      await expect(decode(bytes)).rejects.toThrow(CaseError);
      await expect(decode(bytes)).rejects.toThrow(/^section\.obu [^\n]*$/);
    }
  });

  it("ends with voxels or a line, whichever bit is wrong", async () => {
    for (let i = 0; i < stream.length; i += 3) {
      const bytes = stream.slice();
      bytes[i]! ^= 1 << i % 8;
      const outcome = await decode(bytes).catch((error: unknown) => error);
      expect(outcome instanceof CaseError || outcome instanceof Uint8Array).toBe(true);
    }
  });
});
