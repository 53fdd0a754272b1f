import { Vector3 } from "three";
import { describe, expect, it } from "vitest";

import { formatLink, parseLink } from "../../src/model/link";
import { lengthsOf, lengthText, Marking, type Pin, withoutPin, withPin } from "../../src/model/pins";

const at = (x: number, joined = false): Pin => ({
  point: new Vector3(x, 0, 0),
  value: 0,
  error: 1,
  modality: "CT",
  joined,
});
const all = (...pins: Pin[]) => pins.reduce(withPin, [] as Pin[]);
const shown = (pins: readonly Pin[]) => lengthsOf(pins).map(lengthText);

describe("pins", () => {
  it("measures from pin to pin where they are joined", () => {
    expect(shown(all(at(0), at(3, true), at(10), at(12.25, true), at(20, true)))).toEqual([
      "3.0 mm",
      "2.3 mm",
      "7.8 mm",
    ]);
    expect(shown(all(at(5, true)))).toEqual([]); // nothing is before it
  });

  it("forgets lengths with their ends", () => {
    const pins = all(at(0), at(3, true), at(7, true));
    expect(shown(withoutPin(pins, 0))).toEqual(["4.0 mm"]);
    expect(shown(withoutPin(pins, 1))).toEqual([]);
    expect(shown(withoutPin(pins, 2))).toEqual(["3.0 mm"]);
    const many = all(...Array.from({ length: 25 }, (_, i) => at(i, true)));
    expect(many.length).toBe(20);
    expect(many[0]).toEqual(at(5));
  });

  it("marks one point, or two for a length", () => {
    let pins: Pin[] = [];
    const marking = new Marking((point, joined) => {
      if (point.x < 0) {
        return false; // air
      }
      pins = withPin(pins, { ...at(point.x), joined });
      return true;
    });
    const put = (x: number) => marking.put(new Vector3(x, 0, 0));
    expect(put(1)).toBe(true); // unasked: a pin
    marking.toggle("length");
    expect(put(2)).toBe(true);
    expect(marking.mark).toBe("length");
    expect(put(-1)).toBe(false);
    expect(put(5)).toBe(true);
    expect(marking.mark).toBeNull();
    expect(shown(pins)).toEqual(["3.0 mm"]);
    marking.toggle("length");
    put(9);
    marking.toggle("length"); // called off
    marking.toggle("length");
    put(20);
    put(24);
    expect(shown(pins)).toEqual(["3.0 mm", "4.0 mm"]);
    marking.toggle("pin");
    put(30);
    expect(marking.mark).toBeNull();
    expect(shown(pins)).toEqual(["3.0 mm", "4.0 mm"]);
  });

  it("is part of the link", () => {
    const hash = "#pin=1,2,3&pin=4,5,6.5&to=7,8,9";
    const { pins } = parseLink(hash);
    expect(pins).toEqual([
      { point: new Vector3(1, 2, 3), joined: false },
      { point: new Vector3(4, 5, 6.5), joined: false },
      { point: new Vector3(7, 8, 9), joined: true },
    ]);
    expect(formatLink({ pins })).toBe(hash);
    expect(parseLink("#to=1,2,3&pin=1,2").pins).toEqual([{ point: new Vector3(1, 2, 3), joined: true }]);
  });
});
