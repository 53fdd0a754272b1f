import { readFileSync } from "node:fs";
import { Vector3 } from "three";
import { describe, expect, it } from "vitest";

import { faceDiffuse } from "../../src/model/face_light";
import { kWallSteps } from "../../src/model/face_style";
import {
  facePolygons,
  gridMiddle,
  indexFromPatient,
  planSteps,
  sectionEnds,
  surfaceDepth,
} from "../../src/model/faces";
import { kGreyOpenings } from "../../src/model/face_style";
import { type Plane, planeThrough, signedDistance } from "../../src/model/geometry";
import { kCodes, kFirstInside, type LightRig, parseSection } from "../../src/sog/section";
import { makeSectionBlock, withVoxels } from "./section_fixture";
import { makeRandom } from "./sog_fixture";

const section = parseSection({ section: makeSectionBlock() }, new Map([["section.webp", null]]))!;

/** Points spread evenly over the unit sphere. */
function fibonacciSphere(i: number, count: number): Vector3 {
  const z = 1 - (2 * i + 1) / count;
  const angle = i * Math.PI * (3 - Math.sqrt(5));
  const r = Math.sqrt(1 - z * z);
  return new Vector3(r * Math.cos(angle), r * Math.sin(angle), z);
}

describe("faceDiffuse", () => {
  /** The same by adding up: the sky over the sphere, keys over their discs. */
  function integrated(rig: LightRig, normal: Vector3): Vector3 {
    const sum = new Vector3();
    const kSky = 20000;
    const horizon = new Vector3(...rig.skyHorizon);
    for (let i = 0; i < kSky; ++i) {
      const d = fibonacciSphere(i, kSky);
      const end = new Vector3(...(d.z >= 0 ? rig.skyTop : rig.skyBottom));
      const radiance = horizon.clone().lerp(end, Math.abs(d.z));
      sum.addScaledVector(radiance, ((4 * Math.PI) / kSky) * (Math.max(0, d.dot(normal)) / Math.PI));
    }
    for (const key of rig.keys) {
      const axis = new Vector3(...key.direction);
      const u = new Vector3(axis.y, axis.z, axis.x).cross(axis).normalize();
      const v = new Vector3().crossVectors(axis, u);
      let mean = 0;
      const kDisc = 4000;
      for (let i = 0; i < kDisc; ++i) {
        const cosine = 1 - ((i + 0.5) / kDisc) * (1 - Math.cos(key.angularRadius));
        const sine = Math.sqrt(1 - cosine * cosine);
        const angle = i * Math.PI * (3 - Math.sqrt(5));
        const d = axis.clone().multiplyScalar(cosine);
        d.addScaledVector(u, sine * Math.cos(angle)).addScaledVector(v, sine * Math.sin(angle));
        mean += Math.max(0, d.dot(normal)) / kDisc;
      }
      sum.addScaledVector(new Vector3(...key.radiance), mean);
    }
    return sum;
  }

  it("is the integral over the hemisphere", () => {
    for (let i = 0; i < 60; ++i) {
      const normal = fibonacciSphere(i, 60);
      const truth = integrated(section.rig, normal);
      // What is left: discs are taken as flat.
      expect(faceDiffuse(section.rig, normal).sub(truth).length() / truth.length()).toBeLessThan(0.01);
    }
  });

  it("gives one under a white sky", () => {
    const white: LightRig = { skyTop: [1, 1, 1], skyHorizon: [1, 1, 1], skyBottom: [1, 1, 1], keys: [] };
    expect(faceDiffuse(white, new Vector3(1, 2, 3).normalize()).x).toBeCloseTo(1, 6);
  });
});

describe("planSteps", () => {
  it("grows from the face to four voxels of the traced volume", () => {
    for (const most of [0.01, 1, 3, 60]) {
      const materials = { ...section.materials, extinction: Array(kCodes).fill(most) };
      const steps = planSteps({ materials, sourceSpacing: section.sourceSpacing });
      const depth = 4 * Math.cbrt(0.75);
      expect(steps).toHaveLength(8);
      expect(steps[0]!.length).toBeCloseTo(Math.min(depth / 8, 0.5 / most), 9);
      expect(steps.reduce((sum, step) => sum + step.length, 0)).toBeCloseTo(depth, 5);
      const ratio = steps[1]!.length / steps[0]!.length;
      let at = 0;
      steps.forEach(({ length, middle }, i) => {
        expect(middle).toBeCloseTo(at + 0.5 * length, 9);
        expect(length / steps[0]!.length / ratio ** i).toBeCloseTo(1, 9);
        at += length;
      });
    }
  });
});

