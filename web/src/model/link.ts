import { Vector3 } from "three";

import { type ClipOperator, kClipOperators } from "../worker/protocol";
import { kBackdrops } from "./backdrop";
import { canDraw, type Cut, makeCut } from "./cut";
import { type FaceSource, kFaceSources } from "./faces";
import type { Triple } from "./geometry";
import { type GreyOpenings, kGreyOpenings } from "./face_style";
import type { Window } from "./grey";
import { isShape, kMostCorners, kMostMarks, makeMark, type Mark, type MarkKind } from "./marks";
import { kRigs } from "./rigs";
import { kSliceChoices, type Slices } from "./slice";
import { type View, viewFrom } from "./view";

/** What can be left out of the picture. */
const kHidden = ["body", "faces", "marks", "handle"] as const;
export type Hidden = (typeof kHidden)[number];

/** What a link to the viewer may hold, as the options of `clipgs render` write it; all of it optional. */
export interface Link {
  case?: string;
  view?: View;
  cuts?: readonly Cut[]; // none: "off"
  /** Of these, the one that is moved, by its index. */
  active?: number;
  /** Of the uniaxial mode, in place of cuts; null: nothing is cut. */
  state?: number | null;
  clip?: ClipOperator;
  section?: FaceSource;
  grey?: number;
  openings?: GreyOpenings;
  /** One of kRigs. */
  rig?: string;
  turn?: number;
  lamp?: Triple;
  window?: Window;
  /** What is not shown. */
  hidden?: readonly Hidden[];
  /** What is marked. */
  marks?: readonly Mark[];
  /** One of kBackdrops. */
  background?: string;
  depthCue?: number;
  /** Beside the picture; where the crosshair is may be missing. */
  slices?: Pick<Slices, "shown" | "linked"> & Partial<Pick<Slices, "at">>;
  /** The case that is beside it. */
  beside?: string;
  /** Fixed size of the picture, px. */
  size?: { width: number; height: number };
}

/** No place, mm, and no value of a volume is beyond this. */
const kMost = 1e9;

/** From `least` to `most` numbers separated by commas, none of them beyond what there can be. */
function numbers(text: string | null, least: number, most: number): number[] | null {
  const values = text?.split(",").map((part) => (part.trim() === "" ? NaN : Number(part))) ?? [];
  const isSound = values.every((value) => Math.abs(value) <= kMost);
  return isSound && values.length >= least && values.length <= most ? values : null;
}

/** `nx,ny,nz,c` of a plane or `nx,ny,nz,c,thickness` of a slab. */
function parseCut(text: string, isSlab: boolean): Cut | null {
  const n = numbers(text, isSlab ? 5 : 4, isSlab ? 5 : 4);
  const normal = new Vector3().fromArray(n ?? [0, 0, 0]);
  if (!n || normal.length() === 0 || (isSlab && n[4]! <= 0)) {
    return null;
  }
  return makeCut(normal, n[3]!, isSlab ? n[4]! : null);
}

/** All planes and slabs, in their order; null where there are none or too many. */
function parseCuts(parameters: URLSearchParams): Cut[] | null {
  const cuts: Cut[] = [];
  for (const [key, text] of parameters) {
    const cut = key === "plane" || key === "slab" ? parseCut(text, key === "slab") : null;
    if (cut) {
      cuts.push(cut);
    }
  }
  return cuts.length > 0 && canDraw(cuts) ? cuts : null;
}

/** Of marks in a link: how many numbers come before their points, and of what kind they are. */
const kMarkKeys: ReadonlyMap<string, { kind: MarkKind; normal: boolean }> = new Map([
  ["pin", { kind: "point", normal: false }],
  ["length", { kind: "length", normal: false }],
  ["angle", { kind: "angle", normal: false }],
  ["region", { kind: "region", normal: true }],
  ["outline", { kind: "outline", normal: true }],
]);

/** A mark without words; null where it is not one. */
function parseMark(key: string, text: string): Mark | null {
  const known = kMarkKeys.get(key);
  const values = known && numbers(text, 3, 3 * (kMostCorners + 1));
  if (!values || values.length % 3 !== 0) {
    return null;
  }
  const points = Array.from({ length: values.length / 3 }, (_, i) => new Vector3().fromArray(values, 3 * i));
  const normal = known.normal ? points.shift()! : null;
  const shape = { kind: known.kind, points, normal: normal?.normalize() ?? null };
  return isShape(shape) && normal?.length() !== 0 ? makeMark(shape) : null;
}

