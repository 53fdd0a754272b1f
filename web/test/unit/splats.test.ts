import { Matrix4, Quaternion, Vector3 } from "three";
import { describe, expect, it } from "vitest";

import { parseCaseInfo } from "../../src/model/case_info";
import type { PackedScene } from "../../src/sog/sog";
import { CaseError } from "../../src/sog/zip";
import { packCloud } from "../../src/splats/pack_cloud";
import { makePalette } from "../../src/splats/palette";
import { readPly } from "../../src/splats/ply";
import { readSplatFile } from "../../src/splats/splat_file";
import { readSpz } from "../../src/splats/spz";
import { kindOf } from "../../src/worker/own_file";
import { makeRandom } from "./sog_fixture";
import { makeCompressedPly, makePly, makeSplats, makeSpz, type Splat } from "./splat_fixture";

/** Splat `i` as shaders/packed.glsl and color.frag.glsl read it. */
function unpacked(
  { packed, sh0, meanMin, meanMax, scaleCodebook, sh0Codebook, shN }: PackedScene,
  i: number,
): Splat {
  const [x, y, z, w] = packed.subarray(4 * i, 4 * i + 4) as unknown as [number, number, number, number];
  const mean = [x & 0xffff, x >>> 16, y & 0xffff].map((code, c) => {
    const v = meanMin[c]! + (code / 65535) * (meanMax[c]! - meanMin[c]!);
    return Math.sign(v) * Math.expm1(Math.abs(v));
  });
  const rotation = [z & 255, (z >>> 8) & 255, (z >>> 16) & 255].map((b) => (b / 255 - 0.5) * Math.SQRT2);
  const largest = Math.sqrt(1 - rotation.reduce((sum, v) => sum + v * v, 0));
  rotation.splice(z >>> 24, 0, largest);
  const label = y >>> 16;
  const sh = Array.from({ length: shN?.coefficients ?? 0 }, (_, j) =>
    [0, 1, 2].map((c) => shN!.codebook[shN!.centroids.rgba[4 * (label * shN!.coefficients + j) + c]!]!),
  );
  return {
    mean,
    logScale: [w & 255, (w >>> 8) & 255, (w >>> 16) & 255].map((code) => Math.log(scaleCodebook[code]!)),
    rotation,
    opacity: (w >>> 24) / 255,
    sh0: [0, 1, 2].map((c) => sh0Codebook[sh0[4 * i + c]!]!),
    sh,
  };
}

const off = (a: readonly number[], b: readonly number[]) => Math.max(...a.map((v, k) => Math.abs(v - b[k]!)));

/** How far splats are from what they were: at most, of each property. */
function errors(scene: PackedScene, splats: readonly Splat[]): Record<keyof Splat, number> {
  const most = { mean: 0, logScale: 0, rotation: 0, opacity: 0, sh0: 0, sh: 0 };
  splats.forEach((splat, i) => {
    const got = unpacked(scene, i);
    most.mean = Math.max(most.mean, off(got.mean, splat.mean));
    most.logScale = Math.max(most.logScale, off(got.logScale, splat.logScale));
    const [a, b] = [got, splat].map(({ rotation: [w, x, y, z] }) => new Quaternion(x, y, z, w)) as [
      Quaternion,
      Quaternion,
    ];
    most.rotation = Math.max(most.rotation, a.angleTo(b));
    most.opacity = Math.max(most.opacity, Math.abs(got.opacity - splat.opacity));
    most.sh0 = Math.max(most.sh0, off(got.sh0, splat.sh0));
    most.sh = Math.max(most.sh, off(got.sh.flat(), splat.sh.flat()));
  });
  return most;
}

function expectNear(
  scene: PackedScene,
  splats: readonly Splat[],
  wanted: Partial<Record<keyof Splat, number>>,
): void {
  const usual = { mean: 1e-4, logScale: 0.02, rotation: 0.02, opacity: 0.0021, sh0: 0.01, sh: 0.003 };
  const most = errors(scene, splats);
  for (const [key, limit] of Object.entries({ ...usual, ...wanted })) {
    expect(most[key as keyof Splat], key).toBeLessThan(limit);
  }
}

