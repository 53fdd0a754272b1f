import { Vector3 } from "three";
import { describe, expect, it } from "vitest";

import { makeCut } from "../../src/model/cut";
import { gridMiddle, indexFromPatient } from "../../src/model/faces";
import { planeThrough, signedDistance } from "../../src/model/geometry";
import {
  depths,
  fittedTo,
  lineOfPlane,
  movedBySlices,
  placeOf,
  planeOf,
  pointOf,
  scrollsInto,
  type SliceAxes,
  sliceAxes,
  type SliceFrame,
  sliceLetters,
  sliceSpacing,
} from "../../src/model/slice";
import { directionLetters, readSection } from "../../src/model/values";
import { ViewerStore } from "../../src/model/viewer_state";
import { drawSlice } from "../../src/render/slice_pixels";
import { makeSection } from "./section_fixture";

const oblique = planeThrough(new Vector3(0.3, -0.5, 0.8), new Vector3(-10, 14, 25));

function frameOf(axes: SliceAxes, at = gridMiddle(makeSection()), width = 40, height = 30): SliceFrame {
  return { axes, ...fittedTo(makeSection(), axes, at, { width, height }), width, height };
}

describe("a slice", () => {
  it("lies as radiologists are used to: from the feet, the front and the left", () => {
    const letters = (kind: Parameters<typeof sliceAxes>[0], normal?: number[]) =>
      sliceLetters(sliceAxes(kind, normal ? planeThrough(new Vector3(...normal), new Vector3()) : null)!);
    expect(letters("axial")).toEqual(["R", "L", "A", "P"]);
    expect(letters("coronal")).toEqual(["R", "L", "S", "I"]);
    expect(letters("sagittal")).toEqual(["A", "P", "S", "I"]);
    // A plane is seen as the nearest of those, whichever side it keeps, and upright.
    expect(letters("plane", [0, 0, -1])).toEqual(["R", "L", "A", "P"]);
    expect(letters("plane", [0, 1, 0])).toEqual(["R", "L", "S", "I"]);
    expect(letters("plane", [-1, 0, 0])).toEqual(["A", "P", "S", "I"]);
    expect(letters("plane", [0.1, 0.2, 1])).toEqual(["R", "L", "A", "P"]);
    expect(letters("plane", [1, 1.2, 0])).toEqual(["RP", "LA", "S", "I"]);
    expect(sliceAxes("plane", null)).toBeNull();
  });

  it("has axes that are a right-handed basis, across the plane", () => {
    for (const normal of [
      oblique.normal,
      oblique.normal.clone().negate(),
      new Vector3(1, 1, 1).normalize(),
    ]) {
      const { right, down, into } = sliceAxes("plane", { normal, offset: 3 })!;
      expect(Math.abs(into.dot(normal))).toBeCloseTo(1, 9);
      expect(right.length()).toBeCloseTo(1, 9);
      expect(right.clone().cross(down).distanceTo(into)).toBeCloseTo(0, 9);
      expect(down.z).toBeLessThanOrEqual(0.6);
    }
  });

  it("has a place for every point, and back", () => {
    const frame = frameOf(sliceAxes("plane", oblique)!);
    const point = pointOf(frame, { x: 3.5, y: 21 });
    expect(signedDistance(planeOf(frame), point)).toBeCloseTo(0, 9);
    expect(placeOf(frame, point).x).toBeCloseTo(3.5, 9);
    expect(placeOf(frame, point.addScaledVector(frame.axes.into, 5)).y).toBeCloseTo(21, 9);
  });

  it("fits the whole volume", () => {
    const section = makeSection();
    const frame = frameOf(sliceAxes("axial", null)!);
    // 5 × 18 voxels of 2 and 1 mm, the first along A: 17 mm across, 8 mm down.
    expect(frame.scale).toBeCloseTo(40 / 17, 9);
    expect(depths(section, new Vector3(0, 0, 1)).map((mm) => mm.toFixed(2))).toEqual(["20.00", "29.00"]);
  });

  it("shows what is read of the section, through the window", () => {
    const window = { center: 300, width: 900 };
    for (const axes of [sliceAxes("plane", oblique)!, sliceAxes("sagittal", null)!]) {
      const section = makeSection();
      const frame = frameOf(axes);
      const pixels = new Uint8ClampedArray(4 * frame.width * frame.height);
      drawSlice(section, window, frame, pixels);
      let read = 0;
      for (let y = 0; y < frame.height; ++y) {
        for (let x = 0; x < frame.width; ++x) {
          const point = pointOf(frame, { x: x + 0.5, y: y + 0.5 });
          const reading = readSection(section, point);
          const at = 4 * (y * frame.width + x);
          if (reading) {
            const shade = 255 * Math.min(1, Math.max(0, (reading.value - 300) / 900 + 0.5));
            expect(Math.abs(pixels[at]! - shade)).toBeLessThanOrEqual(0.51);
            expect([...pixels.subarray(at + 1, at + 4)]).toEqual([pixels[at], pixels[at], 255]);
            ++read;
          } else if (isOutside(point)) {
            expect([...pixels.subarray(at, at + 4)]).toEqual([0, 0, 0, 0]);
          }
        }
      }
      expect(read).toBeGreaterThan(100);
    }
  });

  it("shows photographs in their colours", () => {
    const section = makeSection({ channels: 3, modality: "photographs" });
    const frame = frameOf(sliceAxes("axial", null)!, new Vector3(-5, 12, 23));
    const pixels = new Uint8ClampedArray(4 * frame.width * frame.height);
    drawSlice(section, null, { ...frame, scale: 1000, middle: new Vector3(-5, 12, 23) }, pixels);
    const voxel = 3 * (1 + 5 * (1 + 18 * 2)); // (1, 1, 2) is there
    const middle = 4 * (15 * 40 + 20);
    for (let channel = 0; channel < 3; ++channel) {
      expect(Math.abs(pixels[middle + channel]! - section.voxels[voxel + channel]!)).toBeLessThanOrEqual(1);
    }
  });

  it("is scrolled up to the head, to the front and to the left", () => {
    const up = (kind: Parameters<typeof sliceAxes>[0]) => {
      const axes = sliceAxes(kind, null)!;
      return directionLetters(axes.into.clone().multiplyScalar(scrollsInto(axes)));
    };
    expect([up("axial"), up("coronal"), up("sagittal")]).toEqual(["S", "A", "L"]);
  });

  it("moves from layer to layer of voxels, and no farther than the volume", () => {
    const section = makeSection();
    const axial = sliceAxes("axial", null)!;
    const depth = (from: number, by: number) => movedBySlices(section, axial, new Vector3(1, 2, from), by).z;
    expect(sliceSpacing(section, axial.into)).toBeCloseTo(1.5, 9);
    expect(depth(23, 1)).toBeCloseTo(24.5, 9);
    expect(depth(23.7, 1)).toBeCloseTo(24.5, 9);
    expect(depth(23.7, -1)).toBeCloseTo(23, 9);
    expect(depth(23, -10)).toBeCloseTo(20, 9);
    expect(depth(28, 10)).toBeCloseTo(29, 9);
    const axes = sliceAxes("plane", oblique)!;
    const at = gridMiddle(section);
    const moved = movedBySlices(section, axes, at, 1).sub(at);
    expect(moved.dot(axes.into)).toBeCloseTo(sliceSpacing(section, oblique.normal), 9);
    expect(moved.cross(axes.into).length()).toBeCloseTo(0, 9);
  });

  it("is met by other planes in lines from edge to edge", () => {
    const frame = frameOf(sliceAxes("coronal", null)!);
    const line = lineOfPlane(frame, oblique)!;
    for (const end of line) {
      expect(signedDistance(oblique, pointOf(frame, end))).toBeCloseTo(0, 6);
      const isAtEdge = [end.x, end.x - frame.width, end.y, end.y - frame.height].some(
        (away) => Math.abs(away) < 1e-6,
      );
      expect(isAtEdge).toBe(true);
    }
    expect(lineOfPlane(frame, planeOf(frame))).toBeNull();
    expect(lineOfPlane(frame, { normal: new Vector3(0, 0, 1), offset: 1000 })).toBeNull();
  });
});

