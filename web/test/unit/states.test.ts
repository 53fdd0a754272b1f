import { Vector3 } from "three";
import { describe, expect, it } from "vitest";

import { planeThrough } from "../../src/model/geometry";
import {
  defaultStates,
  nearestState,
  type PlaneStates,
  readStates,
  stateCut,
  statePosition,
  stateText,
  switchLayers,
} from "../../src/model/states";
import { JsonReader } from "../../src/sog/json_reader";

const superior = new Vector3(0, 0, 1);
const block = { count: 50, first: -20, spacing: 2, keeps: "above", file: "layers.webp" };
const read = (changes: object): PlaneStates =>
  readStates(new JsonReader({ ...block, ...changes }, "clipgs.states"), superior);

describe("states", () => {
  it("are read, and refused where they say nothing", () => {
    const { count, first, spacing, keeps } = block;
    expect(read({})).toEqual({ axis: superior, count, first, spacing, keeps });
    for (const [key, value] of [
      ["count", 0],
      ["count", 1.5],
      ["count", 70000],
      ["first", "0"],
      ["spacing", 0],
      ["spacing", -1],
      ["keeps", "both"],
      ["keeps", undefined],
    ] as const) {
      expect(() => read({ [key]: value }), `${key} ${value}`).toThrow(new RegExp(`states\\.${key}`));
    }
  });

  // PlaneStates.OfAScenesExtent of src/splat/scene_file_test.cpp expects the same numbers of the program.
  it("lie at the upper ends of 200 parts of a case that has none", () => {
    const states = defaultStates(superior, [-120.5, 96]);
    expect([states.count, states.keeps]).toEqual([200, "below"]);
    expect(states.spacing).toBeCloseTo(1.0825, 10);
    expect(statePosition(states, 0)).toBeCloseTo(-119.4175, 10);
    expect(statePosition(states, 199)).toBeCloseTo(96, 10);
    expect(nearestState(defaultStates(superior, [5, 5]), stateCut(states, 3), new Vector3())).toBe(0);
  });

  it("keep what is below or above", () => {
    const below = stateCut({ ...read({}), keeps: "below" }, 4);
    expect([below.normal.z, below.offset]).toEqual([-1, 12]);
    const above = stateCut(read({}), 4);
    expect([above.normal.z, above.offset, above.thickness]).toEqual([1, -12, null]);
  });

  it("are found again by their planes, along any axis", () => {
    const axis = new Vector3(0.36, -0.48, 0.8);
    const middle = new Vector3(30, -7, 12);
    for (const keeps of ["below", "above"] as const) {
      const states: PlaneStates = { axis, count: 200, first: -31.7, spacing: 0.31, keeps };
      for (let state = 0; state < states.count; ++state) {
        expect(nearestState(states, stateCut(states, state), middle)).toBe(state);
      }
      const between = planeThrough(axis, axis.clone().multiplyScalar(-31.7 + 0.31 * 40.4));
      expect(nearestState(states, between, middle)).toBe(40);
    }
  });

  it("are nearest to the middle of planes that are oblique, and no more than there are", () => {
    const states = read({});
    const middle = new Vector3(100, 0, 5.5);
    const through = (z: number) => planeThrough(new Vector3(0.1, 0.2, -1), new Vector3(100, 0, z));
    expect(nearestState(states, through(5.5), middle)).toBe(13);
    expect(nearestState(states, through(-300), middle)).toBe(0);
    expect(nearestState(states, through(300), middle)).toBe(49);
    expect(nearestState(states, planeThrough(new Vector3(1, 0, 0), new Vector3()), middle)).toBe(13);
  });

  // LayerSwitch of src/splat/layer_switch_test.cpp holds the program to the same.
  it("switch layers at planes along the axis that keep what they keep, and at no others", () => {
    const axis = new Vector3(0.36, -0.48, 0.8);
    for (const keeps of ["below", "above"] as const) {
      const states: PlaneStates = { axis, count: 200, first: -31.7, spacing: 0.31, keeps };
      const sign = keeps === "below" ? 1 : -1;
      for (let state = 0; state < states.count; ++state) {
        const cut = stateCut(states, state);
        const moved = (steps: number) => ({ ...cut, offset: cut.offset + steps * states.spacing });
        expect(switchLayers(states, [cut])).toEqual({ slab: state, sign });
        expect(switchLayers(states, [moved(0.5)])?.slab, "into what is kept").toBe(state);
        expect(switchLayers(states, [moved(1.1)])?.slab).toBe(state - sign);
        expect(switchLayers(states, [moved(-0.1)])?.slab).toBe(state + sign);
      }
      const { normal, offset } = stateCut(states, 20);
      const back = { normal: normal.clone().negate(), offset: -offset };
      const oblique = {
        normal: normal
          .clone()
          .add(new Vector3(0.02, 0, 0))
          .normalize(),
        offset,
      };
      for (const planes of [[], [back], [oblique], [{ normal, offset }, oblique]]) {
        expect(switchLayers(states, planes)).toBeNull();
      }
    }
  });

  it("are said with their numbers", () => {
    expect(stateText(read({}), 7)).toBe("State 7 / 50 · S \u22126.00 mm");
  });
});
