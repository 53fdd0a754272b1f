import { describe, expect, it } from "vitest";
import { PerspectiveCamera, Vector3 } from "three";

import type { CaseSummary } from "../../src/model/case_list";
import { groupCases, looksOf } from "../../src/model/looks";
import { formatLink, parseLink } from "../../src/model/link";
import { applyView, reframed, viewFrom } from "../../src/model/view";

function summary(name: string, title: string, volume = "", look = ""): CaseSummary {
  return {
    name,
    title,
    bytes: 1,
    version: "",
    trained: 1,
    preset: "",
    look: volume ? { volume, title: look, description: "" } : null,
    created: "",
    splats: 1,
    file: "",
    thumbnail: null,
    error: null,
  };
}

const names = (cases: CaseSummary[]) =>
  groupCases(cases).map(({ title, looks }) => [title, ...looks.map((look) => look.name)]);

describe("looks of a volume", () => {
  it("stand together where the first of them is, and others alone", () => {
    const cases = [
      summary("a", "Alone"),
      summary("b", "Head, skin", "1", "Skin"),
      summary("c", "Other", "2", "Skin"),
      summary("d", "Head, bone", "1", "Bone"),
      summary("e", "Alone"),
    ];
    expect(names(cases)).toEqual([
      ["Alone", "Alone"],
      ["Head", "Skin", "Bone"],
      ["Other", "Other"],
      ["Alone", "Alone"],
    ]);
    expect(looksOf(cases, "d").map((look) => look.case.name)).toEqual(["b", "d"]);
    for (const name of ["a", "c", "no such", null]) {
      expect(looksOf(cases, name)).toEqual([]);
    }
  });

  it("are called by what tells them apart", () => {
    const of = (...looks: [string, string][]) =>
      names(looks.map(([title, look], i) => summary(`case-${i}`, title, "1", look)))[0];
    expect(of(["Torso", "Skin"], ["Torso", "Bone"])).toEqual(["Torso", "Skin", "Bone"]);
    expect(of(["skin", "Skin"], ["bone", "Bone"])).toEqual(["One volume", "Skin", "Bone"]);
    expect(of(["Draft", "Skin"], ["High", "Skin"])).toEqual(["One volume", "Draft", "High"]);
    expect(of(["Torso", ""], ["Torso", ""])).toEqual(["Torso", "case-0", "case-1"]);
  });

  it("are seen by the same camera, also from a link", () => {
    const [skin, vessels] = [
      { center: new Vector3(1, 2, 3), radius: 180 },
      { center: new Vector3(-20, 30, 60), radius: 70 },
    ];
    const view = { ...viewFrom(33, -20, 1.5), pan: new Vector3(4, 5, 6) };
    const placed = (of: typeof view, sphere: typeof skin) => {
      const camera = new PerspectiveCamera();
      applyView(camera, of, sphere, 400, 300);
      return [...camera.position.toArray(), ...camera.quaternion.toArray(), camera.fov];
    };
    const before = placed(view, skin);
    const there = reframed(view, skin, vessels);
    placed(there, vessels).forEach((value, i) => expect(value).toBeCloseTo(before[i]!, 6));
    // What it turns about stays, too.
    expect(vessels.center.clone().add(there.pan).toArray()).toEqual([5, 7, 9]);
    const linked = parseLink(formatLink({ view: there })).view!;
    placed(linked, vessels).forEach((value, i) => expect(value).toBeCloseTo(before[i]!, 4));
    const back = reframed(there, vessels, skin);
    expect(back.pan.toArray()).toEqual([4, 5, 6]);
    expect(back.back).toBeCloseTo(0);
  });
});
