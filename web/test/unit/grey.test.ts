import { describe, expect, it } from "vitest";

import { draggedWindow, shades, windowPresets } from "../../src/model/grey";
import { makeSection, withVoxels } from "./section_fixture";

describe("windows", () => {
  const section = makeSection();

  it("are those of radiologists for CT, of the values for others, and none for photographs", () => {
    expect(windowPresets(section).get("Soft tissue")).toEqual({ center: 40, width: 400 });
    expect([...windowPresets(section).keys()]).toEqual(["Soft tissue", "Bone", "Lung", "Brain"]);
    expect([...windowPresets(makeSection({ modality: "MR" })).keys()]).toEqual(["Auto", "Full range"]);
    expect(windowPresets(makeSection({ modality: "photographs", channels: 3 })).size).toBe(0);
  });

  it("leave out the air around the body, and single bright voxels", () => {
    const section = makeSection({ modality: "MR", curve: Array.from({ length: 256 }, (_, i) => 10 * i) });
    const voxels = section.voxels.fill(0).fill(100, 0, 300).fill(120, 300, 400);
    voxels[400] = 255;
    const mr = withVoxels(section, voxels);
    expect(windowPresets(mr).get("Auto")).toEqual({ center: 1100, width: 200 });
    expect(windowPresets(mr).get("Full range")).toEqual({ center: 1355, width: 2390 });
    const air = withVoxels(section, voxels.fill(0));
    expect(windowPresets(air).get("Auto")!.width).toBeGreaterThan(0);
  });

  it("run from black to white", () => {
    const { curve } = section; // −1000 to 1550 in steps of 10
    const table = shades({ center: 40, width: 400 }, curve);
    expect(table[84]).toBeCloseTo(0); // −160
    expect(table[104]).toBeCloseTo(0.5); // 40
    expect(table[124]).toBeCloseTo(1); // 240
  });

  it("are dragged wider to the right and up to higher values, within what the values warrant", () => {
    const start = { center: 40, width: 400 };
    expect(draggedWindow(start, 0, 0, section.curve)).toEqual(start);
    expect(draggedWindow(start, 50, 0, section.curve).width).toBeGreaterThan(450);
    expect(draggedWindow(start, 0, -50, section.curve).center).toBeGreaterThan(80);
    expect(draggedWindow(start, -1e5, 1e5, section.curve)).toEqual({ center: -1000, width: 2.55 });
    expect(draggedWindow(start, 1e5, -1e5, section.curve)).toEqual({ center: 1550, width: 5100 });
  });
});
