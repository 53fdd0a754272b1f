import { readdirSync, readFileSync } from "node:fs";
import { afterEach, describe, expect, it } from "vitest";

import { kBackdrops } from "../../src/model/backdrop";
import { inShort, shownTitle, spokenLook } from "../../src/model/case_title";
import { kRigs } from "../../src/model/rigs";
import { german } from "../../src/text/de";
import { speak } from "../../src/text/text";

afterEach(() => speak("en"));

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

  it("is German on German pages, but for what its maker gave", () => {
    speak("de", german);
    for (const [title, preset, look, shown] of [
      [
        "Skin and bone",
        "skin-and-bone",
        { title: "Skin and bone", region: "head" },
        "Kopf, Haut und Knochen",
      ],
      [
        "Head, skin and bone",
        "skin-and-bone",
        { title: "Skin and bone", region: "head" },
        "Kopf, Haut und Knochen",
      ],
      ["MR volume", "mr", { title: "MR", modality: "MR" }, "MR-Volumen"],
      ["", "pet", { title: "PET (hot metal)", modality: "PET" }, "PET-Volumen (heißes Metall)"],
      ["CT, X-ray", "x-ray", { title: "X-ray", modality: "CT" }, "CT, Röntgen"],
      [
        "Photographic volume",
        "photo",
        { title: "Photographs", modality: "photographs" },
        "Volumen aus Fotografien",
      ],
      ["Head, ours", "mine", { title: "Ours", region: "head" }, "Kopf, Ours"],
      ["Torso phantom", "skin", { title: "Skin", region: "trunk" }, "Torso phantom"],
    ] as const) {
      expect(shownTitle({ title, preset, look })).toBe(shown);
    }
    const own = { title: "Skin", description: "Mine." };
    expect(spokenLook(own, "mine")).toEqual(own);
    expect(spokenLook(own, "skin").title).toBe("Haut");
  });

  it("knows every preset in German", () => {
    const presets = readdirSync("../presets").filter((name) => name.endsWith(".json"));
    const known = presets.map((name) => {
      const { title } = JSON.parse(readFileSync(`../presets/${name}`, "utf8")) as { title: string };
      return [name.slice(0, -".json".length), title] as const;
    });
    const told = Object.entries(german.looks).map(([name, [title]]) => [name, title] as const);
    expect(Object.fromEntries(told)).toEqual(Object.fromEntries(known));
  });

  it("has German names for all lights and backgrounds", () => {
    expect(Object.keys(german.light.rigs).sort()).toEqual([...kRigs.keys()].sort());
    expect(Object.keys(german.background.names).sort()).toEqual([...kBackdrops.keys()].sort());
  });

  it("is cut where there is little room, between letters", () => {
    expect(inShort("Head, skin and bone")).toBe("Head, skin and bone");
    expect(inShort("🧠".repeat(500), 4)).toBe("🧠🧠🧠…");
  });
});
