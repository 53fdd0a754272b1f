import { Vector3 } from "three";
import { describe, expect, it } from "vitest";

import { gainAt, readFaceGain } from "../../src/model/face_gain";
import { JsonReader } from "../../src/sog/json_reader";

const coefficients = Array.from({ length: 16 }, (_, k) => [0.01 * k, -0.02 * k, k === 2 ? 0.1 : 0]);
const read = (value: unknown) => readFaceGain(new JsonReader({ face_gain: value }, "clipgs"));

describe("the gain of faces", () => {
  // FaceGain.DependsOnTheNormal of src/splat/scene_file_test.cpp expects the same numbers of the program.
  it("depends on the plane's normal", () => {
    const { x, y, z } = gainAt(read(coefficients), new Vector3(0.48, -0.6, 0.64));
    expect(x).toBeCloseTo(0.938696, 5);
    expect(y).toBeCloseTo(1.134881, 5);
    expect(z).toBeCloseTo(1.031765, 5);
  });

  it("is none where a case has none, and refused where it says nothing", () => {
    const none = readFaceGain(new JsonReader({}, "clipgs"));
    expect(gainAt(none, new Vector3(0, 1, 0)).toArray()).toEqual([1, 1, 1]);
    for (const value of [
      1,
      coefficients.slice(1),
      [...coefficients.slice(1), [1, 2]],
      [...coefficients.slice(1), [1, 2, 99]],
    ]) {
      expect(() => read(value)).toThrow(/face_gain/);
    }
  });
});
