import { describe, expect, it } from "vitest";

import { droppedFiles, isTour, isVolume } from "../../src/ui/open_file";

const file = (name: string, text = "x") => new File([text], name);
const drop = (files: File[], folder: string | null = null) =>
  droppedFiles({
    files: Object.assign(files, { item: (i: number) => files[i] ?? null }),
    items: files.map(() => ({
      webkitGetAsEntry: () => (folder ? { isDirectory: true, name: folder } : null),
    })),
  }).map(({ name }) => name);

describe("what is dropped", () => {
  it("is a case, and what is marked in it after it", () => {
    expect(drop([file("a.sog")])).toEqual(["a.sog"]);
    expect(drop([file("a.marks.json"), file("a.tour.JSON"), file("a.sog")])).toEqual([
      "a.sog",
      "a.marks.json",
      "a.tour.JSON",
    ]);
    expect(drop([])).toEqual([]);
  });

  it("is refused in a line where it is a folder, or two cases", () => {
    expect(() => drop([file("cases")], "cases")).toThrow("cases: this is a folder");
    expect(() => drop([file("a.sog"), file("b.ply")])).toThrow("One case can be opened at a time");
  });

  it("is a volume by its name, or by what it says", async () => {
    for (const name of ["a.DCM", "a.nii", "a.nii.gz", "a.nrrd", "a.mha", "IM0001.ima"]) {
      expect(await isVolume(file(name)), name).toBe(true);
    }
    expect(await isVolume(file("IM000001", `${"\0".repeat(128)}DICM`))).toBe(true);
    for (const name of ["a.sog", "a.ply", "a.spz", "a.json", "nii", "a.sog.gz"]) {
      expect(await isVolume(file(name, `DICM${"\0".repeat(200)}`)), name).toBe(false);
    }
  });

  it("is a tour or marks by what it says", async () => {
    expect(await isTour(file("a.json", '{"clipgs_tour":1,"stops":[]}'))).toBe(true);
    expect(await isTour(file("tour.json", '{"clipgs_marks":1}'))).toBe(false);
  });
});