const splats = makeSplats(300, 15, makeRandom(5));
const file = (bytes: Uint8Array, name: string) => new File([Uint8Array.from(bytes)], name);

describe("splats of other programs", () => {
  it.each([0, 3, 8, 15])("come from a PLY with %d harmonics as they are", (coefficients) => {
    const some = splats.map((splat) => ({ ...splat, sh: splat.sh.slice(0, coefficients) }));
    const scene = packCloud(readPly(makePly(some)));
    expect(scene.count).toBe(300);
    expect(scene.shN?.coefficients ?? 0).toBe(coefficients);
    expectNear(scene, some, coefficients === 0 ? { sh: Infinity } : {});
  });

  it("come from SuperSplat's compressed PLY", () => {
    const scene = packCloud(readPly(makeCompressedPly(splats)));
    expectNear(scene, splats, { mean: 0.009, logScale: 0.03, sh0: 0.15, sh: 0.017 });
  });

  it.each([2, 3, 4] as const)(
    "come from SPZ of version %d, whose y and z point the other way",
    async (version) => {
      const cloud = await readSpz(file(makeSpz(splats, version), "a.spz"));
      const rotation = version === 2 ? 0.25 : 0.02; // w of small ones is what three bytes leave
      expectNear(packCloud(cloud), splats, { mean: 3e-4, logScale: 0.05, rotation, sh0: 0.03, sh: 0.012 });
    },
  );

  it("that cannot be seen, or are no numbers, are left out", () => {
    const some = splats.slice(0, 4).map((splat) => ({ ...splat }));
    some[0]!.opacity = 1e-4;
    some[1]!.mean = [NaN, 0, 0];
    some[2]!.logScale = [0, Infinity, 0];
    expectNear(packCloud(readPly(makePly(some))), some.slice(3), {});
    expect(() => packCloud(readPly(makePly(some.slice(0, 3))))).toThrow(/has no splats that could be seen/);
  });

  it("lie in a world of metres, framed without outliers", async () => {
    const some = splats.map((splat) => ({ ...splat }));
    some[7]!.mean = [500, 0, 0];
    const { scene, clipgs } = await readSplatFile(file(makePly(some), "a head.ply"), "ply");
    const info = parseCaseInfo(clipgs);
    expect(scene.count).toBe(300);
    expect([info.title, info.mmPerUnit]).toEqual(["a head.ply", 1000]);
    expect(info.sphere.center.length()).toBeLessThan(60);
    expect(info.sphere.radius).toBeGreaterThan(450);
    expect(info.sphere.radius).toBeLessThan(530);
    // x right, y down, z forward of one who faces the viewer.
    const to = (x: number, y: number, z: number) =>
      new Vector3(x, y, z).applyMatrix4(new Matrix4().copy(info.sceneToPatient));
    expect(to(1, 2, 3).toArray()).toEqual([-1000, -3000, -2000]);
    const [flat] = await Promise.all([readSplatFile(file(makePly(some.slice(0, 1)), "one.ply"), "ply")]);
    expect(parseCaseInfo(flat.clipgs).sphere.radius).toBeGreaterThan(0);
  });
});

