import { readFileSync } from "node:fs";
import { PerspectiveCamera, Ray, Vector3 } from "three";
import { describe, expect, it } from "vitest";

import { parseCaseInfo } from "../../src/model/case_info";
import {
  flipped,
  kWorldFromPatient,
  planeThrough,
  projectBox,
  projectOnto,
  signedDistance,
} from "../../src/model/geometry";
import { canDraw, planesOf } from "../../src/model/cut";
import { formatLink, parseLink } from "../../src/model/link";
import { PlaneDrag, snapped } from "../../src/model/plane_drag";
import { freeAxis, kAxes, orientationOf, planeAcross, planeText } from "../../src/model/planes";
import { lightsOf } from "../../src/model/rigs";
import { applyView, viewDirection, viewFrom, zoomed } from "../../src/model/view";
import type { LightRig } from "../../src/sog/section";

const box = { min: new Vector3(-100, -60, 0), max: new Vector3(100, 60, 300) };

describe("cuts", () => {
  const across = (z: number, offset: number, thickness: number | null = null) => ({
    normal: new Vector3(0, 0, z),
    offset,
    thickness,
  });
  const aside = { normal: new Vector3(1, 0, 0), offset: 3, thickness: null };

  it("keep of a slab what lies between its planes", () => {
    const planes = planesOf([across(-1, -50, 20)]);
    const keeps = (z: number) => planes.every((plane) => signedDistance(plane, new Vector3(0, 0, z)) >= 0);
    expect([51, 49, 31, 29].map(keeps)).toEqual([false, true, true, false]);
  });

  it("have opposite planes one after the other", () => {
    const planes = planesOf([across(1, 0), aside, across(-1, -9)]);
    expect(planes.map(({ normal }) => [normal.x, normal.z])).toEqual([
      [0, 1],
      [0, -1],
      [1, 0],
    ]);
  });

  it("count the planes of slabs twice", () => {
    expect(canDraw([across(1, 0, 5), across(1, 9, 5), across(1, 19, 5)])).toBe(true);
    expect(canDraw([across(1, 0, 5), across(1, 9, 5), across(1, 19, 5), aside])).toBe(false);
  });

  it("leave the axis free that they cut least", () => {
    expect(freeAxis([])).toBe(kAxes.axial);
    expect(freeAxis([across(-1, 0)])).toBe(kAxes.coronal);
    expect(freeAxis([across(-1, 0), { ...aside, normal: new Vector3(0, 1, 0) }])).toBe(kAxes.sagittal);
  });
});

describe("planes", () => {
  it("measure distances towards the kept side", () => {
    const plane = planeThrough(new Vector3(0, 0, 2), new Vector3(5, 6, 7));
    expect(plane.offset).toBeCloseTo(7);
    expect(signedDistance(plane, new Vector3(0, 0, 10))).toBeCloseTo(3);
    expect(signedDistance(flipped(plane), new Vector3(0, 0, 10))).toBeCloseTo(-3);
    expect(projectOnto(plane, new Vector3(1, 2, 3)).toArray()).toEqual([1, 2, 7]);
  });

  it("cut where the box is", () => {
    expect(projectBox(box, new Vector3(0, 0, -1))).toEqual([-300, 0]);
    expect(projectBox(box, new Vector3(1, 1, 0))).toEqual([-160, 160]);
  });

  it("open the patient towards the viewer", () => {
    const front = planeAcross(new Vector3(0, 1, 0), box, viewDirection(10, 0));
    expect(front.normal.y).toBe(-1);
    expect(orientationOf(front)).toBe("coronal");
    expect(planeText(front)).toBe("Coronal, anterior removed");
    const back = planeAcross(new Vector3(0, 1, 0), box, viewDirection(170, 0));
    expect(planeText(back)).toBe("Coronal, posterior removed");
    const above = planeAcross(new Vector3(0, 0, 1), box, viewDirection(0, 20));
    expect([planeText(above), above.offset]).toEqual(["Axial, superior removed", -150]);
    expect(orientationOf(planeThrough(new Vector3(1, 1, 0), new Vector3()))).toBeNull();
  });
});

