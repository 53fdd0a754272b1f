import { readFileSync } from "node:fs";
import { Box3, Group, MeshBasicMaterial, Vector3 } from "three";
import { expect, it } from "vitest";

import { leanModel } from "../../vite/lean_models";
import { readGlb } from "../../src/xr/glb";
import { modelOf, modelUrl } from "../../src/xr/input_model";
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

const kFolder = "node_modules/@webxr-input-profiles/assets/dist/profiles";
const kControllers = [
  "generic-trigger-squeeze-thumbstick",
  "htc-vive-focus-3",
  "meta-quest-touch-plus",
  "meta-quest-touch-pro",
  "oculus-touch-v3",
  "pico-4",
  "pico-4u",
  "samsung-galaxyxr",
];

/** As the viewer's bundle has it. */
function bytes(profile: string, side: string): ArrayBuffer {
  const file = leanModel(readFileSync(`${kFolder}/${profile}/${side}.glb`));
  return file.buffer.slice(file.byteOffset, file.byteOffset + file.byteLength) as ArrayBuffer;
}

function model(profile: string, side: string) {
  return modelOf(readGlb(bytes(profile, side)), new MeshBasicMaterial());
}

interface Response {
  componentProperty: "button" | "xAxis" | "yAxis";
  valueNodeName: string;
}

/** What moves of a controller, and by which button or axis, as its profile says. */
function responses(profile: string, side: string): [node: string, kind: "buttons" | "axes", index: number][] {
  const { layouts } = JSON.parse(readFileSync(`${kFolder}/${profile}/profile.json`, "utf8")) as {
    layouts: Record<
      string,
      {
        components: Record<
          string,
          { gamepadIndices: Record<string, number>; visualResponses: Record<string, Response> }
        >;
      }
    >;
  };
  return Object.values(layouts[side]!.components).flatMap(({ gamepadIndices, visualResponses }) =>
    Object.values(visualResponses).map(
      ({ componentProperty, valueNodeName }) =>
        [
          valueNodeName,
          componentProperty === "button" ? "buttons" : "axes",
          gamepadIndices[componentProperty]!,
        ] as [string, "buttons" | "axes", number],
    ),
  );
}

/** A gamepad of which nothing is pressed. */
function gamepad() {
  return {
    buttons: Array.from({ length: 8 }, () => ({ value: 0 })),
    axes: [0, 0, 0, 0],
  } as unknown as Gamepad & { buttons: { value: number }[]; axes: number[] };
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

  for (const profile of kControllers) {
    it(`has a ${side} controller of ${profile}, of which moves what its profile says, as it says`, () => {
      const { object, nodes } = model(profile, side);
      new Group().add(object).updateMatrixWorld(true);
      object.skeleton.update();
      const size = new Box3().setFromObject(object, true).getSize(new Vector3());
      expect(size.length()).toBeGreaterThan(0.1);
      expect(size.length()).toBeLessThan(0.3);
      const parts = movingParts(nodes);
      const expected = responses(profile, side).filter(([node]) => nodes.has(node)); // some have no menu button
      expect(expected.length).toBeGreaterThanOrEqual(5);
      for (const [node, kind, index] of expected) {
        const { share } = parts.find(({ part }) => part.name === node)!; // all that it says moves
        const pad = gamepad();
        expect(share(pad), node).toBe(kind === "buttons" ? 0 : 0.5);
        if (kind === "buttons") {
          pad.buttons[index]!.value = 1;
        } else {
          pad.axes[index] = 1;
        }
        expect(share(pad), node).toBe(1);
      }
    });
  }
}

it("takes the first model that fits what a headset says of its controllers, in its order", () => {
  const url = (profiles: string[], of: object = {}) =>
    modelUrl({ handedness: "left", targetRayMode: "tracked-pointer", profiles, ...of } as XRInputSource);
  const generic = "generic-trigger-squeeze-thumbstick";
  for (const profile of kControllers) {
    expect(url([profile, generic])).toContain(`/${profile}/left.glb`);
  }
  expect(url(["meta-quest-touch-plus-v2", "meta-quest-touch-plus", generic])).toContain(
    "/meta-quest-touch-plus/",
  );
  expect(url(["oculus-touch-v2", "oculus-touch", generic])).toContain("/oculus-touch-v3/");
  expect(url(["maker-next-year", generic])).toContain(`/${generic}/left.glb`);
  expect(url(["maker-next-year", "pico-4", generic], { handedness: "right" })).toContain("/pico-4/right.glb");
  expect(url(["generic-hand-select", "generic-hand"], { hand: {} })).toContain("/generic-hand/left.glb");
  expect(url(["maker-next-year"])).toBeNull();
  expect(url([generic], { handedness: "none" })).toBeNull();
  expect(url([generic], { targetRayMode: "gaze" })).toBeNull();
});

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
