import { Mesh, PlaneGeometry, Vector3 } from "three";
import { expect, it } from "vitest";

import { PointingRay } from "../../src/xr/pointing_ray";

const kFrom = new Vector3(0.2, 1.2, -0.3);
const kEye = new Vector3(0, 1.6, 0);
const kForward = new Vector3(0, 0, -1);

/** The ray on a wall at a distance (m) from the hand that faces `normal`. */
function onWall(distance: number, normal: Vector3, held = false) {
  const pointing = new PointingRay();
  const point = kFrom.clone().addScaledVector(kForward, distance);
  pointing.show(kFrom, kForward, { point, object: new Mesh(new PlaneGeometry()), normal }, kEye, held);
  return { pointing, point };
}

it("a ray ends at what it meets, where a ring lies on it, as large to the eye from near as from afar", () => {
  const angles = [0.5, 2].map((distance) => {
    const { pointing, point } = onWall(distance, new Vector3(0, 0, 1));
    expect(pointing.ray.visible && pointing.reticle.visible).toBe(true);
    expect(pointing.ray.scale.z).toBeCloseTo(distance, 6);
    expect(pointing.reticle.position.distanceTo(point)).toBeLessThan(0.003);
    return pointing.reticle.scale.x / point.distanceTo(kEye);
  });
  expect(angles[0]).toBeCloseTo(angles[1]!, 6);
});

it("the ring lies on what is turned away, and on its side that the hand sees", () => {
  for (const sign of [1, -1]) {
    const normal = new Vector3(1, 0, 1).normalize();
    const { pointing } = onWall(1, normal.clone().multiplyScalar(sign));
    expect(new Vector3(0, 0, 1).applyQuaternion(pointing.reticle.quaternion).distanceTo(normal)).toBeLessThan(
      1e-6,
    );
  }
});

it("where nothing is met a ray goes on without a ring; while something is held both are lit", () => {
  const pointing = new PointingRay();
  pointing.show(kFrom, kForward, null, kEye, false);
  expect(pointing.ray.visible).toBe(true);
  expect(pointing.reticle.visible).toBe(false);
  const wall = new Vector3(0, 0, 1);
  const color = (held: boolean) => onWall(1, wall, held).pointing.ray.material.color.getHex();
  expect(color(true)).not.toBe(color(false));
  pointing.hide();
  expect(pointing.ray.visible).toBe(false);
});