/** `to`, as links had it once, measures from the point before it. */
function joined(last: Mark | undefined, text: string): Mark | null {
  const end = numbers(text, 3, 3);
  if (!end || (last?.kind !== "point" && last?.kind !== "length")) {
    return end && makeMark({ kind: "point", points: [new Vector3().fromArray(end)], normal: null });
  }
  const points = [last.points.at(-1)!, new Vector3().fromArray(end)];
  return makeMark({ kind: "length", points, normal: null });
}

/** All marks, in their order; `name` and `note` are of the one before them. */
function parseMarks(parameters: URLSearchParams): Mark[] {
  const marks: Mark[] = [];
  for (const [key, text] of parameters) {
    const last = marks.at(-1);
    const mark = key === "to" ? joined(last, text) : parseMark(key, text);
    if (mark) {
      marks.splice(key === "to" && last?.kind === "point" ? -1 : marks.length, 1, mark);
    } else if (last && (key === "name" || key === "note")) {
      const words = { name: last.name, note: last.note, [key]: text };
      marks[marks.length - 1] = makeMark(last, words.name, words.note);
    }
  }
  return marks.slice(0, kMostMarks);
}

/**
 * Reads `#case=…&view=az,el[,zoom]&pan=r,a,s&back=mm&state=k|off&plane=nx,ny,nz,c|off&slab=nx,ny,nz,c,t&active=k&clip=…&section=…&grey=…&openings=…&rig=…&turn=…&lamp=r,a,s&window=c,w&hide=…&pin=r,a,s&length=…&angle=…&region=…&outline=…&name=…&note=…&background=…&depth-cue=…&slices=…&cross=r,a,s&beside=…&size=WxH`,
 * planes, slabs and marks any number of times, names and notes after their marks; what is not valid is left out.
 */
