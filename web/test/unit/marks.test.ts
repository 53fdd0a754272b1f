import { Ray, Vector3 } from "three";
import { describe, expect, it } from "vitest";

import { changeBetween, changed } from "../../src/model/keeper";
import { layOut } from "../../src/model/label_layout";
import { formatLink, parseLink } from "../../src/model/link";
import { Marking } from "../../src/model/marking";
import {
  kMostMarks,
  makeMark,
  type Mark,
  type MarkShape,
  markText,
  measure,
  measureText,
  withMark,
} from "../../src/model/marks";
import { formatMarks, mergedMarks, parseMarks } from "../../src/model/marks_file";
import { regionArea, regionValues } from "../../src/model/region";
import { makeSection } from "./section_fixture";
import { makeRandom } from "./sog_fixture";

const v = (x: number, y = 0, z = 0) => new Vector3(x, y, z);
const up = v(0, 0, 1);
const plane = { normal: up, offset: 0 };

const kShapes: readonly MarkShape[] = [
  { kind: "point", points: [v(1, 2, 3)], normal: null },
  { kind: "length", points: [v(0), v(3, 4)], normal: null },
  { kind: "angle", points: [v(5), v(0), v(0, 2)], normal: null },
  { kind: "region", points: [v(0), v(2)], normal: up },
  { kind: "outline", points: [v(0), v(3), v(3, 2), v(0, 2)], normal: up },
];

describe("marks", () => {
  it("measure lengths, angles and areas, lengths first", () => {
    const text = (shape: MarkShape) => measureText(measure(shape, null));
    expect(kShapes.map(text)).toEqual(["", "5.0 mm", "90.0°", "13 mm²", "6 mm²"]);
    const wide: MarkShape = { kind: "region", points: [v(0), v(0, 0, 10)], normal: v(1) };
    expect(text(wide)).toBe("3.14 cm²");
    expect(markText(makeMark(kShapes[1]!, "Nodule"), measure(kShapes[1]!, null))).toBe("Nodule · 5.0 mm");
    const folded: MarkShape = { kind: "angle", points: [v(1), v(1), v(2)], normal: null };
    expect(text(folded)).toBe("0.0°");
  });

  it("measure areas of any outline, in any plane", () => {
    const random = makeRandom(7);
    for (let round = 0; round < 20; ++round) {
      const normal = v(random() - 0.5, random() - 0.5, random() - 0.5).normalize();
      const u = new Vector3().crossVectors(normal, Math.abs(normal.x) < 0.8 ? v(1) : v(0, 1)).normalize();
      const w = new Vector3().crossVectors(normal, u);
      const corners = Array.from(
        { length: 3 + Math.floor(5 * random()) },
        () => [random(), random()] as const,
      );
      corners.sort((a, b) => Math.atan2(a[1] - 0.5, a[0] - 0.5) - Math.atan2(b[1] - 0.5, b[0] - 0.5));
      const at = v(10 * random(), 10 * random(), 10 * random());
      const points = corners.map(([a, b]) =>
        at
          .clone()
          .addScaledVector(u, 40 * a)
          .addScaledVector(w, 40 * b),
      );
      // By triangles, which need no plane.
      const sum = v(0);
      points.forEach((point, i) =>
        sum.add(
          point
            .clone()
            .sub(at)
            .cross(points[(i + 1) % points.length]!.clone().sub(at)),
        ),
      );
      expect(regionArea({ kind: "outline", points, normal })).toBeCloseTo(0.5 * sum.length(), 6);
    }
  });

  it("have the mean and deviation of the values within a region, and none of the air around", () => {
    const section = makeSection();
    const [x, y] = section.spacing;
    const origin = v(...section.origin);
    const axes = section.axes.map((axis) => v(...axis));
    const at = (i: number, j: number, k: number) =>
      origin
        .clone()
        .addScaledVector(axes[0]!, i * x)
        .addScaledVector(axes[1]!, j * y)
        .addScaledVector(axes[2]!, k * section.spacing[2]);
    section.voxels.fill(100);
    const normal = axes[2]!;
    const region: MarkShape = { kind: "region", points: [at(2, 8, 3), at(2, 9.5, 3)], normal };
    const even = regionValues(region, section)!;
    expect(even.mean).toBeCloseTo(0, 6);
    expect(even.deviation).toBeCloseTo(0, 6);
    expect(even.samples).toBeGreaterThan(200);
    // Rising by 10 a voxel along the second axis: over a disc of radius r that is r/2 of deviation.
    for (let i = 0; i < section.voxels.length; ++i) {
      section.voxels[i] = 60 + (Math.floor(i / 5) % 18);
    }
    const rising = regionValues(region, section)!;
    expect(rising.mean).toBeCloseTo(10 * (60 + 8) - 1000, 0);
    expect(rising.deviation).toBeCloseTo((10 * 1.5) / 2, 0);
    expect(rising.least).toBeGreaterThan(rising.mean - 15.1);
    section.voxels.fill(0);
    expect(regionValues(region, section)).toBeNull();
    expect(measureText(measure(region, section))).not.toContain("mean");
  });

  it("are one where the same is marked twice, and no more than can be shown", () => {
    const once = withMark([], makeMark(kShapes[1]!))!;
    expect(withMark(once, makeMark(kShapes[1]!, "again"))).toBeNull();
    const many = Array.from({ length: kMostMarks }, (_, i) =>
      makeMark({ kind: "point", points: [v(i)], normal: null }),
    );
    expect(new Set(many.map(({ id }) => id)).size).toBe(kMostMarks);
    expect(withMark(many, makeMark(kShapes[1]!))).toBeNull();
  });
});

