import { readFileSync } from "node:fs";
import { Color, Matrix3, Vector3 } from "three";
import { describe, expect, it } from "vitest";

/** What eyes without one kind of cones see of linear sRGB (Machado, Oliveira & Fernandes 2009, table 1, severity 1). */
const kEyes: Record<string, Matrix3> = {
  usual: new Matrix3(),
  protanopia: new Matrix3(
    0.152286,
    1.052583,
    -0.204868,
    0.114503,
    0.786281,
    0.099216,
    -0.003882,
    -0.048116,
    1.051998,
  ),
  deuteranopia: new Matrix3(
    0.367322,
    0.860646,
    -0.227968,
    0.280085,
    0.672501,
    0.047413,
    -0.01182,
    0.04294,
    0.968881,
  ),
  tritanopia: new Matrix3(
    1.255528,
    -0.076749,
    -0.178779,
    -0.078411,
    0.930809,
    0.147602,
    0.004733,
    0.691367,
    0.3039,
  ),
};
const kXyz = new Matrix3(0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505);
const kWhite = new Vector3(0.9505, 1, 1.089);

/** CIELAB of a colour, as eyes see it. */
function labOf(hex: string, eyes: Matrix3): Vector3 {
  const { r, g, b } = new Color(hex); // linear
  const seen = new Vector3(r, g, b).applyMatrix3(eyes).clampScalar(0, 1);
  const [x, y, z] = seen
    .applyMatrix3(kXyz)
    .divide(kWhite)
    .toArray()
    .map((t) => (t > 0.008856 ? Math.cbrt(t) : 7.787 * t + 16 / 116)) as [number, number, number];
  return new Vector3(116 * y - 16, 500 * (x - y), 200 * (y - z));
}

describe("the colours of slices", () => {
  it.each(Object.keys(kEyes))("are told apart by eyes with %s", (kind) => {
    const css = readFileSync("src/ui/slice_views.css", "utf8");
    const lines = [...css.matchAll(/--line: (#[0-9a-f]{6})/g)].map(([, hex]) => labOf(hex!, kEyes[kind]!));
    expect(lines).toHaveLength(4);
    lines.forEach((a, i) => lines.slice(i + 1).forEach((b) => expect(a.distanceTo(b)).toBeGreaterThan(15)));
  });
});
