import { Matrix4, type Ray, Vector3 } from "three";

import { codeOfVoxel, type Section, type SectionInfo } from "../sog/section";
import { axesIn, type Plane, projectOnto, signedDistance } from "./geometry";

// Where exposed faces are and how rays are marched into them: the twin of src/section/face_rays.cpp.

/** What cut faces are drawn from: the case's section volume, where it has one, or its splats. */
export const kFaceSources = ["volume", "splats"] as const;
export type FaceSource = (typeof kFaceSources)[number];

/** How voxels lie in the patient. */
export type Grid = Pick<SectionInfo, "dims" | "origin" | "spacing" | "axes">;

/** Samples along a ray, from the face inwards. */
export const kTaps = 8;
/** Of the traced volume: what lies deeper is left to the splats. */
const kDepthVoxels = 4;

/** Rounding, mm. */
const kSlack = 1e-6;
/** Of points that rays meet, mm. */
const kTouch = 1e-4;

/** A step of the march, mm: short at the face, where most is seen. */
export interface Step {
  length: number;
  middle: number;
}

function meanSpacing([x, y, z]: Grid["spacing"]): number {
  return Math.cbrt(x * y * z);
}

/** The growth g with first·(g^count − 1)/(g − 1) = sum, for sum ≥ first·count. */
function growth(first: number, count: number, sum: number): number {
  let low = 1;
  let high = 8;
  for (let i = 0; i < 40; ++i) {
    const g = 0.5 * (low + high);
    let reached = 0;
    for (let k = 0, length = first; k < count; ++k, length *= g) {
      reached += length;
    }
    if (reached < sum) {
      low = g;
    } else {
      high = g;
    }
  }
  return low;
}

export function planSteps(section: Pick<SectionInfo, "materials" | "sourceSpacing">, taps = kTaps): Step[] {
  const most = Math.max(...section.materials.extinction);
  const depth = kDepthVoxels * meanSpacing(section.sourceSpacing);
  let length = Math.min(depth / taps, 0.5 / Math.max(most, 1e-6));
  const factor = growth(length, taps, depth);
  const steps: Step[] = [];
  for (let i = 0, at = 0; i < taps; ++i, at += length, length *= factor) {
    steps.push({ length, middle: at + 0.5 * length });
  }
  return steps;
}

/** RAS mm → voxel index. */
export function indexFromPatient({ axes, spacing, origin }: Grid): Matrix4 {
  const [x, y, z] = axes.map((axis, k) => new Vector3(...axis).multiplyScalar(spacing[k]!));
  return new Matrix4()
    .makeBasis(x!, y!, z!)
    .setPosition(...origin)
    .invert();
}

/** Half a mean voxel of the traced volume, mm: matter less deep is lit as the face itself. */
export function surfaceDepth({ sourceSpacing }: Pick<SectionInfo, "sourceSpacing">): number {
  return 0.5 * meanSpacing(sourceSpacing);
}

/** The middle of a section's box, RAS mm. */
export function gridMiddle(grid: Grid): Vector3 {
  const middle = new Vector3(...grid.dims).subScalar(1).multiplyScalar(0.5);
  return middle.applyMatrix4(indexFromPatient(grid).invert());
}

/** The part of a convex polygon that a plane keeps, moved by `slack` mm towards what it removes. */
function clipped(polygon: Vector3[], plane: Plane, slack: number): Vector3[] {
  const result: Vector3[] = [];
  polygon.forEach((a, i) => {
    const b = polygon[(i + 1) % polygon.length]!;
    const da = signedDistance(plane, a) + slack;
    const db = signedDistance(plane, b) + slack;
    if (da >= 0) {
      result.push(a);
    }
    if (da >= 0 !== db >= 0) {
      result.push(a.clone().lerp(b, da / (da - db)));
    }
  });
  return result;
}