describe("the camera", () => {
  const sphere = { center: new Vector3(10, -20, 30), radius: 120 };

  it("frames the sphere and keeps left and right", () => {
    const camera = new PerspectiveCamera();
    applyView(camera, viewFrom(0, 0), sphere, 400, 300);
    const at = (offset: [number, number, number]) =>
      sphere.center
        .clone()
        .add(new Vector3(...offset))
        .applyMatrix4(kWorldFromPatient)
        .project(camera);
    expect(at([0, 0, 0]).x).toBeCloseTo(0, 6);
    expect(at([-50, 0, 0]).x).toBeGreaterThan(0.1); // the patient's left is on the viewer's right
    expect(at([0, 0, 50]).y).toBeGreaterThan(0.1);
    expect(at([0, 50, 0]).z).toBeLessThan(at([0, -50, 0]).z);
    // The sphere's outline is a cone: its points of contact project onto 90 % of the shorter side.
    const distance = camera.position
      .clone()
      .applyMatrix4(kWorldFromPatient.clone().invert())
      .distanceTo(sphere.center);
    const sine = sphere.radius / distance;
    const contact = at([0, sphere.radius * sine, sphere.radius * Math.sqrt(1 - sine * sine)]);
    expect(contact.y).toBeCloseTo(0.9, 4);
  });

  it("stands where the view says", () => {
    expect(viewDirection(0, 0).toArray().map(Math.round)).toEqual([-0, 1, 0]);
    expect(viewDirection(90, 0).x).toBeCloseTo(-1);
    expect(viewDirection(0, 90).z).toBeCloseTo(1);
    const camera = new PerspectiveCamera();
    applyView(camera, viewFrom(33, 90), sphere, 300, 300);
    const left = sphere.center
      .clone()
      .add(new Vector3(-50, 0, 0))
      .applyMatrix4(kWorldFromPatient)
      .project(camera);
    expect(left.x).toBeGreaterThan(0.1);
    expect(left.y).toBeCloseTo(0, 5);
  });
});

describe("lights", () => {
  const own = {
    skyTop: [0.2, 0.4, 0.6],
    skyHorizon: [1, 1, 1],
    skyBottom: [1, 1, 1],
    keys: [{ direction: [1, 0, 0], radiance: [2, 1, 1], angularRadius: 0.1 }],
  } satisfies LightRig;

  it("are turned from the right towards the front", () => {
    const [x, y, z] = lightsOf({ rig: null, turn: 90, lamp: null }, own).keys[0]!.direction;
    expect([x, y, z].map((part) => Number(part.toFixed(6)) + 0)).toEqual([0, 1, 0]);
  });

  it("are a lamp's, as bright as those whose place it takes", () => {
    const lights = lightsOf({ rig: null, turn: 90, lamp: [0, 0, 1] }, own);
    expect(lights.keys).toHaveLength(1);
    expect(lights.keys[0]!.direction).toEqual([0, 0, 1]);
    expect(lights.keys[0]!.radiance[0]).toBe(2);
    expect(lights.skyTop[2]).toBeLessThan(0.5 * own.skyTop[2]);
  });
});

