import { Vector3 } from "three";

import type { Cut } from "./cut";
import type { Sphere, Triple } from "./geometry";
import type { Window } from "./grey";
import { anglesOf, type View, viewDirection } from "./view";
import type { ViewerState } from "./viewer_state";

// What is shown on the way from one view to another. The twin of src/tour/flight.cpp: src/tour/flights.json holds both
// to the same numbers.

/** What flies, or is another from the middle of a flight on. */
export type Shown = Omit<ViewerState, "mode" | "active" | "marks" | "tourMarks" | "stops" | "slices">;

/** A plane that is to be seen by nobody stands that far from the body's middle, in radii of its sphere. */
const kOutside = 1.05;
/** Cosine: planes that are turned farther than 120° are others, and not to be turned over in the body. */
const kOther = -0.5;
/** Of a flight to another look, the share in which that comes. */
const kCrossing = 1 / 3;
/** From above or below, as cameraAxes() has it. */
const kPole = 1e-4;

/** Begins and ends without a jerk, on [0, 1]. */
function eased(share: number): number {
  const s = Math.min(1, Math.max(0, share));
  return s * s * s * (10 + s * (6 * s - 15));
}

function mix(from: number, to: number, share: number): number {
  return from + (to - from) * share;
}

/** Degrees, the shorter way round. */
function mixAngle(from: number, to: number, share: number): number {
  const way = (((to - from) % 360) + 540) % 360;
  return from + (way - 180) * share;
}

/** On the sphere, of unit vectors that are not opposite. */
function slerp(from: Vector3, to: Vector3, share: number): Vector3 {
  const angle = Math.acos(Math.min(1, Math.max(-1, from.dot(to))));
  if (angle < 1e-6) {
    return to.clone();
  }
  return new Vector3()
    .addScaledVector(from, Math.sin((1 - share) * angle))
    .addScaledVector(to, Math.sin(share * angle))
    .normalize();
}

/** The angles of what a view shows: from above and below the picture lies as from the front, whatever the azimuth. */
function shownAngles({ azimuth, elevation }: View): Pick<View, "azimuth" | "elevation"> {
  const direction = viewDirection(azimuth, elevation);
  if (Math.hypot(direction.x, direction.y) < kPole) {
    return { azimuth: 0, elevation: direction.z > 0 ? 90 : -90 };
  }
  return Math.abs(elevation) > 90 ? anglesOf(direction) : { azimuth, elevation };
}

/**
 * The camera keeps the patient's head up, so it turns by its two angles: the shortest way over the sphere would lead it
 * over the head, where the picture turns round at once. What is zoomed at comes to the middle steadily, for which what
 * is looked at follows 1/zoom.
 */
function mixView(from: View, to: View, share: number): View {
  const [here, there] = [shownAngles(from), shownAngles(to)];
  const zoomed = Math.log(to.zoom / from.zoom);
  const panned = Math.abs(zoomed) < 1e-6 ? share : Math.expm1(-share * zoomed) / Math.expm1(-zoomed);
  return {
    azimuth: mixAngle(here.azimuth, there.azimuth, share),
    elevation: mix(here.elevation, there.elevation, share),
    zoom: from.zoom * Math.exp(share * zoomed),
    pan: from.pan.clone().lerp(to.pan, panned),
    back: mix(from.back, to.back, share),
  };
}

/** How far a plane is from the middle of the body, towards what it removes. */
function distanceOf({ normal, offset }: Cut, { center }: Sphere): number {
  return normal.dot(center) - offset;
}

function cutAt(normal: Vector3, distance: number, thickness: number | null, { center }: Sphere): Cut {
  return { normal, offset: normal.dot(center) - distance, thickness };
}

/** Of the same normal, and so far outside that it cuts nothing. */
function outside(cut: Cut, sphere: Sphere): Cut {
  const far = Math.max(kOutside * sphere.radius, distanceOf(cut, sphere));
  return cutAt(cut.normal, far, cut.thickness && far + kOutside * sphere.radius, sphere);
}

/** Turns about the middle of the body. */
function mixCut(from: Cut, to: Cut, share: number, sphere: Sphere): Cut {
  const distance = mix(distanceOf(from, sphere), distanceOf(to, sphere), share);
  const thickness = to.thickness && mix(from.thickness!, to.thickness, share);
  return cutAt(slerp(from.normal, to.normal, share), distance, thickness, sphere);
}

/** Whether the one becomes the other on the way. */
function areOne(from: Cut | undefined, to: Cut | undefined): boolean {
  const both = from !== undefined && to !== undefined;
  return both && (from.thickness === null) === (to.thickness === null) && from.normal.dot(to.normal) > kOther;
}

/** Of others, those that were go in the first half, and those that come do in the second: never are they too many. */
function mixCuts(from: readonly Cut[], to: readonly Cut[], share: number, sphere: Sphere): Cut[] {
  const all = share < 0.5 ? from : to;
  return all.map((cut, i) => {
    if (areOne(from[i], to[i])) {
      return mixCut(from[i]!, to[i]!, eased(share), sphere);
    }
    return mixCut(outside(cut, sphere), cut, eased(Math.abs(1 - 2 * share)), sphere);
  });
}

function mixWindow(from: Window | null, to: Window | null, share: number): Window | null {
  return from && to
    ? { center: mix(from.center, to.center, share), width: mix(from.width, to.width, share) }
    : (to ?? from);
}

function mixLamp(from: Triple, to: Triple, share: number): Triple {
  const [a, b] = [new Vector3(...from), new Vector3(...to)];
  return a.dot(b) > kOther ? slerp(a, b, share).toArray() : share < 0.5 ? from : to;
}

/** On the way to another look. */
export interface Crossing {
  /** Of the picture, what the look before still is. */
  before: number;
  /** Of the flight, what is behind. */
  flown: number;
}

/** One look becomes the other before anything moves: both are seen as the view that is left has them. */
export function crossing(share: number): Crossing {
  return {
    before: 1 - eased(share / kCrossing),
    flown: Math.min(1, Math.max(0, (share - kCrossing) / (1 - kCrossing))),
  };
}

/** What is shown after a share of the way, of a body in that sphere. */
export function flight(from: Shown, to: Shown, share: number, sphere: Sphere): Shown {
  if (share <= 0 || share >= 1) {
    return share <= 0 ? from : to;
  }
  const s = eased(share);
  const switched = share < 0.5 ? from : to;
  return {
    ...switched,
    view: mixView(from.view, to.view, s),
    cuts: mixCuts(from.cuts, to.cuts, share, sphere),
    grey: mix(from.grey, to.grey, s),
    window: mixWindow(from.window, to.window, s),
    turn: mixAngle(from.turn, to.turn, s),
    lamp: from.lamp && to.lamp ? mixLamp(from.lamp, to.lamp, s) : switched.lamp,
    depthCue: mix(from.depthCue, to.depthCue, s),
  };
}