/** The sides of a section's box, from the first voxel's centre to the last one's: two planes for each axis. */
function boxSides({ axes, origin, spacing, dims }: Grid): Plane[] {
  return axes.flatMap((axis, k) => {
    const normal = new Vector3(...axis);
    const low = normal.dot(new Vector3(...origin));
    const high = low + (dims[k]! - 1) * spacing[k]!;
    return [
      { normal, offset: low },
      { normal: normal.clone().negate(), offset: -high },
    ];
  });
}

/** The sides at which matter ends only because the volume does: they are faces as those of a cut are. */
export function sectionEnds(section: Section): Plane[] {
  const { dims, materials } = section;
  const hasMatter = (axis: number, at: number): boolean => {
    const first = dims.map((_, k) => (k === axis ? at : 0));
    const last = dims.map((n, k) => (k === axis ? at : n - 1));
    for (let z = first[2]!; z <= last[2]!; ++z) {
      for (let y = first[1]!; y <= last[1]!; ++y) {
        for (let x = first[0]!; x <= last[0]!; ++x) {
          if (materials.extinction[Math.floor(codeOfVoxel(section, x, y, z))]! > 0) {
            return true;
          }
        }
      }
    }
    return false;
  };
  return boxSides(section).filter((_, i) => hasMatter(i >> 1, i % 2 === 0 ? 0 : dims[i >> 1]! - 1));
}

/**
 * The faces that planes expose of what all of them keep of a section's box: for each plane a convex polygon (RAS
 * mm), `margin` mm wider than the face, counterclockwise seen from the removed side, or nothing. What they bound is convex: faces that a camera sees
 * from their removed sides do not overlap in its picture.
 */
export function facePolygons(grid: Grid, planes: readonly Plane[], margin = 0): Vector3[][] {
  const sides = boxSides(grid);
  const middle = gridMiddle(grid);
  const reach = Math.hypot(...grid.dims.map((n, k) => n * grid.spacing[k]!));
  return planes.map((plane, i) => {
    const [u, v] = axesIn(plane.normal); // u × v points to what is kept
    const at = projectOnto(plane, middle);
    const square = [
      [-1, 1],
      [1, 1],
      [1, -1],
      [-1, -1],
    ].map(([a, b]) =>
      at
        .clone()
        .addScaledVector(u, reach * a!)
        .addScaledVector(v, reach * b!),
    );
    const inside = sides.reduce((polygon, side) => clipped(polygon, side, margin + kSlack), square);
    // Of planes that coincide the first has the face.
    return planes.reduce(
      (polygon, other, k) =>
        k === i ? polygon : clipped(polygon, other, margin + (k < i ? -kSlack : kSlack)),
      inside,
    );
  });
}

/** Whether what all planes keep of a section's box reaches to within `slack` mm of a point. */
function isKept(grid: Grid, planes: readonly Plane[], point: Vector3, slack: number): boolean {
  return [...boxSides(grid), ...planes].every((plane) => signedDistance(plane, point) >= -slack);
}

/** Where a ray (RAS mm) meets the face that it sees of those that planes expose; null where it sees none. */
export function faceUnder(grid: Grid, planes: readonly Plane[], ray: Ray): Vector3 | null {
  for (const plane of planes) {
    const slope = plane.normal.dot(ray.direction);
    const distance = -signedDistance(plane, ray.origin) / slope;
    if (slope > 0 && distance > 0) {
      const point = ray.at(distance, new Vector3());
      if (isKept(grid, planes, point, kTouch)) {
        return point;
      }
    }
  }
  return null;
}

/** Whether a point lies within `slack` mm of a face that `eye` sees of those that planes expose (RAS mm). */
export function isOnFace(
  grid: Grid,
  planes: readonly Plane[],
  eye: Vector3,
  point: Vector3,
  slack: number,
): boolean {
  const near = planes.some(
    (plane) => signedDistance(plane, eye) < 0 && Math.abs(signedDistance(plane, point)) <= slack,
  );
  return near && isKept(grid, planes, point, slack);
}