describe("links", () => {
  it("say again what they said", () => {
    const text =
      "#case=head%20a&view=30,-12.5,2&pan=1,2,3&plane=0,0.6,-0.8,12.25&clip=soft&section=splats&grey=0.5&openings=neutral&rig=rim&turn=-40&lamp=0.6,0,0.8&window=40,400&pin=1.5,-20,3&pin=0,0,9&background=studio&depth-cue=0.4&slices=axial,unlinked&cross=1,-2.5,30&beside=head%20b&size=512x384";
    expect(formatLink(parseLink(text))).toBe(text);
    expect(formatLink(parseLink("#plane=off"))).toBe("#plane=off");
    expect(formatLink(parseLink("#slices=all"))).toBe("#slices=all");
  });

  it("hold a state of the uniaxial mode in place of planes", () => {
    const text = "#view=1,2,1&state=57&clip=layers";
    expect(formatLink(parseLink(text))).toBe(text);
    expect(formatLink(parseLink("#state=off"))).toBe("#state=off");
    expect(parseLink("#plane=0,0,1,5&state=0")).toEqual({ state: 0 });
  });

  it("normalise planes as clipgs render does", () => {
    const [plane, slab] = parseLink("#plane=0,0,-2,10&slab=0,4,0,8,12").cuts!;
    expect([plane!.normal.z, plane!.offset, plane!.thickness]).toEqual([-1, 5, null]);
    expect([slab!.normal.y, slab!.offset, slab!.thickness]).toEqual([1, 2, 12]);
  });

  it("hold several planes and slabs, no more than can be drawn", () => {
    const text = "#plane=0,0,-1,5&slab=1,0,0,-20,15&plane=0,1,0,3";
    expect(formatLink(parseLink(text))).toBe(text);
    expect(parseLink("#slab=1,0,0,0,9&slab=0,1,0,0,9&slab=0,0,1,0,9").cuts).toHaveLength(3);
    expect(parseLink(`#${"plane=0,0,1,0&".repeat(7)}`)).toEqual({});
  });

  it("zoom as far as a person can", () => {
    for (const factor of [1e-5, 1e5]) {
      expect(parseLink(`#view=1,2,${factor}`).view).toEqual({
        ...viewFrom(1, 2),
        ...zoomed(viewFrom(1, 2), factor),
      });
    }
  });

  it("leave out what is not valid", () => {
    for (const hash of [
      "",
      "#",
      "#view=1",
      "#view=a,b",
      "#view=1,2,0",
      "#view=1,2,3,4",
      "#view=1e999,0",
      "#plane=0,0,0,1",
      "#plane=0,0,1,1e308",
      "#plane=1e300,1e300,1e300,1",
      "#plane=1e-300,0,0,1",
      "#plane=0,0,1,0,5",
      "#slab=0,0,1,0",
      "#slab=0,0,1,0,0",
      "#plane=1,2,3",
      "#plane=1,,3,4",
      "#state=-1",
      "#state=1.5",
      "#state=",
      "#clip=none",
      "#clip=other",
      "#clip=toString",
      "#section=other",
      "#grey=2",
      "#grey=-1",
      "#grey=x",
      "#openings=closed",
      "#rig=sun",
      "#turn=left",
      "#background=pink",
      "#depth-cue=2",
      "#slices=upright",
      "#cross=1,2,3",
      "#lamp=0,0,0",
      "#lamp=1,2",
      "#window=40",
      "#window=40,0",
      "#size=x",
      "#size=4x4",
      "#size=1e3",
    ]) {
      expect(parseLink(hash), hash).toEqual({});
    }
  });
});

describe("dragging the plane", () => {
  const plane = planeThrough(new Vector3(0, 0, -1), new Vector3(0, 0, 50));
  const center = new Vector3(0, 0, 50);
  const up = new Vector3(0, 0, 1);
  const towards = (origin: Vector3, target: Vector3) =>
    new Ray(origin, target.clone().sub(origin).normalize());
  const eye = new Vector3(0, 500, 50);

  it("slides with the pointer", () => {
    const drag = new PlaneDrag("arrow", plane, center, 100, up, towards(eye, new Vector3(0, 0, 60)));
    const moved = drag.move(towards(eye, new Vector3(0, 0, 85)));
    expect(moved.normal.z).toBe(-1);
    expect(moved.offset).toBeCloseTo(-75, 4);
  });

  it("slides by the pointer's height when seen from above", () => {
    const above = new Vector3(0, 1, 500);
    const drag = new PlaneDrag(
      "arrow",
      plane,
      center,
      100,
      new Vector3(0, -1, 0),
      towards(above, new Vector3(0, 0, 50)),
    );
    const moved = drag.move(towards(above, new Vector3(0, -20, 50)));
    expect(moved.offset).toBeLessThan(-60); // nearer to the viewer
    expect(moved.offset).toBeGreaterThan(-80);
  });

  it("tilts about its centre, following the rim", () => {
    const grabbed = new Vector3(100, 0, 50);
    const drag = new PlaneDrag("rim", plane, center, 100, up, towards(eye, grabbed));
    expect(drag.move(towards(eye, grabbed)).normal.z).toBeCloseTo(-1);
    const angle = Math.PI / 6;
    const moved = drag.move(towards(eye, new Vector3(100 * Math.cos(angle), 0, 50 + 100 * Math.sin(angle))));
    expect(moved.normal.length()).toBeCloseTo(1);
    expect(signedDistance(moved, center)).toBeCloseTo(0, 3);
    expect(Math.acos(-moved.normal.z)).toBeCloseTo(angle, 1);
  });

  it("takes the far half of the rim as well", () => {
    const from = new Vector3(0, 400, 250); // from above and in front
    const far = new Vector3(0, -100, 50);
    const drag = new PlaneDrag("rim", plane, center, 100, up, towards(from, far));
    expect(drag.move(towards(from, far)).normal.z).toBeCloseTo(-1, 5);
    const lifted = drag.move(towards(from, new Vector3(0, -100, 70)));
    expect(lifted.normal.y).toBeLessThan(0); // the back goes up
  });

  it("snaps near a body axis, when asked", () => {
    expect(
      snapped(new Vector3(0.05, 0.02, -1).normalize())
        .toArray()
        .map(Math.abs),
    ).toEqual([0, 0, 1]);
    const oblique = new Vector3(1, 0, 1).normalize();
    expect(snapped(oblique)).toBe(oblique);
  });
});

