import { Ray, Vector3 } from "three";
import { expect, it } from "vitest";

import { planeThrough } from "../../src/model/geometry";
import { entry, outside } from "../../src/xr/body_target";

const kAxes = [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)];
/** A cube of 20 mm around the origin. */
const cube = kAxes.flatMap((axis) =>
  [1, -1].map((sign) =>
    planeThrough(axis.clone().multiplyScalar(sign), axis.clone().multiplyScalar(-10 * sign)),
  ),
);
const down = (x: number, z = 50) => new Ray(new Vector3(x, 0, z), new Vector3(0, 0, -1));

it("a body is met where it begins, by rays that do not pass it by", () => {
  const met = entry(cube, down(3))!;
  expect(met.t).toBeCloseTo(40, 6);
  expect(met.plane.normal.z).toBe(-1); // its outside is towards the ray
  expect(entry(cube, down(11))).toBeNull();
  expect(entry(cube, new Ray(new Vector3(0, 0, -50), new Vector3(0, 0, -1))), "behind").toBeNull();
  expect(entry(cube, down(0, 0)), "from within").toBeNull();
});

it("of a cut body what is cut away is not met", () => {
  const cut = [...cube, planeThrough(new Vector3(0, 0, -1), new Vector3(0, 0, 2))]; // keeps what is below
  expect(entry(cut, down(0))!.t).toBeCloseTo(48, 6);
  const side = new Ray(new Vector3(50, 0, 6), new Vector3(-1, 0, 0));
  expect(entry(cube, side)!.t).toBeCloseTo(40, 6);
  expect(entry(cut, side)).toBeNull();
  expect(outside(cut, new Vector3(0, 0, 6)).distance).toBeCloseTo(4, 6);
  expect(outside(cube, new Vector3(0, 0, 6)).distance).toBe(0);
});