describe("marking", () => {
  const marked: MarkShape[] = [];
  const marking = new Marking((shape) => {
    if (shape.points[0]!.x < 0) {
      return false; // air
    }
    marked.push(shape);
    return true;
  });
  const put = (x: number, y = 0) => marking.put({ point: v(x, y), plane });

  it("takes as many points as a kind wants", () => {
    expect(put(1)).toBe(true); // unasked: a point
    expect(marked.at(-1)!.kind).toBe("point");
    marking.toggle("length");
    expect(put(2)).toBe(true);
    expect(marking.kind).toBe("length");
    expect(put(2)).toBe(false); // no length
    expect(put(5)).toBe(true);
    expect(marking.kind).toBeNull();
    expect(marked.at(-1)!.points).toEqual([v(2), v(5)]);
    marking.toggle("angle");
    [v(1), v(0), v(0, 1)].forEach(({ x, y }) => put(x, y));
    expect(marked.at(-1)).toEqual({ kind: "angle", points: [v(1), v(0), v(0, 1)], normal: null });
    marking.toggle("length");
    put(9);
    marking.toggle("length"); // called off
    expect(marking.points).toEqual([]);
    expect(put(-1)).toBe(false);
    expect(marking.kind).toBeNull();
  });

  it("keeps regions and outlines to the face that they begin on", () => {
    marking.toggle("region");
    put(0);
    expect(marking.meet(new Ray(v(4, 4, 10), v(0, 0, -1)))).toEqual(v(4, 4));
    expect(marking.put({ point: v(3, 0, 7), plane: null })).toBe(true);
    expect(marked.at(-1)).toEqual({ kind: "region", points: [v(0), v(3)], normal: up });
    marking.toggle("outline");
    put(0);
    put(10);
    expect(marking.finish()).toBe(false);
    put(10, 10);
    expect(marking.preview(v(0, 10))!.points.length).toBe(4);
    expect(put(0.5, 0.5)).toBe(true); // its first corner again
    expect(marking.kind).toBeNull();
    expect(marked.at(-1)!.points).toEqual([v(0), v(10), v(10, 10)]);
  });
});