describe("parseCaseInfo", () => {
  const block = () => ({
    version: 1,
    world: {
      scene_to_ras_mm: [
        [-1000, 0, 0, 1],
        [0, 0, -1000, 2],
        [0, -1000, 0, 3],
        [0, 0, 0, 1],
      ],
      mm_per_unit: 1000,
    },
    axis: [0, 0, 1],
    extent: [-10, 20],
    sphere: { center: [1, 2, 3], radius: 100 },
    bounds: { min: [-1, -2, -3], max: [1, 2, 3] },
    title: "A head",
    preset: "bone",
    created: "",
  });

  it("reads the frame", () => {
    const info = parseCaseInfo(block());
    expect(info.mmPerUnit).toBeCloseTo(1000);
    expect(new Vector3(0.001, 0.002, 0.003).applyMatrix4(info.sceneToPatient).toArray()).toEqual([0, -1, 1]);
    expect(info.title).toBe("A head");
  });

  it("has states, its own or those of its extent", () => {
    expect(parseCaseInfo(block()).states).toMatchObject({ count: 200, spacing: 0.15, keeps: "below" });
    const states = { count: 3, first: -5, spacing: 5, keeps: "above" };
    const info = parseCaseInfo({ ...block(), axis: [0, 1, 0], states });
    expect(info.states).toEqual({ ...states, axis: new Vector3(0, 1, 0) });
  });

  it("knows splats that are placed from those that are trained", () => {
    expect(parseCaseInfo(block()).placed).toBe(false);
    expect(parseCaseInfo({ ...block(), splats: "placed" }).placed).toBe(true);
  });

  it("refuses frames that bend or mirror, and whatever is missing", () => {
    const bent = block();
    bent.world.scene_to_ras_mm[0]![1] = 300;
    const mirrored = block();
    mirrored.world.scene_to_ras_mm[0]![0] = 1000;
    for (const wrong of [
      undefined,
      null,
      5,
      {},
      { ...block(), version: 2 },
      { ...block(), sphere: null },
      { ...block(), title: 3 },
      { ...block(), extent: [1] },
      { ...block(), states: null },
      { ...block(), splats: "guessed" },
      { ...block(), sphere: { center: [0, 0, 0], radius: 0 } },
      bent,
      mirrored,
    ]) {
      expect(() => parseCaseInfo(wrong)).toThrow();
    }
  });
});

describe("the shaders", () => {
  it("share their constants with the C++ program and the WASM module", () => {
    const glsl = readFileSync("src/shaders/gaussian.glsl", "utf8");
    const value = (text: string, name: string): number => {
      const found = new RegExp(`\\b${name} = ([^;]+);`).exec(text);
      expect(found, name).not.toBeNull();
      // eslint-disable-next-line @typescript-eslint/no-implied-eval, @typescript-eslint/no-unsafe-call -- of our own source
      return Function(`return ${found![1]!.replace(/(\d)f\b/g, "$1")}`)() as number;
    };
    const twin = [
      ["../src/splat/clip.h", ["kClipSigma", "kCdfLinear", "kCdfCubic", "kMinConditionalVariance"]],
      ["../src/splat/projection.h", ["kBlurVariance"]],
      ["wasm/splat_order.cpp", ["kAlphaMin", "kClipSigma"]],
    ] as const;
    for (const [file, names] of twin) {
      const text = readFileSync(file, "utf8");
      for (const name of names) {
        expect(value(text, name), `${name} of ${file}`).toBeCloseTo(value(glsl, name), 9);
      }
    }
    const options = readFileSync("../src/splat/projection.h", "utf8");
    expect(value(options, "alpha_max")).toBeCloseTo(value(glsl, "kAlphaMax"), 9);
    expect(value(options, "alpha_min")).toBeCloseTo(value(glsl, "kAlphaMin"), 9);
  });
});