describe("a section's grid", () => {
  it("lies where the block says", () => {
    const at = (p: [number, number, number]) => new Vector3(...p).applyMatrix4(indexFromPatient(section));
    expect(at([-4, 10, 20]).length()).toBeCloseTo(0, 9);
    expect(at([-4, 12, 20]).distanceTo(new Vector3(1, 0, 0))).toBeCloseTo(0, 9); // along axis_x
    expect(at([-5, 10, 23]).distanceTo(new Vector3(0, 1, 2))).toBeCloseTo(0, 9);
    expect(gridMiddle(section).toArray()).toEqual([-12.5, 14, 24.5]);
  });

  it("has a surface half a voxel of the traced volume deep, whichever way it looks", () => {
    expect(surfaceDepth(section)).toBeCloseTo(0.5 * Math.cbrt(1 * 0.5 * 1.5));
  });
});

describe("facePolygons", () => {
  const sizes = [8, 17, 9]; // mm along the section's axes
  const isInside = (p: Vector3, margin: number) =>
    p
      .clone()
      .applyMatrix4(indexFromPatient(section))
      .toArray()
      .every((v, k) => v > -margin && v < section.dims[k]! - 1 + margin);

  it("cuts the box by an axial plane", () => {
    const [polygon] = facePolygons(section, [planeThrough(new Vector3(0, 0, -1), new Vector3(0, 0, 22))]);
    expect(polygon).toHaveLength(4);
    for (const corner of polygon!) {
      expect(corner.z).toBeCloseTo(22, 9);
    }
    expect(area(polygon!)).toBeCloseTo(sizes[0]! * sizes[1]!, 3);
    const [u, v] = [polygon![1]!.clone().sub(polygon![0]!), polygon![2]!.clone().sub(polygon![0]!)];
    expect(u.cross(v).z).toBeGreaterThan(0); // counterclockwise from above, which is removed
  });

  it("is empty where a plane misses", () => {
    const planes = [planeThrough(new Vector3(0, 0, -1), new Vector3(0, 0, 40))];
    expect(facePolygons(section, planes)).toEqual([[]]);
  });

  it("has one face where planes coincide, also with a side of the box", () => {
    const plane = planeThrough(new Vector3(0, 0, -1), new Vector3(0, 0, 29)); // the last slice
    const [first, second] = facePolygons(section, [plane, { ...plane }]);
    expect(area(first!)).toBeCloseTo(sizes[0]! * sizes[1]!, 3);
    expect(second).toHaveLength(0);
  });

  it("bounds just what all planes keep", () => {
    const random = makeRandom(3);
    for (let trial = 0; trial < 50; ++trial) {
      const planes = Array.from({ length: 3 }, () => {
        const normal = fibonacciSphere(Math.floor(500 * random()), 500);
        const offset = sizes.map((size) => size * 0.8 * (random() - 0.5));
        return planeThrough(normal, gridMiddle(section).add(new Vector3(...offset)));
      });
      const polygons = facePolygons(section, planes);
      polygons.forEach((polygon, i) => {
        for (const corner of polygon) {
          expect(isInside(corner, 2e-6)).toBe(true);
          expect(signedDistance(planes[i]!, corner)).toBeCloseTo(0, 5);
          expect(Math.min(...planes.map((p) => signedDistance(p, corner)))).toBeGreaterThan(-2e-6);
        }
      });
      // Faces and sides close the kept part: a ray enters it through one face or one side.
      for (let k = 0; k < 40; ++k) {
        const eye = gridMiddle(section).addScaledVector(fibonacciSphere(k, 40), 100);
        const aim = gridMiddle(section).add(new Vector3(random(), random(), random()).multiplyScalar(4));
        const direction = aim.sub(eye).normalize();
        const hits = polygons.filter((polygon, i) => meets(eye, direction, planes[i]!, polygon)).length;
        expect(hits).toBeLessThanOrEqual(1);
      }
    }
  });

  function area(polygon: Vector3[]): number {
    const sum = new Vector3();
    for (let k = 2; k < polygon.length; ++k) {
      const u = polygon[k - 1]!.clone().sub(polygon[0]!);
      sum.add(u.cross(polygon[k]!.clone().sub(polygon[0]!)));
    }
    return 0.5 * sum.length();
  }

  /** Whether a ray enters what is kept through a face. */
  function meets(eye: Vector3, direction: Vector3, plane: Plane, polygon: Vector3[]): boolean {
    const slope = plane.normal.dot(direction);
    if (slope <= 0 || polygon.length === 0) {
      return false;
    }
    const at = eye.clone().addScaledVector(direction, -signedDistance(plane, eye) / slope);
    return polygon.every((corner, i) => {
      const edge = polygon[(i + 1) % polygon.length]!.clone().sub(corner);
      return edge.cross(at.clone().sub(corner)).dot(plane.normal) <= 0;
    });
  }
});

