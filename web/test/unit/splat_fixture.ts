import { gzipSync } from "node:zlib";

/** A splat, in the axes of PLY files; `rotation` w x y z; `sh` [coefficient][channel]. */
export interface Splat {
  mean: number[];
  logScale: number[];
  rotation: number[];
  opacity: number; // 0 … 1
  sh0: number[];
  sh: number[][];
}

export function makeSplats(count: number, coefficients: number, random: () => number): Splat[] {
  const between = (least: number, most: number) => least + (most - least) * random();
  const triple = (make: () => number) => [make(), make(), make()];
  return Array.from({ length: count }, () => {
    const q = [0, 0, 0, 0].map(() => between(-1, 1));
    return {
      mean: triple(() => between(-0.3, 0.3)),
      logScale: triple(() => between(-7, -3)),
      rotation: q.map((v) => v / Math.hypot(...q)),
      opacity: between(0.2, 1),
      sh0: triple(() => between(-1.5, 1.5)),
      sh: Array.from({ length: coefficients }, () => triple(() => between(-0.5, 0.5))),
    };
  });
}

function header(format: string, elements: [name: string, count: number, properties: string[]][]): Buffer {
  const lines = elements.flatMap(([name, count, properties]) => [
    `element ${name} ${count}`,
    ...properties.map((property) => `property ${property}`),
  ]);
  return Buffer.from(
    ["ply", `format ${format} 1.0`, "comment made by a test", ...lines, "end_header", ""].join("\n"),
  );
}

function floats(values: number[]): Buffer {
  return Buffer.from(Float32Array.from(values).buffer);
}

/** As 3DGS trainers write it. */
export function makePly(splats: Splat[], left: string[] = [], format = "binary_little_endian"): Buffer {
  const coefficients = splats[0]?.sh.length ?? 0;
  const columns: [string, (splat: Splat) => number][] = [
    ...["x", "y", "z"].map((name, c): [string, (s: Splat) => number] => [name, (s) => s.mean[c]!]),
    ...["nx", "ny", "nz"].map((name): [string, () => number] => [name, () => 0]),
    ...[0, 1, 2].map((c): [string, (s: Splat) => number] => [`f_dc_${c}`, (s) => s.sh0[c]!]),
    ...Array.from({ length: 3 * coefficients }, (_, k): [string, (s: Splat) => number] => [
      `f_rest_${k}`,
      (s) => s.sh[k % coefficients]![Math.floor(k / coefficients)]!,
    ]),
    ["opacity", (s) => Math.log(s.opacity / (1 - s.opacity))],
    ...[0, 1, 2].map((c): [string, (s: Splat) => number] => [`scale_${c}`, (s) => s.logScale[c]!]),
    ...[0, 1, 2, 3].map((c): [string, (s: Splat) => number] => [`rot_${c}`, (s) => s.rotation[c]!]),
  ];
  const kept = columns.filter(([name]) => !left.includes(name));
  return Buffer.concat([
    header(format, [["vertex", splats.length, kept.map(([name]) => `float ${name}`)]]),
    ...splats.map((splat) => floats(kept.map(([, value]) => value(splat)))),
  ]);
}

/** As SuperSplat compresses it: the ranges of each chunk of 256 splats are others. */
export function makeCompressedPly(splats: Splat[]): Buffer {
  const [least, most] = [-8, 8];
  const leastOf = (i: number) => least - Math.floor(i / 256);
  const share = (v: number, from: number, to = most) => (v - from) / (to - from);
  const pack = (values: number[], bits: number[]) =>
    values.reduce((all, v, i) => all * 2 ** bits[i]! + Math.round(v * (2 ** bits[i]! - 1)), 0);
  const kThirds = [11, 10, 11];
  const names = ["x", "y", "z", "scale_x", "scale_y", "scale_z", "r", "g", "b"];
  const rows = splats.map(({ mean, logScale, rotation, opacity, sh0 }, i) => {
    const from = leastOf(i);
    const largest = rotation.reduce((best, v, k) => (Math.abs(v) > Math.abs(rotation[best]!) ? k : best), 0);
    const others = rotation
      .filter((_, k) => k !== largest)
      .map((v) => (Math.sign(rotation[largest]!) * v) / Math.SQRT2 + 0.5);
    const colors = sh0.map((v) => share(0.5 + 0.28209479177387814 * v, from));
    return Buffer.from(
      Uint32Array.of(
        pack(
          mean.map((v) => share(v, from)),
          kThirds,
        ),
        pack([largest / 3, ...others], [2, 10, 10, 10]),
        pack(
          logScale.map((v) => share(v, from)),
          kThirds,
        ),
        pack([...colors, opacity], [8, 8, 8, 8]),
      ).buffer,
    );
  });
  const coefficients = splats[0]!.sh.length;
  const sh = splats.map((splat) =>
    Buffer.from(
      Array.from({ length: 3 * coefficients }, (_, k) =>
        Math.round(255 * share(splat.sh[k % coefficients]![Math.floor(k / coefficients)]!, -4, 4)),
      ),
    ),
  );
  return Buffer.concat([
    header("binary_little_endian", [
      [
        "chunk",
        Math.ceil(splats.length / 256),
        ["min", "max"].flatMap((end) => names.map((name) => `float ${end}_${name}`)),
      ],
      [
        "vertex",
        splats.length,
        ["position", "rotation", "scale", "color"].map((name) => `uint packed_${name}`),
      ],
      ["sh", splats.length, Array.from({ length: 3 * coefficients }, (_, k) => `uchar f_rest_${k}`)],
    ]),
    ...Array.from({ length: Math.ceil(splats.length / 256) }, (_, k) =>
      floats([...names.map(() => leastOf(256 * k)), ...names.map(() => most)]),
    ),
    ...rows,
    ...sh,
  ]);
}