export function parseLink(hash: string): Link {
  const parameters = new URLSearchParams(hash.replace(/^#/, ""));
  const link: Link = {};
  const name = parameters.get("case");
  if (name) {
    link.case = name;
  }
  const view = numbers(parameters.get("view"), 2, 3);
  if (view && (view[2] === undefined || view[2] > 0)) {
    link.view = viewFrom(view[0]!, view[1]!, view[2]);
    const pan = numbers(parameters.get("pan"), 3, 3);
    if (pan) {
      link.view.pan.fromArray(pan);
    }
    link.view.back = numbers(parameters.get("back"), 1, 1)?.[0] ?? 0;
  }
  const cuts = parseCuts(parameters);
  const state = parameters.get("state") ?? "";
  if (state === "off" || /^\d{1,5}$/.test(state)) {
    link.state = state === "off" ? null : Number(state);
  } else if (cuts) {
    link.cuts = cuts;
  } else if (parameters.get("plane") === "off") {
    link.cuts = [];
  }
  const active = parameters.get("active") ?? "";
  if (cuts && /^\d$/.test(active) && Number(active) < cuts.length) {
    link.active = Number(active);
  }
  const clip = parameters.get("clip");
  if (clip && clip !== "none" && Object.hasOwn(kClipOperators, clip)) {
    link.clip = clip as ClipOperator;
  }
  const section = kFaceSources.find((name) => name === parameters.get("section"));
  if (section) {
    link.section = section;
  }
  const [grey] = numbers(parameters.get("grey"), 1, 1) ?? [];
  if (grey !== undefined && grey >= 0 && grey <= 1) {
    link.grey = grey;
  }
  const openings = kGreyOpenings.find((name) => name === parameters.get("openings"));
  if (openings) {
    link.openings = openings;
  }
  const rig = parameters.get("rig");
  if (rig && kRigs.has(rig)) {
    link.rig = rig;
  }
  const [turn] = numbers(parameters.get("turn"), 1, 1) ?? [];
  if (turn) {
    link.turn = turn % 360;
  }
  const lamp = numbers(parameters.get("lamp"), 3, 3);
  if (lamp?.some((part) => part !== 0)) {
    link.lamp = [lamp[0]!, lamp[1]!, lamp[2]!];
  }
  const window = numbers(parameters.get("window"), 2, 2);
  if (window && window[1]! > 0) {
    link.window = { center: window[0]!, width: window[1]! };
  }
  const hidden = kHidden.filter((one) => parameters.get("hide")?.split(",").includes(one));
  if (hidden.length > 0) {
    link.hidden = hidden;
  }
  const marks = parseMarks(parameters);
  if (marks.length > 0) {
    link.marks = marks;
  }
  const background = parameters.get("background");
  if (background && kBackdrops.has(background)) {
    link.background = background;
  }
  const [depthCue] = numbers(parameters.get("depth-cue"), 1, 1) ?? [];
  if (depthCue !== undefined && depthCue > 0 && depthCue <= 1) {
    link.depthCue = depthCue;
  }
  const slices = parseSlices(parameters);
  if (slices) {
    link.slices = slices;
  }
  const beside = parameters.get("beside");
  if (beside) {
    link.beside = beside;
  }
  const size = /^(\d{1,4})(?:x(\d{1,4}))?$/.exec(parameters.get("size") ?? "");
  if (size) {
    const width = Number(size[1]);
    const height = Number(size[2] ?? size[1]);
    if (width >= 16 && height >= 16) {
      link.size = { width, height };
    }
  }
  return link;
}

/** `axial` or `axial,unlinked`, and `cross=r,a,s`. */
function parseSlices(parameters: URLSearchParams): Link["slices"] {
  const [kind, unlinked] = parameters.get("slices")?.split(",") ?? [];
  const shown = kSliceChoices.find((one) => one === kind);
  const at = numbers(parameters.get("cross"), 3, 3);
  const point = at && { at: new Vector3().fromArray(at) };
  return shown && { shown, linked: unlinked !== "unlinked", ...point };
}

function rounded(value: number, digits: number): string {
  return String(Number(value.toFixed(digits)));
}

function markParts({ kind, points, normal, name, note }: Mark): string[] {
  const [key] = [...kMarkKeys].find(([, known]) => known.kind === kind)!;
  const values = [
    ...(normal ? normal.toArray().map((v) => rounded(v, 5)) : []),
    ...points.flatMap((point) => point.toArray().map((mm) => rounded(mm, 2))),
  ];
  return [
    `${key}=${values}`,
    ...(name ? [`name=${encodeURIComponent(name)}`] : []),
    ...(note ? [`note=${encodeURIComponent(note)}`] : []),
  ];
}

/** The link's hash, which parseLink reads back to the precision that a picture shows. */
export function formatLink(link: Link): string {
  const parts: string[] = [];
  if (link.case) {
    parts.push(`case=${encodeURIComponent(link.case)}`);
  }
  if (link.view) {
    const { azimuth, elevation, zoom, pan, back } = link.view;
    parts.push(`view=${rounded(azimuth, 2)},${rounded(elevation, 2)},${rounded(zoom, 3)}`);
    if (pan.lengthSq() > 0) {
      parts.push(
        `pan=${pan
          .toArray()
          .map((v) => rounded(v, 2))
          .join(",")}`,
      );
    }
    if (back !== 0) {
      parts.push(`back=${rounded(back, 2)}`);
    }
  }
  if (link.state !== undefined) {
    parts.push(`state=${link.state ?? "off"}`);
  }
  for (const { normal, offset, thickness } of link.cuts ?? []) {
    const place = [...normal.toArray().map((v) => rounded(v, 5)), rounded(offset, 2)].join();
    parts.push(thickness === null ? `plane=${place}` : `slab=${place},${rounded(thickness, 2)}`);
  }
  if (link.cuts?.length === 0) {
    parts.push("plane=off");
  }
  if (link.active) {
    parts.push(`active=${link.active}`);
  }
  if (link.clip) {
    parts.push(`clip=${link.clip}`);
  }
  if (link.section === "splats") {
    parts.push("section=splats");
  }
  if (link.grey) {
    parts.push(`grey=${rounded(link.grey, 2)}`);
  }
  if (link.openings) {
    parts.push(`openings=${link.openings}`);
  }
  if (link.rig) {
    parts.push(`rig=${link.rig}`);
  }
  if (link.turn) {
    parts.push(`turn=${rounded(link.turn, 1)}`);
  }
  if (link.lamp) {
    parts.push(`lamp=${link.lamp.map((v) => rounded(v, 3))}`);
  }
  if (link.window) {
    parts.push(`window=${rounded(link.window.center, 2)},${rounded(link.window.width, 2)}`);
  }
  if (link.hidden?.length) {
    parts.push(`hide=${link.hidden}`);
  }
  for (const mark of link.marks ?? []) {
    parts.push(...markParts(mark));
  }
  if (link.background) {
    parts.push(`background=${link.background}`);
  }
  if (link.depthCue) {
    parts.push(`depth-cue=${rounded(link.depthCue, 2)}`);
  }
  if (link.slices) {
    const { shown, linked, at } = link.slices;
    parts.push(`slices=${shown}${linked ? "" : ",unlinked"}`);
    parts.push(...(at ? [`cross=${at.toArray().map((mm) => rounded(mm, 2))}`] : []));
  }
  if (link.beside) {
    parts.push(`beside=${encodeURIComponent(link.beside)}`);
  }
  if (link.size) {
    parts.push(`size=${link.size.width}x${link.size.height}`);
  }
  return `#${parts.join("&")}`;
}
