import { Vector3 } from "three";
import { describe, expect, it } from "vitest";

import { besideState, carried } from "../../src/model/beside";
import type { CaseInfo } from "../../src/model/case_info";
import { makeCut } from "../../src/model/cut";
import { cameraDistance, viewFrom } from "../../src/model/view";
import { ViewerStore } from "../../src/model/viewer_state";

function caseOf(volume: string, center: [number, number, number], radius: number): CaseInfo {
  return { volume, sphere: { center: new Vector3(...center), radius } } as CaseInfo;
}

describe("a case beside another", () => {
  const from = caseOf("a", [10, 0, -5], 100);
  const placed = {
    view: { ...viewFrom(20, 30, 2), pan: new Vector3(1, 2, 3) },
    cuts: [makeCut(new Vector3(0, 0, -1), 7, null), makeCut(new Vector3(1, 1, 0), 2, 15)],
  };

  it("has the same camera and planes in the patient, where it is another look", () => {
    const to = caseOf("a", [14, 2, -5], 80);
    const { view, cuts } = carried(placed, from, to);
    expect(cuts).toBe(placed.cuts);
    expect(to.sphere.center.clone().add(view.pan).toArray()).toEqual([11, 2, -2]);
    expect(cameraDistance(view, to.sphere)).toBeCloseTo(cameraDistance(placed.view, from.sphere), 9);
  });

  it("is cut as far from its middle where it is of another volume, or that is not known", () => {
    for (const [one, other] of [
      ["a", "b"],
      ["", ""],
    ] as const) {
      const [here, there] = [caseOf(one, [10, 0, -5], 100), caseOf(other, [30, 4, 5], 50)];
      const { view, cuts } = carried(placed, here, there);
      expect(view).toBe(placed.view);
      cuts.forEach((cut, i) => {
        const before = placed.cuts[i]!;
        const depth = cut.normal.dot(there.sphere.center) - cut.offset;
        expect(depth).toBeCloseTo(before.normal.dot(here.sphere.center) - before.offset, 9);
        expect(cut.thickness).toBe(before.thickness);
      });
      const back = carried({ view, cuts }, there, here);
      expect(back.cuts.map(({ offset }) => offset.toFixed(6))).toEqual(
        placed.cuts.map(({ offset }) => offset.toFixed(6)),
      );
    }
  });

  it("looks alike, but for its own marks, and is cut freely", () => {
    const store = new ViewerStore();
    store.setGrey(0.5);
    store.setLayers({ body: false });
    const given = besideState({ ...store.state, mode: "uniaxial" }, from, caseOf("b", [0, 0, 0], 100));
    expect(given).toMatchObject({ grey: 0.5, layers: { body: false }, mode: "arbitrary" });
    expect(given).not.toHaveProperty("marks");
    expect(given).not.toHaveProperty("slices");
  });
});
