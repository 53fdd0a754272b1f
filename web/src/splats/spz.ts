import { decompress } from "fzstd";

import { CaseError } from "../sog/zip";
import { readBytes } from "../worker/own_file";
import { makeCloud, requireCount, type SplatCloud } from "./splat_cloud";

const kMagic = 0x5053474e;
const kHeader = 16; // bytes, of gzip's versions, and
const kPackedHeader = 32; // of those whose streams are packed by zstd, each by itself
const kPackedVersion = 4;
const kTableEntry = 16;
const kCoefficients = [0, 3, 8, 15];
/** SPZ's axes are x right, y up, z back. */
const kMirrored = [1, -1, -1] as const;
/** Of the harmonics above degree 0 (shaders/spherical_harmonics.glsl), for y → −y and z → −z. */
const kMirroredSh = [-1, -1, 1, -1, 1, 1, -1, 1, -1, 1, -1, -1, 1, -1, 1];
const kShReach = 255 / 256; // (code − 128) / 128, nearly
const kCodeOfZero = 128;

/** Gives the streams of a scene, one after the other, each of the size that it is to have. */
interface Source {
  take(size: number): Promise<Uint8Array<ArrayBuffer>>;
}

/** The splats of an SPZ file of version 2, 3 or 4. Rejects with CaseError. */
export async function readSpz(file: Blob): Promise<SplatCloud> {
  const begin = new DataView(await readBytes(file.slice(0, kPackedHeader)));
  const isPacked = begin.byteLength === kPackedHeader && begin.getUint32(0, true) === kMagic;
  const gzip = (): Source =>
    new Filler(file.stream().pipeThrough(new DecompressionStream("gzip")).getReader());
  const reader = isPacked ? new PackedStreams(new Uint8Array(await readBytes(file))) : gzip();
  const head = isPacked ? begin : new DataView((await reader.take(kHeader)).buffer);
  const version = head.getUint32(4, true);
  if (head.getUint32(0, true) !== kMagic) {
    throw new CaseError("has no splats: what is packed in it is no SPZ scene");
  }
  if (isPacked ? version !== kPackedVersion : version !== 2 && version !== 3) {
    throw new CaseError(
      `is SPZ of version ${version}, and the viewer reads versions 2 to 4; save it as one of these`,
    );
  }
  const count = head.getUint32(8, true);
  const coefficients = kCoefficients[head.getUint8(12)];
  requireCount(count);
  if (coefficients === undefined) {
    throw new CaseError(`has harmonics of degree ${head.getUint8(12)}, and the viewer knows 0 to 3`);
  }
  const unit = 2 ** -head.getUint8(13);
  const cloud = makeCloud(count, coefficients, kShReach);
  const positions = await reader.take(9 * count);
  const alphas = await reader.take(count);
  const colors = await reader.take(3 * count);
  const scales = await reader.take(3 * count);
  const rotations = await reader.take((version === 2 ? 3 : 4) * count);
  for (let i = 0; i < 3 * count; ++i) {
    const code = positions[3 * i]! | (positions[3 * i + 1]! << 8) | (positions[3 * i + 2]! << 16);
    cloud.means[i] = kMirrored[i % 3]! * unit * ((code << 8) >> 8);
    cloud.logScales[i] = scales[i]! / 16 - 10;
    cloud.sh0[i] = (colors[i]! / 255 - 0.5) / 0.15;
  }
  for (let i = 0; i < count; ++i) {
    cloud.opacities[i] = alphas[i]! / 255;
    const [x, y, z, w] = version === 2 ? rotationOf3(rotations, i) : rotationOf4(rotations, i);
    cloud.rotations.set([w, kMirrored[0] * x, kMirrored[1] * y, kMirrored[2] * z], 4 * i);
  }
  if (cloud.sh) {
    takeSh(cloud.sh.codes, await reader.take(3 * coefficients * count), coefficients);
  }
  return cloud;
}