describe("sectionEnds", () => {
  it("are the sides that matter reaches", () => {
    const voxels = new Uint8Array(5 * 18 * 7);
    const at = (x: number, y: number, z: number) => x + 5 * (y + 18 * z);
    voxels[at(2, 9, 3)] = 200;
    expect(sectionEnds(withVoxels(section, voxels))).toEqual([]);
    voxels[at(2, 9, 6)] = 200;
    voxels[at(0, 9, 3)] = 200;
    const ends = sectionEnds(withVoxels(section, voxels));
    expect(ends.map(({ normal }) => normal.toArray().map((v) => v + 0))).toEqual([
      [0, 1, 0],
      [0, 0, -1],
    ]);
    expect(ends.map(({ offset }) => offset)).toEqual([10, -29]);
  });
});

describe("face.glsl", () => {
  it("shares its constants with the C++ program", () => {
    const glsl = readFileSync("src/shaders/face.glsl", "utf8");
    const rays = readFileSync("../src/section/face_rays.h", "utf8");
    const faces = readFileSync("../src/section/faces.h", "utf8");
    const value = (text: string, pattern: RegExp) => pattern.exec(text)![1];
    expect(value(glsl, /kTaps = (\d+)/)).toBe(value(faces, /taps = (\d+)/));
    expect(value(glsl, /kLeastTransmittance = 1\.0 \/ (\d+)/)).toBe(
      value(rays, /kLeastTransmittance = 1\.0f \/ (\d+)/),
    );
    const inside = Number(value(readFileSync("../src/section/section.h", "utf8"), /kFirstInside = (\d+)/));
    expect(kFirstInside).toBe(inside);
    expect(Number(value(glsl, /kLowestInside = (\S+) \/ 255/))).toBe(0.25 * inside);
    expect(Number(value(glsl, /kSurelyInside = (\S+) \/ 255/))).toBe(0.75 * inside);
    const cut = readFileSync("../src/core/cut.h", "utf8");
    expect(value(glsl, /kMaxPlanes = (\d+)/)).toBe(value(cut, /kMostPlanes = (\d+)/));
    const lights = readFileSync("../src/volume/light_rig.h", "utf8");
    expect(value(glsl, /kMaxKeys = (\d+)/)).toBe(value(lights, /kMostKeys = (\d+)/));
    const openings = readFileSync("../src/section/openings.cpp", "utf8");
    expect(kWallSteps.fine).toEqual(
      Object.fromEntries(
        Object.entries({
          search: "kSearch",
          halvings: "kHalvings",
          fine: "kFine",
          growth: "kGrowth",
          count: "kFineSteps",
        }).map(([step, name]) => [step, Number(value(openings, new RegExp(`${name} = ([\\d.]+)`)))]),
      ),
    );
    for (const name of ["kSearchSteps", "kWisp", "kGrazing"]) {
      const number = new RegExp(`${name} = ([\\d.]+)`);
      expect(Number(value(glsl, number)), name).toBe(Number(value(openings, number)));
    }
    expect(value(glsl, /kOpaqueWall = 1\.0 \/ (\d+)/)).toBe(value(openings, /kOpaqueWall = 1\.0f \/ (\d+)/));
    const relight = readFileSync("src/shaders/relight.glsl", "utf8");
    for (const name of ["kDim", "kMostGain"]) {
      const number = new RegExp(`${name} = ([\\d.]+)`);
      expect(Number(value(relight, number)), name).toBe(Number(value(openings, number)));
    }
    const splats = readFileSync("../src/section/relight.cpp", "utf8");
    expect(Number(value(relight, /kBlack = ([\d.]+)/))).toBe(Number(value(splats, /kBlack = ([\d.]+)/)));
    const drawn = readFileSync("../src/section/faces.cpp", "utf8");
    const clay = (text: string) =>
      value(text, /kClay(?: = vec3)?\(([^)]+)\)/)!
        .split(",")
        .map(parseFloat);
    expect(clay(glsl)).toEqual(clay(drawn));
    for (const name of ["kGap", "kClearGap", "kDark"]) {
      const number = new RegExp(`${name} = ([\\d.]+)`);
      expect(Number(value(glsl, number)), name).toBe(Number(value(drawn, number)));
    }
    expect(kGreyOpenings.map((name) => new RegExp(`"${name}"`).test(drawn))).toEqual([true, true, true]);
    expect(kGreyOpenings.indexOf("neutral")).toBe(Number(value(glsl, /kNeutralWalls = (\d)/)));
    expect(kGreyOpenings.indexOf("values")).toBe(Number(value(glsl, /kGapValues = (\d)/)));
    const empty = readFileSync("../src/light/empty_space.h", "utf8");
    const client = readFileSync("src/worker/cut_light.ts", "utf8");
    for (const text of [glsl, client]) {
      expect(value(text, /kBlock = (\d+)/)).toBe(value(empty, /kBlock = (\d+)/));
    }
    expect(Number(value(glsl, /kAround = (\S+);/))).toBe(Number(value(empty, /kAround = (\d+)/)));
  });
});
