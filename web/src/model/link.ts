import { Vector3 } from "three";

import { type ClipOperator, kClipOperators } from "../worker/protocol";
import { kBackdrops } from "./backdrop";
import { canDraw, type Cut, makeCut } from "./cut";
import { type FaceSource, kFaceSources } from "./faces";
import type { Triple } from "./geometry";
import { type GreyOpenings, kGreyOpenings } from "./face_style";
import type { Window } from "./grey";
import type { Pin } from "./pins";
import { kRigs } from "./rigs";
import { type View, viewFrom } from "./view";

/** A marked point, RAS mm; `joined`: measured from the one before it. */
export type LinkPin = Pick<Pin, "point" | "joined">;

/** What a link to the viewer may hold, as the options of `clipgs render` write it; all of it optional. */
export interface Link {
  case?: string;
  view?: View;
  cuts?: readonly Cut[]; // none: "off"
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
  pins?: readonly LinkPin[];
  /** One of kBackdrops. */
  background?: string;
  depthCue?: number;
  /** Fixed size of the picture, px. */
  size?: { width: number; height: number };
}

/** `count` finite numbers separated by commas. */
function numbers(text: string | null, least: number, most: number): number[] | null {
  const values = text?.split(",").map((part) => (part.trim() === "" ? NaN : Number(part))) ?? [];
  return values.length >= least && values.length <= most && values.every(Number.isFinite) ? values : null;
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

/** All pins, in their order. */
function parsePins(parameters: URLSearchParams): LinkPin[] {
  const pins: LinkPin[] = [];
  for (const [key, text] of parameters) {
    const at = key === "pin" || key === "to" ? numbers(text, 3, 3) : null;
    if (at) {
      pins.push({ point: new Vector3().fromArray(at), joined: key === "to" });
    }
  }
  return pins;
}

/**
 * Reads `#case=…&view=az,el[,zoom]&pan=r,a,s&back=mm&state=k|off&plane=nx,ny,nz,c|off&slab=nx,ny,nz,c,t&clip=…&section=…&grey=…&openings=…&rig=…&turn=…&lamp=r,a,s&window=c,w&pin=r,a,s&to=r,a,s&background=…&depth-cue=…&size=WxH`,
 * planes, slabs and pins any number of times; what is not valid is left out.
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
  const pins = parsePins(parameters);
  if (pins.length > 0) {
    link.pins = pins;
  }
  const background = parameters.get("background");
  if (background && kBackdrops.has(background)) {
    link.background = background;
  }
  const [depthCue] = numbers(parameters.get("depth-cue"), 1, 1) ?? [];
  if (depthCue !== undefined && depthCue > 0 && depthCue <= 1) {
    link.depthCue = depthCue;
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

function rounded(value: number, digits: number): string {
  return String(Number(value.toFixed(digits)));
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
  for (const { point, joined } of link.pins ?? []) {
    parts.push(`${joined ? "to" : "pin"}=${point.toArray().map((v) => rounded(v, 2))}`);
  }
  if (link.background) {
    parts.push(`background=${link.background}`);
  }
  if (link.depthCue) {
    parts.push(`depth-cue=${rounded(link.depthCue, 2)}`);
  }
  if (link.size) {
    parts.push(`size=${link.size.width}x${link.size.height}`);
  }
  return `#${parts.join("&")}`;
}
