import { CaseError } from "../sog/zip";
import type { Progress } from "./file_cache";

/** What a file of a person's own is, by how it begins: one that is none of them is refused as a case. */
export type FileKind = "case" | "ply" | "spz";

const kPly = [0x70, 0x6c, 0x79];
const kGzip = [0x1f, 0x8b];
const kSpz = [0x4e, 0x47, 0x53]; // "NGS"

export async function kindOf(file: Blob): Promise<FileKind> {
  const head = new Uint8Array(await readBytes(file.slice(0, kPly.length)));
  const begins = (bytes: readonly number[]) => bytes.every((byte, i) => head[i] === byte);
  return begins(kPly) ? "ply" : begins(kGzip) || begins(kSpz) ? "spz" : "case";
}

/** All of it. Throws CaseError. */
export async function readWholeFile(file: Blob, progress: Progress): Promise<Uint8Array> {
  const bytes = new Uint8Array(await readBytes(file));
  progress(bytes.length, bytes.length, bytes);
  return bytes;
}

export async function readBytes(file: Blob): Promise<ArrayBuffer> {
  try {
    return await file.arrayBuffer();
  } catch {
    throw new CaseError("the file cannot be read, or there is not enough memory for it; choose it again");
  }
}
