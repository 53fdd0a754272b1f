import { Ray, Vector3 } from "three";
import { describe, expect, it } from "vitest";

import { faceUnder, gridMiddle, isOnFace, sectionEnds } from "../../src/model/faces";
import { planeThrough, signedDistance } from "../../src/model/geometry";
import {
  barLength,
  directionLetters,
  interpolated,
  pointText,
  readSection,
  valueText,
} from "../../src/model/values";
import { makeSection } from "./section_fixture";
import { makeRandom } from "./sog_fixture";

describe("values", () => {
  const point = new Vector3();

  it("are linear between voxels", () => {
    for (const channels of [1, 3]) {
      const section = makeSection({ channels });
      const at = (x: number, y: number, z: number): number => {
        const v = section.voxels.subarray(channels * (x + 5 * (y + 18 * z)));
        return channels === 3 ? 0.2126 * v[0]! + 0.7152 * v[1]! + 0.0722 * v[2]! : v[0]!;
      };
      const sample = (x: number, y: number, z: number) =>
        interpolated(section, new Vector3(x, y, z), (code) => code);
      expect(sample(4, 17, 6)).toBeCloseTo(at(4, 17, 6), 9);
      expect(sample(9, -3, 6)).toBeCloseTo(at(4, 0, 6), 9);
      const lerp = (a: number, b: number, t: number) => a + t * (b - a);
      const between = (z: number) =>
        lerp(lerp(at(1, 2, z), at(2, 2, z), 0.25), lerp(at(1, 3, z), at(2, 3, z), 0.25), 0.5);
      expect(sample(1.25, 2.5, 3.125)).toBeCloseTo(lerp(between(3), between(4), 0.125), 9);
    }
  });

  it("are interpolated as values, not as codes", () => {
    const curve = Array.from({ length: 256 }, (_, code) => code * code);
    const section = makeSection({ curve });
    section.voxels.fill(100);
    section.voxels[1 + 5 * (1 + 18 * 2)] = 200;
    const half = new Vector3(-5, 12, 23).add(
      new Vector3(...section.axes[0]).multiplyScalar(0.5 * section.spacing[0]),
    );
    expect(readSection(section, half)!.value).toBeCloseTo(0.5 * (100 * 100 + 200 * 200), 3);
  });

  it("lie where the grid says, with the error of their band, and not outside or in air", () => {
    const section = makeSection({ value_errors: Array.from({ length: 16 }, (_, band) => band) });
    const voxel = 1 + 5 * (1 + 18 * 2);
    const place = new Vector3(-5, 12, 23); // of voxel (1, 1, 2)
    for (const code of [16, 31, 32, 104, 255]) {
      section.voxels[voxel] = code;
      const { value, error } = readSection(section, place)!;
      expect(value).toBeCloseTo(10 * code - 1000, 3);
      expect(error).toBe(Math.floor(code / 16));
    }
    section.voxels[voxel] = 15;
    expect(readSection(section, place)).toBeNull();
    expect(readSection(makeSection(), new Vector3(-5, 7, 23))).toBeNull();
  });

  it("are said with their error, a digit of it where it is small, and the unit of CT", () => {
    expect(valueText({ point, value: 62.7, error: 4.2, modality: "CT" })).toBe("63 ± 4 HU");
    expect(valueText({ point, value: -62.7, error: 0.95, modality: "CT" })).toBe("\u221263 ± 1 HU");
    expect(valueText({ point, value: -0.2, error: 0.94, modality: "CT" })).toBe("0 ± 0.9 HU");
    expect(valueText({ point, value: 412, error: 12, modality: "MR" })).toBe("412 ± 12");
    expect(pointText(new Vector3(12.34, -4, 88.06))).toBe("R 12.3 A \u22124.0 S 88.1 mm");
  });
});

describe("directions and lengths", () => {
  it("are told by letters of the body, the main ones first", () => {
    expect(directionLetters(new Vector3(0, 0, -1))).toBe("I");
    expect(directionLetters(new Vector3(-0.5, 0.86, 0.1))).toBe("AL");
    expect(directionLetters(new Vector3(0.6, 0.6, -0.53))).toBe("RAI");
  });

  it("are round", () => {
    expect([0.7, 1, 4.9, 5, 73, 280, 9000].map(barLength)).toEqual([1, 1, 2, 5, 50, 200, 500]);
  });
});

describe("faceUnder", () => {
  const section = makeSection();
  section.voxels.fill(100); // every side is a face
  const ends = sectionEnds(section);
  const middle = gridMiddle(section);
  const towards = (from: Vector3, to: Vector3) => new Ray(from, to.clone().sub(from).normalize());

  it("finds where a ray first meets what is kept", () => {
    const plane = planeThrough(new Vector3(0.3, -0.2, 1), middle);
    const random = makeRandom(11);
    for (let i = 0; i < 200; ++i) {
      const from = new Vector3(random() - 0.5, random() - 0.5, random() - 0.5).setLength(200).add(middle);
      const ray = towards(from, middle.clone().addScaledVector(plane.normal, 0.5));
      const found = faceUnder(section, [plane, ...ends], ray)!;
      const distances = [plane, ...ends].map((one) => signedDistance(one, found));
      expect(Math.min(...distances.map(Math.abs))).toBeLessThan(1e-6);
      expect(Math.min(...distances)).toBeGreaterThan(-1e-3);
      const before = ray.at(found.distanceTo(from) - 0.01, new Vector3());
      expect(Math.min(...[plane, ...ends].map((one) => signedDistance(one, before)))).toBeLessThan(0);
    }
  });

  it("finds none beside the volume, behind the camera, or from the kept side", () => {
    const plane = planeThrough(new Vector3(0, 0, 1), middle);
    const above = middle.clone().add(new Vector3(0, 0, 3));
    const below = middle.clone().add(new Vector3(0, 0, -3));
    expect(faceUnder(section, [plane], towards(below, middle))).not.toBeNull();
    expect(faceUnder(section, [plane], towards(above, middle))).toBeNull();
    expect(faceUnder(section, [plane], towards(middle, below))).toBeNull();
    expect(faceUnder(section, [plane], towards(below, middle.clone().add(new Vector3(20, 0, 0))))).toBeNull();
  });
});

describe("isOnFace", () => {
  const section = makeSection();
  const middle = gridMiddle(section);
  const plane = planeThrough(new Vector3(0, 0, 1), middle);
  const above = (mm: number) => middle.clone().add(new Vector3(0, 0, mm));

  it("is true of what is near to a face that is seen", () => {
    const isOn = (eye: Vector3, point: Vector3) => isOnFace(section, [plane], eye, point, 1);
    expect([0, 0.9, -0.9, 1.1, -1.1].map((mm) => isOn(above(-100), above(mm)))).toEqual([
      true,
      true,
      true,
      false,
      false,
    ]);
    expect(isOn(above(100), middle)).toBe(false);
    expect(isOn(above(-100), middle.clone().add(new Vector3(20, 0, 0)))).toBe(false);
  });
});
