import type { Vector3 } from "three";

import type { JsonReader } from "../sog/json_reader";
import { texts } from "../text/text";
import type { Cut } from "./cut";
import { type Plane, projectOnto } from "./geometry";
import { planePosition } from "./planes";

/** How the plane moves: along the case's axis from state to state, or freely. */
export const kModes = ["uniaxial", "arbitrary"] as const;
export type Mode = (typeof kModes)[number];

const kSides = ["below", "above"] as const;

/** Of the uniaxial mode: state k's plane is axis·x = first + k·spacing, RAS mm (PlaneStates of src/splat/scene.h). */
export interface PlaneStates {
  axis: Vector3; // unit
  count: number;
  first: number;
  spacing: number;
  keeps: (typeof kSides)[number]; // along the axis
}

const kMostStates = 65536;
const kDefaultCount = 200;
/** Of a case that is flat, mm. */
const kLeastSpacing = 1e-3;

/** Of a case that has none: the twin of PlaneStates::over. */
export function defaultStates(axis: Vector3, [low, high]: readonly [number, number]): PlaneStates {
  const spacing = Math.max((high - low) / kDefaultCount, kLeastSpacing);
  return { axis, count: kDefaultCount, first: low + spacing, spacing, keeps: "below" };
}

/** Reads the `states` block of a case. Throws CaseError. */
export function readStates(reader: JsonReader, axis: Vector3): PlaneStates {
  return {
    axis,
    count: reader.integer("count", 1, kMostStates),
    first: reader.number("first"),
    spacing: reader.number("spacing", Number.MIN_VALUE),
    keeps: kSides.find((side) => side === reader.value("keeps")) ?? reader.fail("keeps"),
  };
}

/** mm along the axis. */
export function statePosition({ first, spacing }: PlaneStates, state: number): number {
  return first + state * spacing;
}

export function stateCut(states: PlaneStates, state: number): Cut {
  const sign = states.keeps === "below" ? -1 : 1;
  const offset = sign * statePosition(states, state);
  return { normal: states.axis.clone().multiplyScalar(sign), offset, thickness: null };
}

/** The layers of a case at a cut (LayerSwitch of src/splat/layer_switch.h). */
export interface LayerSwitch {
  slab: number; // the layer whose slab the plane goes through: its splats are cut
  sign: 1 | -1; // layers are off where sign·(layer − slab) > 0; the others are whole
}

/** A normal along the axis lies within a part of a degree of it. */
const kSameNormal = 0.99999;
/** Steps, for what rounding makes of a state's own plane. */
const kSlack = 1e-3;

/** How `planes` switch layers; null: they do not, for they are not one plane across the axis that keeps what states keep. */
export function switchLayers(
  { axis, first, spacing, keeps }: PlaneStates,
  planes: readonly Plane[],
): LayerSwitch | null {
  const [plane] = planes;
  const below = keeps === "below";
  const sign = below ? 1 : -1;
  if (!plane || planes.length > 1 || -sign * plane.normal.dot(axis) <= kSameNormal) {
    return null;
  }
  const steps = (-sign * plane.offset - first) / spacing;
  const slab = below ? Math.ceil(steps - kSlack) : Math.floor(steps + kSlack);
  return { slab: slab + 0, sign }; // no −0
}

/** The state whose plane is nearest to the point of `plane` that is nearest to `middle`. */
export function nearestState(states: PlaneStates, plane: Plane, middle: Vector3): number {
  const position = projectOnto(plane, middle).dot(states.axis);
  const state = Math.round((position - states.first) / states.spacing);
  return Math.min(states.count - 1, Math.max(0, state));
}

/** "State 57 / 200 · S −12.34 mm", counted from 0 as `clipgs render --state` does. */
export function stateText(states: PlaneStates, state: number): string {
  return texts().plane.state(state, states.count, planePosition(stateCut(states, state), 2));
}
