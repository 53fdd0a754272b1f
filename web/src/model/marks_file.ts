import { Vector3 } from "three";

import type { JsonReader } from "../sog/json_reader";
import { CaseError } from "../sog/zip";
import { changed, type KeptKind } from "./keeper";
import { type FileKind, formatKept, readKept, wordsOf } from "./kept_file";
import {
  isFlat,
  isShape,
  kLongestName,
  kLongestNote,
  kMarkKinds,
  kMostCorners,
  kMostMarks,
  type Mark,
} from "./marks";

// Marks of a case as a file: docs/format.md.

const kFile: FileKind = {
  name: "marks",
  list: "marks",
  most: kMostMarks,
  isNone: "not a file of marks",
  all: "marks",
};
const kLongestId = 40;
const kDigits = 1000; // µm are enough

type Point = Record<number, number>;

/** What a file holds of marks of a volume; "": that is not known. */
export function formatMarks(marks: readonly Mark[], volume: string): string {
  const rounded = (point: Vector3): Point => point.toArray().map((mm) => Math.round(mm * kDigits) / kDigits);
  const all = marks.map(({ id, kind, points, normal, name, note }) => ({
    id,
    kind,
    points: points.map(rounded),
    ...(normal ? { normal: normal.toArray() } : {}),
    ...(name ? { name } : {}),
    ...(note ? { note } : {}),
  }));
  return formatKept(kFile, volume, all);
}

function readMark(reader: JsonReader): Mark {
  const kind = kMarkKinds.find((one) => one === reader.value("kind")) ?? reader.fail("kind");
  const flat = isFlat(kind);
  const listed = reader.value("points");
  if (!Array.isArray(listed) || listed.length > kMostCorners) {
    reader.fail("points");
  }
  const points = listed.map((point: unknown) => {
    const numbers = Array.isArray(point) ? (point as number[]) : [];
    return new Vector3(...(numbers.length === 3 ? numbers : [NaN, NaN, NaN]));
  });
  const normal = flat ? new Vector3(...reader.vector("normal")) : null;
  const mark: Mark = {
    id: reader.text("id").slice(0, kLongestId),
    kind,
    points,
    normal: normal?.normalize() ?? null,
    name: wordsOf(reader, "name", kLongestName),
    note: wordsOf(reader, "note", kLongestNote),
  };
  return isShape(mark) && (normal?.length() ?? 1) > 0.5 ? mark : reader.fail("points");
}

/**
 * Reads marks of `volume`; `name` is what errors call the file. Throws CaseError where it is not one, is of a newer
 * version or of another volume, or holds too many.
 */
export function parseMarks(text: string, name: string, volume: string): Mark[] {
  const marks = readKept(text, name, volume, kFile).map(readMark);
  return [...new Map(marks.map((mark) => [mark.id, mark])).values()];
}

/** All marks of both; of one that both have, that of `newer`. Throws CaseError where they are too many: `name` holds `newer`. */
export function mergedMarks(older: readonly Mark[], newer: readonly Mark[], name: string): Mark[] {
  const all = changed(older, { put: newer, gone: new Set() });
  if (all.length > kMostMarks) {
    throw new CaseError(
      `${name}: with those that are here, ${all.length} marks, of which no more than ${kMostMarks} can be shown`,
    );
  }
  return all;
}

export const kMarksFile: KeptKind<Mark> = {
  name: "marks",
  most: kMostMarks,
  ordered: false,
  format: formatMarks,
  parse: parseMarks,
};
