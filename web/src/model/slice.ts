import { Matrix4, Vector3 } from "three";

import { gridMiddle, type Grid, indexFromPatient } from "./faces";
import { type Plane, signedDistance } from "./geometry";
import type { Place, Size } from "./label_layout";
import { kOrientations, type Orientation } from "./planes";
import { directionLetters } from "./values";

// Slices of a section volume as radiologists look at them: axial from the feet, coronal from the front, sagittal from
// the left. RAS mm, and px of the picture from its top left.

/** The active cut's own plane, upright, and those of the body. */
export const kSliceKinds = ["plane", ...kOrientations] as const;
export type SliceKind = (typeof kSliceKinds)[number];

/** What is shown: a slice, or those of the body beside each other. */
export const kSliceChoices = [...kSliceKinds, "all"] as const;
export type SliceChoice = (typeof kSliceChoices)[number];

/** Slices beside the three-dimensional picture. */
export interface Slices {
  readonly shown: SliceChoice;
  /** Where the crosshair is, through which all slices go. */
  readonly at: Vector3;
  /** Whether the active cut goes through the crosshair, too. */
  readonly linked: boolean;
}

/** Where a picture's right side and its bottom are in the patient, and where one looks: a right-handed basis. */
export interface SliceAxes {
  readonly right: Vector3;
  readonly down: Vector3;
  readonly into: Vector3;
}

const kLeft = new Vector3(-1, 0, 0);
const kPosterior = new Vector3(0, -1, 0);
const kInferior = new Vector3(0, 0, -1);
const kAxesOf: Readonly<Record<Orientation, SliceAxes>> = {
  axial: { right: kLeft, down: kPosterior, into: new Vector3(0, 0, 1) },
  coronal: { right: kLeft, down: kInferior, into: kPosterior },
  sagittal: { right: kPosterior, down: kInferior, into: new Vector3(1, 0, 0) },
};

/** A grid's axis and a slice's are one from this cosine on. */
const kAligned = 0.99999;
/** Of layers: nearer to one, a slice is in it. */
const kInLayer = 1e-3;
/** A plane that is steeper than this to a slice meets it in a line. */
const kParallel = 1e-6;

/**
 * A plane's own section is seen as that of the body's plane it is nearest to, whichever side it keeps: turned by what it
 * is oblique alone.
 */
function axesAlong(normal: Vector3): SliceAxes {
  const across = (name: Orientation) => normal.dot(kAxesOf[name].into);
  const nearest = kOrientations.reduce((best, name) =>
    Math.abs(across(name)) > Math.abs(across(best)) + 1e-9 ? name : best,
  );
  const into = normal.clone().multiplyScalar(across(nearest) < 0 ? -1 : 1);
  const { down } = kAxesOf[nearest];
  const upright = down.clone().addScaledVector(into, -down.dot(into)).normalize();
  return { right: new Vector3().crossVectors(upright, into), down: upright, into };
}

/** Null: of the plane, where nothing is cut. */
export function sliceAxes(kind: SliceKind, cut: Plane | null): SliceAxes | null {
  return kind !== "plane" ? kAxesOf[kind] : cut && axesAlong(cut.normal);
}

/** The slice through a point: what the picture has in its middle, and how large it is. */
export interface SliceFrame extends Size {
  readonly axes: SliceAxes;
  readonly middle: Vector3;
  readonly scale: number; // px a mm
}

export function pointOf({ axes, middle, scale, width, height }: SliceFrame, { x, y }: Place): Vector3 {
  return middle
    .clone()
    .addScaledVector(axes.right, (x - 0.5 * width) / scale)
    .addScaledVector(axes.down, (y - 0.5 * height) / scale);
}

/** Of a point's projection onto the slice. */
export function placeOf({ axes, middle, scale, width, height }: SliceFrame, point: Vector3): Place {
  const from = point.clone().sub(middle);
  return {
    x: 0.5 * width + scale * axes.right.dot(from),
    y: 0.5 * height + scale * axes.down.dot(from),
  };
}

export function planeOf({ axes: { into }, middle }: Pick<SliceFrame, "axes" | "middle">): Plane {
  return { normal: into, offset: into.dot(middle) };
}

/** Picture (px) → voxel index. */
export function indexFromPicture(grid: Grid, { axes, middle, scale, width, height }: SliceFrame): Matrix4 {
  const { right, down, into } = axes;
  const corner = pointOf({ axes, middle, scale, width, height }, { x: 0, y: 0 });
  const patient = new Matrix4()
    .makeBasis(right.clone().divideScalar(scale), down.clone().divideScalar(scale), into)
    .setPosition(corner);
  return indexFromPatient(grid).multiply(patient);
}

