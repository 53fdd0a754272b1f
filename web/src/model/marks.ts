import { Vector3 } from "three";

import type { Section } from "../sog/section";
import { texts } from "../text/text";
import { type RegionValues, regionArea, regionValues } from "./region";
import { decimal, type Reading, readSection, unitOf, valueText } from "./values";

/** What can be marked. A region is a circle, an outline a polygon; both lie in a face. */
export const kMarkKinds = ["point", "length", "angle", "region", "outline"] as const;
export type MarkKind = (typeof kMarkKinds)[number];

/** How many points make one; of an outline, at least. */
export const kPointsOf: Readonly<Record<MarkKind, number>> = {
  point: 1,
  length: 2,
  angle: 3,
  region: 2,
  outline: 3,
};

/** Whether marks of a kind lie in a face. */
export function isFlat(kind: MarkKind | null): boolean {
  return kind === "region" || kind === "outline";
}

/** Of a case: more could neither be seen nor told apart. */
export const kMostMarks = 500;
/** Of an outline. */
export const kMostCorners = 200;
/** Characters. */
export const kLongestName = 120;
export const kLongestNote = 2000;

/** What somebody marked of a case, RAS mm. */
export interface Mark {
  /** Of what is marked: the same thing is marked once. */
  readonly id: string;
  readonly kind: MarkKind;
  /** A point; both ends; an end, the vertex, the other end; the centre and a point of the rim; the corners. */
  readonly points: readonly Vector3[];
  /** Of the face that a region or an outline lies in, unit; null: of the others. */
  readonly normal: Vector3 | null;
  /** Empty: it has none. */
  readonly name: string;
  readonly note: string;
}

/** Of a mark, what it is and where. */
export type MarkShape = Pick<Mark, "kind" | "points" | "normal">;

/** What a mark says; what cannot be known of it, or is of other kinds, is null. */
export interface Measure {
  value: Reading | null;
  mm: number | null;
  degrees: number | null;
  area: number | null; // mm²
  values: RegionValues | null; // within a region
}

/**
 * What a mark is known by, wherever it is kept: a digest (FNV-1a, twice) of its kind and its points to the hundredth of a
 * mm, as links hold them.
 */
function idOf({ kind, points }: MarkShape): string {
  const text = `${kind} ${points.flatMap((point) => point.toArray().map((mm) => mm.toFixed(2))).join()}`;
  const digest = (basis: number): string => {
    let hash = basis;
    for (let i = 0; i < text.length; ++i) {
      hash = Math.imul(hash ^ text.charCodeAt(i), 16777619);
    }
    return (hash >>> 0).toString(36).padStart(7, "0");
  };
  return digest(2166136261) + digest(84696351);
}

/** A mark of its own. */
export function makeMark(shape: MarkShape, name = "", note = ""): Mark {
  return { id: idOf(shape), ...shape, name: name.slice(0, kLongestName), note: note.slice(0, kLongestNote) };
}

/** Whether as many points as a kind wants are there, and finite. */
export function isShape({ kind, points, normal }: MarkShape): boolean {
  const most = kind === "outline" ? kMostCorners : kPointsOf[kind];
  const flat = isFlat(kind);
  return (
    points.length >= kPointsOf[kind] &&
    points.length <= most &&
    points.every((point) => point.toArray().every(Number.isFinite)) &&
    flat === (normal !== null)
  );
}

/** `section` is that of the case, if it has one. */
export function measure(mark: MarkShape, section: Section | null): Measure {
  const { kind, points } = mark;
  const flat = isFlat(kind);
  return {
    value: kind === "point" && section ? readSection(section, points[0]!) : null,
    mm: kind === "length" ? points[0]!.distanceTo(points[1]!) : null,
    degrees: kind === "angle" ? angle(points[0]!, points[1]!, points[2]!) : null,
    area: flat ? regionArea(mark) : null,
    values: flat && section ? regionValues(mark, section) : null,
  };
}

/** At `vertex`, degrees. */
function angle(from: Vector3, vertex: Vector3, to: Vector3): number {
  const [a, b] = [from, to].map((end) => end.clone().sub(vertex)) as [Vector3, Vector3];
  return a.lengthSq() === 0 || b.lengthSq() === 0 ? 0 : (a.angleTo(b) * 180) / Math.PI;
}

/** "84 mm²", "3.12 cm²" */
function areaText(mm2: number): string {
  return mm2 < 100 ? `${decimal(mm2, 0)} mm²` : `${decimal(mm2 / 100, 2)} cm²`;
}

/** What a mark measures, lengths first: "31.4 mm", "42.3°", "3.12 cm² · mean 45, SD 12 HU", "63 ± 4 HU". */
export function measureText({ value, mm, degrees, area, values }: Measure): string {
  const parts = [
    mm === null ? "" : `${decimal(mm, 1)} mm`,
    degrees === null ? "" : `${decimal(degrees, 1)}°`,
    area === null ? "" : areaText(area),
    values &&
      texts().marks.within(
        decimal(values.mean, 0),
        `${decimal(values.deviation, 0)}${unitOf(values.modality)}`,
      ),
    value && valueText(value),
  ];
  return parts.filter(Boolean).join(" · ");
}

/** A mark by its name and what it measures. */
export function markText({ name }: Mark, measured: Measure): string {
  return [name, measureText(measured)].filter(Boolean).join(" · ");
}

/** With one more, unless it is there or there are as many as there may be: null. */
export function withMark(marks: readonly Mark[], mark: Mark): readonly Mark[] | null {
  const possible = marks.length < kMostMarks && marks.every(({ id }) => id !== mark.id);
  return possible ? [...marks, mark] : null;
}

export function withoutMark(marks: readonly Mark[], id: string): readonly Mark[] {
  return marks.filter((mark) => mark.id !== id);
}

/** With other words about one. */
export function withWords(
  marks: readonly Mark[],
  id: string,
  words: Partial<Pick<Mark, "name" | "note">>,
): readonly Mark[] {
  return marks.map((mark) =>
    mark.id === id
      ? {
          ...mark,
          name: (words.name ?? mark.name).slice(0, kLongestName),
          note: (words.note ?? mark.note).slice(0, kLongestNote),
        }
      : mark,
  );
}

/** Where what is said of a mark belongs to. */
export function anchorOf({ kind, points }: MarkShape): Vector3 {
  if (kind === "angle") {
    return points[1]!;
  }
  if (kind === "region" || kind === "point") {
    return points[0]!;
  }
  const sum = points.reduce((total, point) => total.add(point), new Vector3());
  return sum.divideScalar(points.length);
}

/** Whether a mark is a line through its points, which is to be seen from end to end. */
export function isLine({ kind }: MarkShape): boolean {
  return kind === "length" || kind === "angle";
}

/** Lines through which a mark is drawn, each from point to point. */
export function linesOf(mark: MarkShape): readonly (readonly Vector3[])[] {
  const { kind, points } = mark;
  if (kind === "point") {
    return [];
  }
  if (kind === "region") {
    return [circle(mark)];
  }
  return [kind === "outline" ? [...points, points[0]!] : points];
}

const kCirclePoints = 64;

/** Of a region, its first point again at the end. */
function circle({ points: [center, rim], normal }: MarkShape): Vector3[] {
  const out = rim!.clone().sub(center!);
  return Array.from({ length: kCirclePoints + 1 }, (_, i) =>
    out
      .clone()
      .applyAxisAngle(normal!, (2 * Math.PI * i) / kCirclePoints)
      .add(center!),
  );
}
