import makeDav1d, { type Dav1d } from "ogv/dist/ogv-decoder-video-av1-wasm.js";

import type { Triple } from "../model/geometry";
import { CaseError } from "./zip";

const kTemporalDelimiter = 2;

/**
 * The slices of a section as AV1 holds them: the luma of frames (src/asset/av1.h). As with images, not by a browser's
 * own decoder: not all have one, and what they decode is read through colours that are not the voxels.
 */
export async function decodeAv1(
  module: WebAssembly.Module,
  stream: Uint8Array,
  [nx, ny, nz]: Triple,
  file: string,
): Promise<Uint8Array> {
  const dav1d = await start(module);
  const voxels = new Uint8Array(nx * ny * nz);
  let z = 0;
  for (const unit of temporalUnits(stream, file)) {
    const frame = decodeFrame(dav1d, unit, file);
    const { cropWidth, cropHeight } = frame.format;
    if (cropWidth !== nx || cropHeight !== ny || z === nz) {
      throw new CaseError(`${file} has other slices than its section says; build the case again`);
    }
    const { bytes, stride } = frame.y;
    for (let y = 0; y < ny; ++y) {
      voxels.set(bytes.subarray(y * stride, y * stride + nx), (z * ny + y) * nx);
    }
    dav1d.recycleFrame(frame);
    ++z;
  }
  if (z !== nz) {
    throw new CaseError(`${file} has other slices than its section says; build the case again`);
  }
  return voxels;
}

async function start(module: WebAssembly.Module): Promise<Dav1d> {
  const dav1d = await makeDav1d({
    videoFormat: {},
    print: () => {},
    printErr: () => {}, // what fails is told by decodeFrame()
    instantiateWasm(imports, receive) {
      void WebAssembly.instantiate(module, imports).then(receive);
      return {};
    },
  });
  await new Promise<void>((done) => dav1d.init(done));
  return dav1d;
}

function decodeFrame(dav1d: Dav1d, unit: Uint8Array, file: string): NonNullable<Dav1d["frameBuffer"]> {
  dav1d.frameBuffer = null;
  try {
    dav1d.processFrame(unit, () => {}); // at once, as its build has no threads
  } catch {
    // A trap: what it was given is broken, or there is no memory.
  }
  if (!dav1d.frameBuffer) {
    throw new CaseError(`${file} cannot be decoded, or there is not enough memory; copy the case again`);
  }
  return dav1d.frameBuffer;
}

/** The parts of a stream that hold a frame to be shown each: what lies between temporal delimiters (AV1, 7.5). */
function* temporalUnits(stream: Uint8Array, file: string): Generator<Uint8Array> {
  let begin = 0;
  for (let at = 0; at < stream.length; ) {
    const { type, end } = readObu(stream, at, file);
    if (type === kTemporalDelimiter && at > begin) {
      yield stream.slice(begin, at);
      begin = at;
    }
    at = end;
  }
  if (stream.length > begin) {
    yield stream.slice(begin);
  }
}

/** Of the unit that begins at `at` its type, and where the next one begins (AV1, 5.3): it states its size. */
function readObu(stream: Uint8Array, at: number, file: string): { type: number; end: number } {
  const header = stream[at]!;
  const hasExtension = (header >> 2) & 1;
  const hasSize = (header >> 1) & 1;
  let next = at + 1 + hasExtension;
  let size = 0;
  for (let bits = 0; bits < 28; bits += 7) {
    const byte = stream[next++] ?? 0;
    size += (byte & 127) << bits;
    if (byte < 128) {
      break;
    }
  }
  const end = next + size;
  if (hasSize === 0 || end > stream.length) {
    throw new CaseError(`${file} cannot be decoded, or there is not enough memory; copy the case again`);
  }
  return { type: (header >> 3) & 15, end };
}