describe("marks that are kept", () => {
  const marks = kShapes.map((shape, i) =>
    makeMark(shape, i === 1 ? "Größe; & more" : "", i === 2 ? "a\nb" : ""),
  );
  const isSame = (a: readonly Mark[], b: readonly Mark[]) => {
    expect(a.map(({ id, kind, name, note }) => [id, kind, name, note])).toEqual(
      b.map(({ id, kind, name, note }) => [id, kind, name, note]),
    );
    a.forEach(({ points, normal }, i) => {
      points.forEach((point, k) => expect(point.distanceTo(b[i]!.points[k]!)).toBeLessThan(0.01));
      expect(normal?.toArray()).toEqual(b[i]!.normal?.toArray());
    });
  };

  it("come back from links, with names and notes, and are the same marks", () => {
    const hash = formatLink({ marks });
    isSame(parseLink(hash).marks!, marks);
    expect(formatLink(parseLink(hash))).toBe(hash);
    expect(hash).toContain("pin=1,2,3&length=0,0,0,3,4,0&name=Gr");
  });

  it("are read from the links of before, that joined points", () => {
    const kinds = (hash: string) => parseLink(hash).marks?.map(({ kind, points }) => [kind, points.length]);
    expect(kinds("#pin=1,2,3&pin=4,5,6.5&to=7,8,9&to=1,1,1")).toEqual([
      ["point", 1],
      ["length", 2],
      ["length", 2],
    ]);
    expect(kinds("#to=1,2,3&pin=1,2")).toEqual([["point", 1]]);
    expect(kinds("#length=1,2,3&angle=1,2,3,4,5,6&region=0,0,0,1,1,1,2,2,2")).toBeUndefined();
  });

  it("come back from files; what is not one is said in a line", () => {
    isSame(parseMarks(formatMarks(marks, "abc"), "a.json", "abc"), marks);
    isSame(parseMarks(formatMarks(marks, ""), "a.json", "abc"), marks);
    const file = JSON.parse(formatMarks(marks, "abc")) as { marks: object[] };
    const refused = (change: object, volume = "abc") => {
      try {
        parseMarks(JSON.stringify({ ...file, ...change }), "a.json", volume);
      } catch (error) {
        return (error as Error).message;
      }
      return "";
    };
    expect(refused({ clipgs_marks: 2 })).toMatch(/^a\.json: of a version .* newer clipgs$/);
    expect(refused({}, "other")).toMatch(/^a\.json: marks of another volume/);
    expect(refused({ marks: Array(10000).fill(file.marks[0]) })).toMatch(
      /^a\.json: holds 10000 marks, .* 500/,
    );
    expect(refused({ marks: [{ ...file.marks[0], kind: "star" }] })).toMatch(/marks\[0\]\.kind/);
    expect(refused({ marks: [{ ...file.marks[0], points: [[1, 2, null]] }] })).toMatch(/marks\[0\]\.points/);
    expect(refused({ marks: [{ ...file.marks[1], points: [[1, 2, 3]] }] })).toMatch(/marks\[0\]\.points/);
    expect(refused({ marks: [{ ...file.marks[3], normal: [0, 0, 0] }] })).toMatch(/a\.json/);
    for (const text of ["", "[]", "{}", "null", "{"]) {
      expect(() => parseMarks(text, "a.json", "abc")).toThrow(/^a\.json: /);
    }
    const long = makeMark(kShapes[0]!, "名".repeat(500), "x".repeat(5000));
    expect(long.name.length).toBe(120);
    expect(long.note.length).toBe(2000);
  });

  it("are those of both files, and what a person changed is changed there alone", () => {
    const [a, b, c] = marks as [Mark, Mark, Mark];
    const renamed = { ...b, name: "other" };
    expect(mergedMarks([a, b], [renamed, c], "c.json")).toEqual([a, renamed, c]);
    const many = Array.from({ length: kMostMarks - 1 }, (_, i) =>
      makeMark({ kind: "point", points: [new Vector3(i, 0, 0)], normal: null }),
    );
    expect(mergedMarks(many, [renamed], "c.json").length).toBe(kMostMarks);
    expect(() => mergedMarks(many, [a, c], "c.json")).toThrow(/^c\.json: .* 501 marks, .* 500 /);
    const change = changeBetween([a, b], [renamed, c]);
    expect(change).toEqual({ put: [renamed, c], gone: new Set([a.id]) });
    expect(changed([a, b, marks[3]!], change)).toEqual([renamed, marks[3]!, c]);
  });
});

describe("labels", () => {
  const size = { width: 80, height: 20 };
  const picture = { width: 400, height: 300 };

  it("keep clear of each other, of what is marked and of the edges", () => {
    const random = makeRandom(3);
    for (let round = 0; round < 50; ++round) {
      const labels = Array.from({ length: 6 }, () => ({
        anchor: { x: 20 + 360 * random(), y: 20 + 260 * random() },
        ...size,
      }));
      const boxes = layOut(labels, picture).map(({ at }) => at);
      boxes.forEach((a, i) => {
        expect(a.x).toBeGreaterThanOrEqual(0);
        expect(a.x + size.width).toBeLessThanOrEqual(picture.width);
        expect(a.y).toBeGreaterThanOrEqual(0);
        expect(a.y + size.height).toBeLessThanOrEqual(picture.height);
        boxes.slice(i + 1).forEach((b) => {
          const apart = Math.abs(a.x - b.x) >= size.width || Math.abs(a.y - b.y) >= size.height;
          expect(apart, JSON.stringify([a, b])).toBe(true);
        });
      });
    }
  });

  it("keep clear of lines that are measured", () => {
    for (const [from, to] of [
      [
        { x: 100, y: 100 },
        { x: 300, y: 100 },
      ],
      [
        { x: 200, y: 50 },
        { x: 200, y: 250 },
      ],
      [
        { x: 120, y: 60 },
        { x: 280, y: 180 },
      ],
    ] as const) {
      const anchor = { x: 0.5 * (from.x + to.x), y: 0.5 * (from.y + to.y) };
      const { at } = layOut([{ anchor, ...size, line: [from, to] }], picture)[0]!;
      for (let k = 0; k <= 100; ++k) {
        const [x, y] = [from.x + 0.01 * k * (to.x - from.x), from.y + 0.01 * k * (to.y - from.y)];
        const isCovered = at.x < x && x < at.x + size.width && at.y < y && y < at.y + size.height;
        expect(isCovered, JSON.stringify([from, to, at])).toBe(false);
      }
    }
  });

  it("stay where they were while there is room", () => {
    const labels = [{ anchor: { x: 100, y: 100 }, ...size }];
    const [first] = layOut(labels, picture);
    expect(first!.choice).toBe(0);
    const [kept] = layOut(labels, picture, [3]);
    expect(kept!.choice).toBe(3);
    const beside = [...labels, { anchor: { x: 100, y: 112 }, ...size }];
    expect(layOut(beside, picture, [0, 0])[1]!.choice).not.toBe(0);
  });
});
