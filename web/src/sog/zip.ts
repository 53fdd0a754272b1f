/** An error with one line for a person: what is wrong with which case. */
export class CaseError extends Error {
  override name = "CaseError";
}

const kEndSignature = 0x06054b50;
const kCentralSignature = 0x02014b50;
export const kLocalSignature = 0x04034b50;
const kEndSize = 22;
const kMaxComment = 0xffff;

export const kStored = 0;
const kDeflated = 8;
export const kMaxEntries = 256;
const kMaxTotal = 1 << 30; // bytes

/** Files by their names. */
export type Archive = Pick<ReadonlyMap<string, Uint8Array>, "get" | "has">;

/**
 * Entries of a ZIP archive by name, stored (as SOG writes them) or deflated (as other tools repack them). Every
 * offset is checked against the archive before use, and every entry against its CRC-32. Throws CaseError, also on more
 * than 256 entries, more than 1 GiB of them and a name that is there twice, as read_zip() of src/asset/zip.h does.
 */
export async function readZip(archive: Uint8Array): Promise<Map<string, Uint8Array>> {
  const view = new DataView(archive.buffer, archive.byteOffset, archive.byteLength);
  const end = findEnd(view);
  const count = view.getUint16(end + 10, true);
  if (count > kMaxEntries) {
    throw new CaseError(`the archive holds more than ${kMaxEntries} files; is it a case?`);
  }
  let at = view.getUint32(end + 16, true);
  let room = kMaxTotal;
  const entries = new Map<string, Uint8Array>();
  for (let i = 0; i < count; ++i) {
    if (at + 46 > end || view.getUint32(at, true) !== kCentralSignature) {
      throw new CaseError("the archive's directory is damaged; copy the file again");
    }
    const method = view.getUint16(at + 10, true);
    const crc = view.getUint32(at + 16, true);
    const packedSize = view.getUint32(at + 20, true);
    const size = view.getUint32(at + 24, true);
    const nameLength = view.getUint16(at + 28, true);
    const next = at + 46 + nameLength + view.getUint16(at + 30, true) + view.getUint16(at + 32, true);
    if (next > end) {
      throw new CaseError("the archive's directory is damaged; copy the file again");
    }
    const name = new TextDecoder().decode(archive.subarray(at + 46, at + 46 + nameLength));
    if (entries.has(name)) {
      throw new CaseError(`the archive holds "${name}" twice; the file is corrupt`);
    }
    if (size > room) {
      throw new CaseError(`the archive holds more than ${kMaxTotal >> 20} MiB; no case is that large`);
    }
    room -= size;
    if (method !== kStored && method !== kDeflated) {
      throw new CaseError(`${name} is packed in a way that SOG does not use; pack the case again`);
    }
    let data = entryData(view, archive, view.getUint32(at + 42, true), packedSize, name);
    if (method === kDeflated) {
      data = await inflate(data, size, name);
    }
    if (data.length !== size || crc32(data) !== crc) {
      throw new CaseError(`${name} is damaged (its checksum differs); copy the file again`);
    }
    entries.set(name, data);
    at = next;
  }
  return entries;
}

function findEnd(view: DataView): number {
  const last = view.byteLength - kEndSize;
  for (let at = last; at >= 0 && at >= last - kMaxComment; --at) {
    if (view.getUint32(at, true) === kEndSignature) {
      return at;
    }
  }
  const isZip = view.byteLength >= 4 && view.getUint32(0, true) === kLocalSignature;
  throw new CaseError(
    isZip
      ? "the file ends too early; copy it again, whole"
      : "this is not a SOG file (no ZIP archive); choose a case made by clipgs build or pack",
  );
}

function entryData(
  view: DataView,
  archive: Uint8Array,
  local: number,
  size: number,
  name: string,
): Uint8Array {
  if (local + 30 > view.byteLength || view.getUint32(local, true) !== kLocalSignature) {
    throw new CaseError(`${name} is not where the archive's directory says; copy the file again`);
  }
  const begin = local + 30 + view.getUint16(local + 26, true) + view.getUint16(local + 28, true);
  if (begin + size > view.byteLength) {
    throw new CaseError(`${name} is cut off; copy the file again, whole`);
  }
  return archive.subarray(begin, begin + size);
}

/** Stops at `size` bytes: a small archive cannot unpack to a large memory. */
async function inflate(packed: Uint8Array, size: number, name: string): Promise<Uint8Array> {
  const bytes = new Uint8Array(size);
  let filled = 0;
  try {
    const stream = new Blob([packed as BlobPart])
      .stream()
      .pipeThrough(new DecompressionStream("deflate-raw"));
    const reader = stream.getReader();
    for (let part = await reader.read(); !part.done; part = await reader.read()) {
      bytes.set(part.value, filled); // throws a RangeError beyond the end
      filled += part.value.length;
    }
  } catch {
    throw new CaseError(`${name} is damaged (it does not unpack); copy the file again`);
  }
  return bytes.subarray(0, filled);
}

/** Of the bytes 0 to 255, each followed by as many zeros as the table's index. */
const kCrcTables = (() => {
  const tables = Array.from({ length: 4 }, () => new Uint32Array(256));
  for (let i = 0; i < 256; ++i) {
    let c = i;
    for (let k = 0; k < 8; ++k) {
      c = c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1;
    }
    tables[0]![i] = c;
  }
  for (let t = 1; t < 4; ++t) {
    for (let i = 0; i < 256; ++i) {
      const c = tables[t - 1]![i]!;
      tables[t]![i] = (c >>> 8) ^ tables[0]![c & 255]!;
    }
  }
  return tables as [Uint32Array, Uint32Array, Uint32Array, Uint32Array];
})();

export function crc32(bytes: Uint8Array): number {
  const [zero, one, two, three] = kCrcTables;
  const whole = bytes.length & ~3;
  let c = 0xffffffff;
  let i = 0;
  for (; i < whole; i += 4) {
    c ^= bytes[i]! | (bytes[i + 1]! << 8) | (bytes[i + 2]! << 16) | (bytes[i + 3]! << 24);
    c = three[c & 255]! ^ two[(c >>> 8) & 255]! ^ one[(c >>> 16) & 255]! ^ zero[c >>> 24]!;
  }
  for (; i < bytes.length; ++i) {
    c = zero[(c ^ bytes[i]!) & 255]! ^ (c >>> 8);
  }
  return ~c >>> 0;
}