/** y and z point the other way there. */
export function makeSpz(
  splats: Splat[],
  version: 2 | 3 | 4,
  more: { version?: number; count?: number } = {},
): Buffer {
  const kFraction = 12;
  const mirrored = [1, -1, -1];
  const coefficients = splats[0]!.sh.length;
  const head = Buffer.alloc(16);
  head.writeUInt32LE(0x5053474e, 0);
  head.writeUInt32LE(more.version ?? version, 4);
  head.writeUInt32LE(more.count ?? splats.length, 8);
  head.writeUInt8([0, 3, 8, 15].indexOf(coefficients), 12);
  head.writeUInt8(kFraction, 13);
  const byte = (v: number) => Math.min(255, Math.max(0, Math.round(v)));
  const positions = splats.flatMap(({ mean }) =>
    mean.flatMap((v, c) => {
      const code = Math.round(mirrored[c]! * v * 2 ** kFraction);
      return [code & 255, (code >> 8) & 255, (code >> 16) & 255];
    }),
  );
  const rotations = splats.flatMap(({ rotation: [w, x, y, z] }) => {
    const q = [x!, -y!, -z!, w!];
    if (version === 2) {
      return q.slice(0, 3).map((v) => byte(127.5 * (Math.sign(w!) * v + 1)));
    }
    const largest = q.reduce((best, v, k) => (Math.abs(v) > Math.abs(q[best]!) ? k : best), 0);
    let packed = largest;
    q.forEach((v, k) => {
      if (k !== largest) {
        const negative = v < 0 !== q[largest]! < 0 ? 512 : 0;
        packed = packed * 1024 + negative + Math.round((511 * Math.abs(v)) / Math.SQRT1_2);
      }
    });
    return [...new Uint8Array(Uint32Array.of(packed).buffer)];
  });
  const shSigns = [-1, -1, 1, -1, 1, 1, -1, 1, -1, 1, -1, -1, 1, -1, 1];
  const streams = [
    Buffer.from(positions),
    Buffer.from(splats.map(({ opacity }) => byte(255 * opacity))),
    Buffer.from(splats.flatMap(({ sh0 }) => sh0.map((v) => byte(255 * (0.15 * v + 0.5))))),
    Buffer.from(splats.flatMap(({ logScale }) => logScale.map((v) => byte(16 * (v + 10))))),
    Buffer.from(rotations),
    Buffer.from(
      splats.flatMap(({ sh }) => sh.flatMap((rgb, j) => rgb.map((v) => byte(128 + 128 * shSigns[j]! * v)))),
    ),
  ];
  return version === 4 ? packStreams(head, streams) : gzipSync(Buffer.concat([head, ...streams]));
}

/** As version 4 has them: a table, and each stream by itself. */
function packStreams(head: Buffer, streams: Buffer[]): Buffer {
  const whole = Buffer.concat([head, Buffer.alloc(16)]);
  whole.writeUInt8(streams.length, 15);
  whole.writeUInt32LE(whole.length, 16);
  const packed = streams.map(storeZstd);
  const table = packed.map((bytes, i) => {
    const entry = Buffer.alloc(16);
    entry.writeBigUInt64LE(BigInt(bytes.length), 0);
    entry.writeBigUInt64LE(BigInt(streams[i]!.length), 8);
    return entry;
  });
  return Buffer.concat([whole, ...table, ...packed]);
}

/** A Zstandard frame (RFC 8878) of raw blocks: Node packs none before version 22. */
function storeZstd(bytes: Buffer): Buffer {
  const kBlock = 1 << 17;
  const head = Buffer.alloc(9);
  head.writeUInt32LE(0xfd2fb528, 0);
  head.writeUInt8(0xa0, 4); // one segment, whose size has four bytes
  head.writeUInt32LE(bytes.length, 5);
  const parts: Buffer[] = [head];
  for (let at = 0; at === 0 || at < bytes.length; at += kBlock) {
    const part = bytes.subarray(at, at + kBlock);
    const block = Buffer.alloc(3);
    block.writeUIntLE((part.length << 3) | (at + kBlock >= bytes.length ? 1 : 0), 0, 3);
    parts.push(block, part);
  }
  return Buffer.concat(parts);
}