/** What a slice has in its middle where all of a grid's box is to be seen, and how large that is at most, px a mm. */
export function fittedTo(
  grid: Grid,
  axes: SliceAxes,
  at: Vector3,
  { width, height }: Size,
): Pick<SliceFrame, "middle" | "scale"> {
  const extent = (direction: Vector3) =>
    grid.axes.reduce((sum, axis, k) => {
      const along = Math.abs(direction.dot(new Vector3(...axis)));
      return sum + along * (grid.dims[k]! - 1) * grid.spacing[k]!;
    }, 0);
  const middle = gridMiddle(grid);
  middle.addScaledVector(axes.into, axes.into.dot(at) - axes.into.dot(middle));
  const fit = (px: number, direction: Vector3) => px / Math.max(extent(direction), 1);
  return { middle, scale: Math.min(fit(width, axes.right), fit(height, axes.down)) };
}

/** Whether one scrolls up along `into` or against it: up, to the front or to the left is where a slice goes then. */
export function scrollsInto({ into }: SliceAxes): 1 | -1 {
  const parts = into.toArray();
  const largest = parts.reduce(
    (best, part, k) => (Math.abs(part) > Math.abs(parts[best]!) + 1e-9 ? k : best),
    0,
  );
  return (largest === 0 ? -parts[0] : parts[largest]!) > 0 ? 1 : -1;
}

/** Between voxels along a direction, mm. */
export function sliceSpacing(grid: Grid, direction: Vector3): number {
  const steps = grid.axes.map((axis, k) => direction.dot(new Vector3(...axis)) / grid.spacing[k]!);
  return 1 / Math.hypot(...steps);
}

/**
 * A point moved by as many slices, within the volume. Along an axis of the grid it comes to lie in a layer of voxels,
 * where nothing is interpolated.
 */
export function movedBySlices(grid: Grid, { into }: SliceAxes, at: Vector3, slices: number): Vector3 {
  const spacing = sliceSpacing(grid, into);
  const k = grid.axes.findIndex((axis) => Math.abs(into.dot(new Vector3(...axis))) > kAligned);
  const [first, last] = depths(grid, into);
  const depth = into.dot(at);
  let to = depth + slices * spacing;
  if (k >= 0) {
    const layer = (depth - first) / spacing;
    const whole = slices > 0 ? Math.floor(layer + kInLayer) : Math.ceil(layer - kInLayer);
    to = first + (whole + slices) * spacing;
  }
  return at.clone().addScaledVector(into, Math.min(last, Math.max(first, to)) - depth);
}

/** Where a grid's box begins and ends along a direction, mm. */
export function depths(grid: Grid, direction: Vector3): [number, number] {
  const middle = direction.dot(gridMiddle(grid));
  const half = grid.axes.reduce((sum, axis, k) => {
    const along = Math.abs(direction.dot(new Vector3(...axis)));
    return sum + 0.5 * along * (grid.dims[k]! - 1) * grid.spacing[k]!;
  }, 0);
  return [middle - half, middle + half];
}

/** Where in the patient the left, right, top and bottom of a picture are. */
export function sliceLetters({ right, down }: SliceAxes): [string, string, string, string] {
  const [left, up] = [right.clone().negate(), down.clone().negate()];
  return [directionLetters(left), directionLetters(right), directionLetters(up), directionLetters(down)];
}

/** Where a plane meets a slice, from edge to edge of the picture; null where it does not. */
export function lineOfPlane(frame: SliceFrame, plane: Plane): [Place, Place] | null {
  const { axes, middle, scale, width, height } = frame;
  const [a, b] = [plane.normal.dot(axes.right), plane.normal.dot(axes.down)];
  const steepness = Math.hypot(a, b);
  if (steepness < kParallel) {
    return null;
  }
  // Of the picture's middle, the nearest point of the line; it goes on across (a, b).
  const away = (-signedDistance(plane, middle) * scale) / steepness;
  const [nx, ny] = [a / steepness, b / steepness];
  const [x, y] = [0.5 * width + away * nx, 0.5 * height + away * ny];
  let [from, to] = [-Infinity, Infinity];
  for (const [start, slope, size] of [
    [x, -ny, width],
    [y, nx, height],
  ] as const) {
    if (Math.abs(slope) < kParallel) {
      if (start < 0 || start > size) {
        return null;
      }
      continue;
    }
    const [one, other] = [-start / slope, (size - start) / slope];
    from = Math.max(from, Math.min(one, other));
    to = Math.min(to, Math.max(one, other));
  }
  const end = (t: number): Place => ({ x: x - t * ny, y: y + t * nx });
  return from < to ? [end(from), end(to)] : null;
}
