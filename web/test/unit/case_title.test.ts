import { describe, expect, it } from "vitest";

import { shownTitle } from "../../src/model/case_title";

describe("the title of a case", () => {
  it("is its maker's, whatever the script", () => {
    const look = { title: "Skin", region: "head" };
    for (const title of ["Torso phantom", "Bone, before surgery", "頭部", "صدر", "🧠"]) {
      expect(shownTitle({ title, preset: "skin", look })).toBe(title);
    }
  });

  it("is what is shown and how where nobody gave one, never the look's name alone", () => {
    for (const [title, preset, look, shown] of [
      ["Skin and bone", "skin-and-bone", { title: "Skin and bone", region: "head" }, "Head, skin and bone"],
      ["skin-and-bone", "skin-and-bone", null, "Volume, skin and bone"],
      ["MR", "mr", { title: "MR", modality: "MR" }, "MR volume"],
      ["MR", "mr", null, "Volume, MR"],
      ["", "pet", { title: "PET (hot metal)", modality: "PET" }, "PET volume (hot metal)"],
      ["X-ray", "x-ray", { title: "X-ray", modality: "CT" }, "CT, X-ray"],
      ["Photographs", "photo", { title: "Photographs", modality: "photographs" }, "Photographic volume"],
      [" ", "", null, "Volume"],
    ] as const) {
      expect(shownTitle({ title, preset, look })).toBe(shown);
    }
  });
});
