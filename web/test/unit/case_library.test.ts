import { afterEach, describe, expect, it } from "vitest";

import {
  type CaseOrder,
  dateText,
  detailText,
  findCases,
  libraryCases,
  pageOf,
  searchCases,
  sortCases,
} from "../../src/model/case_library";
import type { CaseSummary } from "../../src/model/case_list";
import { german } from "../../src/text/de";
import { speak, texts } from "../../src/text/text";

function summary(name: string, title: string, more: Partial<CaseSummary> = {}): CaseSummary {
  return {
    name,
    title,
    bytes: 1_000_000,
    version: "",
    trained: 1,
    preset: "",
    look: null,
    created: "",
    splats: 1,
    file: `cases/${name}.sog`,
    thumbnail: null,
    error: null,
    ...more,
  };
}

const look = (region: string, title: string, modality = "CT", volume = "") => ({
  volume,
  title,
  description: "",
  modality,
  region,
});

const kCases = [
  summary("knee", "Meniskus, Größe 2", { look: look("knee", "Bone", "MR"), created: "2026-02-01" }),
  summary("a-10", "Case 10", { look: look("head", "Skin and bone"), created: "2026-03-05", bytes: 5e6 }),
  summary("a-2", "case 2", { look: look("chest", "Lung"), created: "2025-12-31", bytes: 2e6 }),
  summary("old", "Ähre", { preset: "soft-tissue" }),
];

const found = (search: string) => searchCases(kCases, search).map(({ name }) => name);
const sorted = (order: CaseOrder) => sortCases(kCases, order).map(({ name }) => name);

describe("the library", () => {
  afterEach(() => speak("en"));

  it("finds cases by title, file name, region, modality and look, whatever capitals and accents", () => {
    expect(found("")).toEqual(["knee", "a-10", "a-2", "old"]);
    expect(found("MENISKUS")).toEqual(["knee"]);
    expect(found("grosse")).toEqual(["knee"]);
    expect(found("GRÖẞE")).toEqual(["knee"]);
    expect(found("ahre")).toEqual(["old"]);
    expect(found("a-2.sog")).toEqual(["a-2"]);
    expect(found("chest")).toEqual(["a-2"]);
    expect(found("mr")).toEqual(["knee"]);
    expect(found("soft")).toEqual(["old"]);
    expect(found(" bone  knee ")).toEqual(["knee"]);
    expect(found("bone chest")).toEqual([]);
  });

  it("finds regions in the reader's language, and in English", () => {
    speak("de", german);
    expect(found("kopf")).toEqual(["a-10"]);
    expect(found("head")).toEqual(["a-10"]);
    speak("en");
    expect(found("kopf")).toEqual([]);
  });

  it("sorts by title as people count, by the newest, the largest, and the region", () => {
    expect(sorted("title")).toEqual(["old", "a-2", "a-10", "knee"]);
    expect(sorted("date")).toEqual(["a-10", "knee", "a-2", "old"]);
    expect(sorted("size")).toEqual(["a-10", "a-2", "old", "knee"]);
    expect(sorted("region")).toEqual(["a-2", "a-10", "knee", "old"]);
  });

  it("keeps looks of a volume together, those that are found", () => {
    const cases = [
      summary("skin", "Head, skin", { look: look("head", "Skin", "CT", "v") }),
      summary("other", "Head, other", { look: look("head", "Skin", "CT", "w") }),
      summary("bone", "Head, bone", { look: look("head", "Bone", "CT", "v") }),
    ];
    const groups = (search: string) =>
      findCases(cases, search, "title").map(({ looks }) => looks.map((one) => one.case.name));
    expect(groups("head")).toEqual([["bone", "skin"], ["other"]]);
    expect(groups("skin")).toEqual([["other"], ["skin"]]);
  });

  it("says region, size and day in the reader's language, as far as they are known", () => {
    expect(detailText(kCases[1]!)).toBe("Head · 5.0\u00a0MB · Mar\u00a05,\u00a02026");
    speak("de", german);
    expect(detailText(kCases[1]!)).toBe("Kopf · 5.0\u00a0MB · 05.03.2026");
    expect(detailText(kCases[3]!)).toBe("1.0\u00a0MB");
    expect(detailText(summary("x", "X", { look: look("Miller", "") }))).toBe("1.0\u00a0MB"); // no word of the list
    expect(dateText(summary("x", "X", { created: "no day" }))).toBe("");
  });

  it("has the same regions in every language", () => {
    const english = Object.keys(texts().library.regions);
    speak("de", german);
    expect(Object.keys(texts().library.regions)).toEqual(english);
  });

  it("shows what is being made, and what could not be", () => {
    const making = [
      { name: "old", quality: "high", seconds: 60, error: null },
      { name: "new", quality: "instant", seconds: null, error: null },
      { name: "torn", quality: "instant", seconds: null, error: "torn.nii: is cut off" },
    ];
    const all = libraryCases({ cases: kCases, making, keepsMarks: false, keepsTours: false });
    expect(all.map(({ name, file, error }) => [name, file === "", error]).slice(4)).toEqual([
      ["new", true, null],
      ["torn", true, "torn.nii: is cut off"],
    ]);
  });

  it("is shown page by page", () => {
    expect(pageOf([1, 2, 3, 4, 5], 1, 2)).toEqual({ items: [3, 4], page: 1, pages: 3 });
    expect(pageOf([1, 2, 3], 9, 2)).toEqual({ items: [3], page: 1, pages: 2 });
    expect(pageOf([], 0, 2)).toEqual({ items: [], page: 0, pages: 1 });
  });
});