describe("files that hold no splats", () => {
  const ply = makePly(splats.slice(0, 20));

  it("are known by how they begin", async () => {
    const kinds = await Promise.all(
      [ply, makeSpz(splats, 3), makeSpz(splats, 4), Buffer.from("PK"), Buffer.alloc(0)].map((bytes) =>
        kindOf(new Blob([Uint8Array.from(bytes)])),
      ),
    );
    expect(kinds).toEqual(["ply", "spz", "spz", "case", "case"]);
  });

  it.each<[Buffer, RegExp]>([
    [makePly(splats, ["scale_0", "scale_1", "scale_2"]), /has no splats: its points have no "scale_0"/],
    [makePly(splats, ["f_rest_44"]), /has 44 properties/],
    [makePly([]), /has no splats: it has no points/],
    [makePly(splats, [], "ascii"), /binary, little-endian/],
    [makePly(splats, [], "binary_big_endian"), /binary, little-endian/],
    [Buffer.from("ply\nformat binary_little_endian 1.0\n"), /its header has no end/],
    [
      Buffer.from("ply\nformat binary_little_endian 1.0\nelement vertex -3\nend_header\n"),
      /element vertex -3/,
    ],
    [
      Buffer.from(
        "ply\nformat binary_little_endian 1.0\nelement vertex 5000000000\nproperty float x\nend_header\n",
      ),
      /ends too early/,
    ],
    [
      Buffer.from(
        "ply\nformat binary_little_endian 1.0\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n12345678",
      ),
      /has no points/,
    ],
    [ply.subarray(0, ply.length - 1), /ends too early for 20 of "vertex"/],
  ])("are refused as PLY (%#)", (bytes, message) => {
    expect(() => readPly(bytes)).toThrow(CaseError);
    expect(() => readPly(bytes)).toThrow(message);
  });

  it("are refused wherever they are cut off, and survive flipped bytes", () => {
    const compressed = makeCompressedPly(splats.slice(0, 3));
    for (const whole of [compressed, makePly(splats.slice(0, 2))]) {
      for (let length = 0; length < whole.length; length += 7) {
        expect(() => readPly(whole.subarray(0, length)), `${length} bytes`).toThrow(CaseError);
      }
      for (let at = 0; at < whole.length; at += 3) {
        const broken = Uint8Array.from(whole);
        broken[at]! ^= 0xff;
        try {
          packCloud(readPly(broken));
        } catch (error) {
          expect(error, `byte ${at}`).toBeInstanceOf(CaseError);
        }
      }
    }
  });

  it.each<[Buffer, RegExp]>([
    [makeSpz(splats, 3, { version: 1 }), /version 1/],
    [makeSpz(splats, 3, { version: 5 }), /version 5/],
    [makeSpz(splats, 4, { version: 5 }), /version 5/],
    [makeSpz(splats, 4, { count: 301 }), /damaged/],
    [makeSpz(splats, 4).subarray(0, 900), /damaged/],
    [makeSpz(splats, 4).subarray(0, 40), /damaged/],
    [makeSpz(splats, 3, { count: 0 }), /has no splats/],
    [makeSpz(splats, 3, { count: 301 }), /ends too early/],
    [makeSpz(splats, 3, { count: 4e9 }), /has 4000000000 splats/],
    [makeSpz(splats, 3).subarray(0, 900), /damaged|ends too early/],
    [Buffer.from("\x1f\x8bno gzip"), /damaged/],
  ])("are refused as SPZ (%#)", async (bytes, message) => {
    await expect(readSpz(file(bytes, "a.spz"))).rejects.toThrow(CaseError);
    await expect(readSpz(file(bytes, "a.spz"))).rejects.toThrow(message);
  });
});

describe("a palette of harmonics", () => {
  it("has an entry for each while there is room, and then for those that are alike", () => {
    const random = makeRandom(3);
    const codes = Uint8Array.from({ length: 9 * 70_000 }, () => Math.floor(256 * random()));
    const few = makePalette(codes.subarray(0, 9 * 100), 9);
    const at = ({ labels, centroids }: typeof few, i: number) =>
      [0, 1, 2].flatMap((j) => [
        ...centroids.rgba.subarray(4 * (3 * labels[i]! + j), 4 * (3 * labels[i]! + j) + 3),
      ]);
    for (let i = 0; i < 100; ++i) {
      expect(at(few, i)).toEqual([...codes.subarray(9 * i, 9 * i + 9)]);
    }
    const many = makePalette(codes, 9);
    expect(many.centroids.width).toBe(192);
    expect(many.centroids.height).toBeLessThanOrEqual(1024);
    let sum = 0;
    for (let i = 0; i < 70_000; ++i) {
      sum += at(many, i).reduce((all, v, k) => all + Math.abs(v - codes[9 * i + k]!), 0);
    }
    expect(sum / codes.length).toBeLessThan(6); // codes, in the mean: most have an entry of their own
    const alike = makePalette(new Uint8Array(9 * 500).fill(7), 9);
    expect([alike.centroids.height, new Set(alike.labels).size]).toEqual([1, 1]);
  });
});