describe("the crosshair of slices", () => {
  const store = new ViewerStore();
  const at = () => store.state.slices!.at.toArray();

  it("goes with the active cut, and that with it, while they are linked", () => {
    store.setCuts([makeCut(new Vector3(1, 0, 0), 5, null), makeCut(new Vector3(0, 0, -1), -20, 10)]);
    store.showSlices("axial", { at: new Vector3(1, 2, 3) });
    expect(at()).toEqual([5, 2, 3]);
    store.setCuts(store.state.cuts, 1);
    expect(at()).toEqual([5, 2, 20]);
    store.setCrosshair(new Vector3(7, 8, 9));
    expect(store.cut).toMatchObject({ offset: -9, thickness: 10 });
    expect(store.state.cuts[0]!.offset).toBe(5);
    store.movePlane({ normal: new Vector3(0, 1, 0), offset: 30 });
    expect(at()).toEqual([7, 30, 9]);
  });

  it("goes where it is put, and the cut stays, while they are not", () => {
    store.linkSlices(false);
    store.setCrosshair(new Vector3(1, 2, 3));
    expect(at()).toEqual([1, 2, 3]);
    expect(store.cut!.offset).toBe(30);
    store.linkSlices(true);
    expect(at()).toEqual([1, 30, 3]);
    store.showSlices(null);
    expect(store.state.slices).toBeNull();
  });
});

function isOutside(point: Vector3): boolean {
  const section = makeSection();
  const index = point.clone().applyMatrix4(indexFromPatient(section)).toArray();
  return index.some((v, k) => v < -0.01 || v > section.dims[k]! - 1 + 0.01);
}
