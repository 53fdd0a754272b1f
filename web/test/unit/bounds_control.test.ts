import { createGrabPointer, createRayPointer } from "@pmndrs/pointer-events";
import {
  Group,
  type InstancedMesh,
  Matrix4,
  Object3D,
  PerspectiveCamera,
  Quaternion,
  Scene,
  Vector3,
} from "three";
import { expect, it } from "vitest";

import { BoundsControl } from "../../src/xr/bounds_control";

const kMargin = 0.03; // of a box of 0.2 m, on each side

/** A box of 0.2 m around a case at a place of the room, a hand, and frames that go by. */
function stand() {
  const scene = new Scene();
  const anchor = new Group();
  anchor.position.set(0, 1.4, -0.8);
  const body = new Object3D();
  const box = new BoundsControl(anchor, body, (state, target) => {
    target.quaternion.copy(state.current.quaternion);
    target.scale.copy(state.current.scale);
  });
  const half = new Vector3(0.1, 0.1, 0.1);
  box.setBox({ min: half.clone().negate(), max: half });
  anchor.add(box.object);
  const hand = new Group();
  scene.add(anchor, body, hand);
  const camera = new PerspectiveCamera();
  const pointer = createGrabPointer(() => camera, { current: hand }, null, { radius: 0.07 });
  let time = 0;
  const frames = (count: number) => {
    for (let i = 0; i < count; ++i) {
      time += 14;
      scene.updateMatrixWorld();
      pointer.move(scene, { timeStamp: time });
      box.update(time, anchor.scale.x, true);
    }
  };
  const come = () => body.dispatchEvent({ type: "pointerenter", pointerId: 9 } as never);
  const leave = () => body.dispatchEvent({ type: "pointerleave", pointerId: 9 } as never);
  const drag = (from: Vector3, to: Vector3) => {
    hand.position.copy(from);
    frames(3);
    pointer.down({ timeStamp: time, button: 0 });
    for (let i = 1; i <= 5; ++i) {
      hand.position.lerpVectors(from, to, i / 5);
      frames(1);
    }
    pointer.up({ timeStamp: time, button: 0 });
    frames(2);
  };
  const place = (x: number, y: number, z: number) =>
    new Vector3(x, y, z).multiplyScalar(0.1 + 2 * kMargin * 0.1).add(anchor.position);
  return { anchor, box, frames, come, leave, drag, place };
}

it("a box is held by its corners and knobs only while it is seen", () => {
  const { anchor, box, frames, come, leave, drag, place } = stand();
  const corner = place(1, 1, 1);
  const farther = corner.clone().sub(anchor.position).multiplyScalar(1.5).add(anchor.position);
  frames(5);
  drag(corner, farther);
  expect(box.object.visible).toBe(false);
  expect(anchor.scale.x).toBe(1);
  come();
  frames(30);
  expect(box.object.visible).toBe(true);
  drag(corner, farther);
  expect(anchor.scale.x).toBeCloseTo(1.5, 2);
  leave();
  drag(new Vector3(), new Vector3()); // the hand is elsewhere
  frames(200);
  expect(box.object.visible).toBe(false);
});

for (const [axis, at] of [
  ["x", [0, 1, 1]],
  ["y", [1, 0, 1]],
  ["z", [1, 1, 0]],
] as const) {
  it(`a knob of an edge along ${axis} turns the case about it`, () => {
    const { anchor, frames, come, drag, place } = stand();
    const along = new Vector3(axis === "x" ? 1 : 0, axis === "y" ? 1 : 0, axis === "z" ? 1 : 0);
    const turn = new Quaternion().setFromAxisAngle(along, 0.5);
    come();
    frames(30);
    const [x, y, z] = at;
    const knob = place(x, y, z);
    drag(knob, knob.clone().sub(anchor.position).applyQuaternion(turn).add(anchor.position));
    expect(anchor.quaternion.angleTo(turn)).toBeLessThan(0.02);
    expect(anchor.scale.x).toBe(1);
  });
}

it("from afar, a hand that points within a degree of a corner meets it, and lights it up; farther off none", () => {
  const { box, anchor, frames, come, place } = stand();
  come();
  frames(30);
  const eye = new Group();
  eye.position.set(0, 1.6, 1);
  const pointer = createRayPointer(() => new PerspectiveCamera(), { current: eye }, null);
  const meets = (degrees: number) => {
    eye.lookAt(place(1, 1, 1));
    eye.rotateY(Math.PI + (degrees * Math.PI) / 180); // pointers look along −z
    eye.updateMatrixWorld();
    pointer.move(anchor, { timeStamp: 10_000 });
    return pointer.getIntersection()?.instanceId ?? null;
  };
  expect(meets(0.9)).toBe(7);
  frames(1);
  const corners = box.object.children[1] as InstancedMesh;
  const size = (i: number) => {
    const matrix = new Matrix4();
    corners.getMatrixAt(i, matrix);
    return matrix.getMaxScaleOnAxis();
  };
  expect(size(7)).toBeGreaterThan(1.3 * size(0));
  expect(meets(2)).toBeNull();
});