/** As they are, but for those that change their sign with the axes. */
function takeSh(codes: Uint8Array, stored: Uint8Array, coefficients: number): void {
  for (let i = 0; i < stored.length; ++i) {
    const sign = kMirroredSh[Math.floor(i / 3) % coefficients]!;
    codes[i] = Math.min(255, kCodeOfZero + sign * (stored[i]! - kCodeOfZero));
  }
}

type Quaternion = [x: number, y: number, z: number, w: number];

function rotationOf3(bytes: Uint8Array, i: number): Quaternion {
  const [x, y, z] = [0, 1, 2].map((c) => bytes[3 * i + c]! / 127.5 - 1) as [number, number, number];
  return [x, y, z, Math.sqrt(Math.max(0, 1 - x * x - y * y - z * z))];
}

/** The number of the largest component in two bits, then of each other one nine bits and a sign. */
function rotationOf4(bytes: Uint8Array, i: number): Quaternion {
  let packed = new DataView(bytes.buffer, bytes.byteOffset).getUint32(4 * i, true);
  const largest = packed >>> 30;
  const rotation: Quaternion = [0, 0, 0, 0];
  let square = 0;
  for (let c = 3; c >= 0; --c) {
    if (c !== largest) {
      const size = (Math.SQRT1_2 * (packed & 511)) / 511;
      rotation[c] = packed & 512 ? -size : size;
      square += size * size;
      packed >>>= 10;
    }
  }
  rotation[largest] = Math.sqrt(Math.max(0, 1 - square));
  return rotation;
}

/** Of version 4: a table says how long each stream is, packed and unpacked. */
class PackedStreams implements Source {
  readonly #file: Uint8Array;
  readonly #table: DataView;
  readonly #count: number;
  #stream = 0;
  #at: number;

  constructor(file: Uint8Array) {
    const head = new DataView(file.buffer);
    const table = head.getUint32(16, true);
    this.#count = file[15]!;
    this.#at = table + kTableEntry * this.#count;
    if (table < kPackedHeader || this.#at > file.length) {
      throw damaged();
    }
    this.#file = file;
    this.#table = new DataView(file.buffer, table);
  }

  async take(size: number): Promise<Uint8Array<ArrayBuffer>> {
    const entry = kTableEntry * this.#stream++;
    if (this.#stream > this.#count) {
      throw damaged();
    }
    const packed = Number(this.#table.getBigUint64(entry, true));
    const end = this.#at + packed;
    if (Number(this.#table.getBigUint64(entry + 8, true)) !== size || end > this.#file.length) {
      throw damaged();
    }
    const bytes = new Uint8Array(size);
    try {
      if (decompress(this.#file.subarray(this.#at, end), bytes).length !== size) {
        throw damaged();
      }
    } catch {
      throw damaged();
    }
    this.#at = end;
    return Promise.resolve(bytes);
  }
}

function damaged(): CaseError {
  return new CaseError("is damaged (it does not unpack); copy it again");
}

/** Takes bytes from a stream as they are wanted: what is packed cannot fill more memory than it says. */
class Filler implements Source {
  readonly #reader: ReadableStreamDefaultReader<Uint8Array>;
  #rest: Uint8Array = new Uint8Array(0);

  constructor(reader: ReadableStreamDefaultReader<Uint8Array>) {
    this.#reader = reader;
  }

  async take(size: number): Promise<Uint8Array<ArrayBuffer>> {
    const bytes = new Uint8Array(size);
    let filled = 0;
    while (filled < size) {
      if (this.#rest.length === 0) {
        this.#rest = await this.#next();
      }
      const part = this.#rest.subarray(0, size - filled);
      bytes.set(part, filled);
      filled += part.length;
      this.#rest = this.#rest.subarray(part.length);
    }
    return bytes;
  }

  async #next(): Promise<Uint8Array> {
    let part: ReadableStreamReadResult<Uint8Array>;
    try {
      part = await this.#reader.read();
    } catch {
      throw damaged();
    }
    if (part.done) {
      throw new CaseError("ends too early; copy it again, whole");
    }
    return part.value;
  }
}
