import { readFileSync } from "node:fs";
import { Box3, Group, MeshBasicMaterial, Vector3 } from "three";
import { expect, it } from "vitest";

import { readGlb } from "../../src/xr/glb";
import { modelOf } from "../../src/xr/input_model";
import { movingParts } from "../../src/xr/input_shape";

const kJoints = [
  "wrist",
  ...["metacarpal", "phalanx-proximal", "phalanx-distal", "tip"].map((part) => `thumb-${part}`),
  ...["index", "middle", "ring", "pinky"].flatMap((finger) =>
    ["metacarpal", "phalanx-proximal", "phalanx-intermediate", "phalanx-distal", "tip"].map(
      (part) => `${finger}-finger-${part}`,
    ),
  ),
];

function bytes(profile: string, side: string): ArrayBuffer {
  const file = readFileSync(`node_modules/@webxr-input-profiles/assets/dist/profiles/${profile}/${side}.glb`);
  return file.buffer.slice(file.byteOffset, file.byteOffset + file.byteLength);
}

function model(profile: string, side: string) {
  return modelOf(readGlb(bytes(profile, side)), new MeshBasicMaterial());
}

for (const side of ["left", "right"]) {
  it(`has a ${side} hand that 25 joints move, of a hand's size`, () => {
    const { object, nodes } = model("generic-hand", side);
    expect(object.skeleton.bones.map(({ name }) => name).sort()).toEqual([...kJoints].sort());
    expect(kJoints.every((joint) => nodes.has(joint))).toBe(true);
    new Group().add(object).updateMatrixWorld(true);
    object.skeleton.update();
    const size = new Box3().setFromObject(object, true).getSize(new Vector3()).toArray().sort();
    expect(size[2]).toBeGreaterThan(0.15);
    expect(size[2]).toBeLessThan(0.3);
  });

  it(`has a ${side} controller whose trigger, stick and buttons move`, () => {
    const { object, nodes } = model("meta-quest-touch-plus", side);
    const parts = movingParts(nodes);
    expect(parts.length).toBe(7); // trigger, grip, stick and its two ways, two buttons
    new Group().add(object).updateMatrixWorld(true);
    object.skeleton.update();
    const size = new Box3().setFromObject(object, true).getSize(new Vector3());
    expect(size.length()).toBeGreaterThan(0.1);
    expect(size.length()).toBeLessThan(0.25);
    const gamepad = { buttons: [{ value: 1 }], axes: [0, 0, 1, 0] } as unknown as Gamepad;
    expect(parts.map(({ share }) => share(gamepad)).sort()).toEqual([0, 0, 0, 0, 0.5, 1, 1]);
  });
}

it("does not read what is no model, or is cut off", () => {
  const whole = bytes("generic-hand", "left");
  for (const broken of [
    new ArrayBuffer(0),
    new ArrayBuffer(64),
    whole.slice(0, 4000),
    whole.slice(0, 60_000),
  ]) {
    expect(() => readGlb(broken)).toThrow();
  }
});
