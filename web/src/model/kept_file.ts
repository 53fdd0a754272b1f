import { JsonReader } from "../sog/json_reader";
import { CaseError } from "../sog/zip";

// What files of marks and tours have in common: docs/format.md.

const kVersion = 1;
/** Of a file: no page is to wait for more. */
const kMostBytes = 16 * 2 ** 20;

/** A kind of such files. */
export interface FileKind {
  name: string; // "tour"
  list: string; // of what it holds, "stops"
  most: number;
  isNone: string; // of what is no such file, "not a tour"
  all: string; // and what it holds, "a tour"
}

/**
 * What a file of such things of `volume` holds, one by one; `name` is what errors call it. Throws CaseError where it is
 * not one, is of a newer version or of another volume, or holds too many.
 */
export function readKept(
  text: string,
  name: string,
  volume: string,
  { name: kind, list, most, isNone, all }: FileKind,
): JsonReader[] {
  let object: unknown;
  try {
    object = JSON.parse(text);
  } catch {
    throw new CaseError(`${name}: ${isNone}`);
  }
  const reader = new JsonReader(object, kind, { name, remedy: `save the ${kind} again` });
  const version = `clipgs_${kind}`;
  if (!reader.has(version)) {
    throw new CaseError(`${name}: ${isNone}`);
  }
  if (reader.value(version) !== kVersion) {
    throw new CaseError(`${name}: of a version that this viewer does not know; use a newer clipgs`);
  }
  const of = reader.has("volume") ? reader.text("volume") : "";
  if (of !== "" && volume !== "" && of !== volume) {
    throw new CaseError(`${name}: ${all} of another volume; open its case first`);
  }
  const listed = reader.value(list);
  if (Array.isArray(listed) && listed.length > most) {
    throw new CaseError(
      `${name}: holds ${listed.length} ${list}, of which no more than ${most} can be shown`,
    );
  }
  return reader.children(list, most);
}

/** What a person's file of such things says. Throws CaseError where it is too large to be one. */
export async function textOf(file: File): Promise<string> {
  if (file.size > kMostBytes) {
    throw new CaseError(`${file.name}: has more than ${kMostBytes / 2 ** 20} MiB, which no such file has`);
  }
  return file.text();
}

/** What somebody wrote; of other programs it may be longer than is shown, and is not to be cut short. Throws CaseError. */
export function wordsOf(reader: JsonReader, key: string, longest: number): string {
  const words = reader.has(key) ? reader.text(key) : "";
  return words.length <= longest ? words : reader.refuse(key, `has more than ${longest} characters`);
}

/** What a file of such things holds. */
export function formatKept(
  { name, list }: Pick<FileKind, "name" | "list">,
  volume: string,
  items: readonly object[],
): string {
  return JSON.stringify({ [`clipgs_${name}`]: kVersion, volume, [list]: items });
}
