import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { Matrix4, Quaternion, Vector3 } from "three";
import { afterAll, beforeAll, describe, expect, it } from "vitest";

import type { Triple } from "../../src/model/geometry";
import type { EyePicture } from "../../src/xr/headset";
import { coverage, type Picture, psnr, readPng } from "./picture";
import { copyMadeCases } from "./made_cases";
import { clipgs, missing } from "./program";
import { Session } from "./session";
import { type Pose, Wearer } from "./wearer";

const kMinPsnr = 33;
/** How far apart the emulated headset's eyes are, m. */
const kEyes = 0.063;
/** Of a second case: in letters that no font of ours has. */
const kOtherTitle = "重ねて";

describe.skipIf(missing !== undefined)(`the headset${missing ? ` (${missing} is missing)` : ""}`, () => {
  const session = new Session();
  const errors: string[] = [];
  let page: Page;
  let wearer: Wearer;

  beforeAll(async () => {
    await session.start(async (cases) => {
      copyMadeCases(session);
      const other = ["-o", join(cases, "other.sog"), "--title", kOtherTitle];
      await clipgs("pack", join(session.folder, "scene.ply"), ...other);
      const bytes = readFileSync(join(cases, "phantom.sog"));
      writeFileSync(join(cases, "damaged.sog"), bytes.subarray(0, bytes.length / 2));
    }, "--headset");
    page = await session.openInHeadset("#case=phantom", errors);
    await page.evaluate(() => window.clipgs.ready);
    wearer = new Wearer(page);
  });

  afterAll(async () => {
    expect(errors).toEqual([]);
    expect(await session.stop(), "exit status of clipgs serve").toBe(0);
  });

  async function eyes(): Promise<EyePicture[]> {
    const seen = await page.evaluate(async () =>
      (await window.clipgs.headset.capture()).map(({ picture, camera }) => ({
        camera,
        picture: { ...picture, data: Array.from(picture.data) },
      })),
    );
    return seen.map(({ picture, camera }) => ({
      camera,
      picture: { ...picture, data: Uint8ClampedArray.from(picture.data) },
    }));
  }

  /** What `clipgs render` makes of an eye's view. */
  async function rendered({ camera }: EyePicture, ...cut: string[]): Promise<Picture> {
    const file = join(session.folder, "camera.json");
    const png = join(session.folder, "eye.png");
    writeFileSync(file, JSON.stringify(camera));
    await clipgs("render", join(session.cases, "phantom.sog"), "-o", png, "--camera", file, ...cut);
    return readPng(page, png);
  }

  const headPosition = () =>
    page.evaluate(() => {
      const { x, y, z } = window.headset.position;
      return [x, y, z] as Triple;
    });

  /** Where points (RAS mm) are in the room, where the headset looks straight ahead. */
  async function roomFromPatient(): Promise<Matrix4> {
    const { camera } = (await eyes())[0]!;
    const scale = await page.evaluate(() => window.clipgs.headset.scale);
    const patientFromEye = new Matrix4().fromArray(camera.transform_matrix.flat()).transpose();
    const head = await headPosition();
    return new Matrix4()
      .makeTranslation(head[0] - 0.5 * kEyes, head[1], head[2])
      .scale(new Vector3().setScalar(0.001 * scale))
      .multiply(patientFromEye.invert());
  }

  const cutAcross = () =>
    page.evaluate(() => {
      window.clipgs.setMode("arbitrary");
      window.clipgs.setPlane({ normal: [0, 0, -1], offset: 0 });
    });

  const normal = async () => new Vector3(...(await page.evaluate(() => window.clipgs.state.plane!.normal)));

  it("shows each eye what clipgs render makes for its pose, and the eyes not the same", async () => {
    await wearer.wear();
    await page.evaluate(() => (window.clipgs.headset.steady = false));
    for (const [plane, section] of [
      [null, "volume"],
      [[0.5, 0.3, -0.6, 10], "volume"],
      [[0.5, 0.3, -0.6, 10], "splats"],
    ] as const) {
      await page.evaluate(
        ([cut, faces]) => {
          window.clipgs.setPlane(cut && { normal: [cut[0], cut[1], cut[2]], offset: cut[3] });
          window.clipgs.setSection(faces);
        },
        [plane, section] as const,
      );
      await wearer.frames(5);
      const both = await eyes();
      expect(both.length).toBe(2);
      const middles: number[] = [];
      for (const eye of both) {
        const options = ["--section", section, ...(plane ? ["--plane", plane.join(",")] : [])];
        const truth = await rendered(eye, ...options);
        expect(coverage(truth)).toBeGreaterThan(0.02);
        const { width, height } = eye.picture;
        const data = Uint8Array.from(eye.picture.data, (v, i) => (i % 4 === 3 ? 255 : v)); // on black
        const likeness = psnr({ width, height, data }, truth).color;
        expect(likeness, `dB of ${String(plane)}, faces by ${section}`).toBeGreaterThan(kMinPsnr);
        let [sum, weight] = [0, 0];
        eye.picture.data.forEach((v, i) => {
          if (i % 4 === 0) {
            sum += v * ((i / 4) % width);
            weight += v;
          }
        });
        middles.push(sum / weight - eye.camera.cx);
      }
      // What is straight ahead lies to the right for the left eye.
      const depth = 0.8;
      const disparity = (both[0]!.camera.fl_x * kEyes) / depth;
      expect(middles[0]! - middles[1]!).toBeGreaterThan(0.5 * disparity);
      expect(middles[0]! - middles[1]!).toBeLessThan(2 * disparity);
    }
  });

  describe("in the hands", () => {
    // What hands do does not depend on the size of pictures, which take most of the time.
    beforeAll(async () => {
      await page.evaluate(() => window.clipgs.headset.leave());
      await page.setViewportSize({ width: 160, height: 120 });
    });

    it("turns the plane as the hand turns that holds it", async () => {
      await wearer.wear();
      await cutAcross();
      await wearer.frames(2);
      const toRoom = await roomFromPatient();
      const held = new Vector3(0, 0, 0).applyMatrix4(toRoom).toArray();
      await wearer.move("right", { position: held, quaternion: [0, 0, 0, 1] });
      const before = await normal();
      await wearer.press("right", "trigger", 1);
      const axis = new Vector3(1, 0, 0);
      for (let degrees = 8; degrees <= 40; degrees += 8) {
        const turn = new Quaternion().setFromAxisAngle(axis, (degrees * Math.PI) / 180);
        await wearer.move("right", { position: held, quaternion: turn.toArray() as Pose["quaternion"] });
      }
      await wearer.frames(10);
      await wearer.press("right", "trigger", 0);
      const after = await normal();
      const angle = (before.angleTo(after) * 180) / Math.PI;
      expect(angle).toBeGreaterThan(38);
      expect(angle).toBeLessThan(42);
      const inRoom = (direction: Vector3) => direction.clone().transformDirection(toRoom);
      const expected = inRoom(before).applyAxisAngle(axis, (40 * Math.PI) / 180);
      expect(inRoom(after).angleTo(expected)).toBeLessThan(0.04);
      await wearer.move("right", { position: [0.3, 1.2, -0.3], quaternion: [0, 0, 0, 1] });
      expect((await normal()).angleTo(after), "once it is let go").toBeLessThan(1e-6);
    });

    it("scales the case with two hands", async () => {
      await wearer.wear();
      const middle = new Vector3(0, 0, 0).applyMatrix4(await roomFromPatient());
      const at = (x: number): Pose => ({
        position: [middle.x + x, middle.y, middle.z],
        quaternion: [0, 0, 0, 1],
      });
      await wearer.move("left", at(-0.05));
      await wearer.move("right", at(0.05));
      await wearer.press("left", "squeeze", 1);
      await wearer.press("right", "squeeze", 1);
      for (const x of [0.06, 0.08, 0.1]) {
        await wearer.move("left", at(-x));
        await wearer.move("right", at(x));
      }
      const scale = await page.evaluate(() => window.clipgs.headset.scale);
      expect(scale).toBeGreaterThan(1.9);
      expect(scale).toBeLessThan(2.1);
      await wearer.press("left", "squeeze", 0);
      await wearer.press("right", "squeeze", 0);
      await wearer.move("right", at(0.4));
      expect(await page.evaluate(() => window.clipgs.headset.scale)).toBeCloseTo(scale, 6);
    });

    it("keeps to the states of the axis in the uniaxial mode", async () => {
      await wearer.wear();
      await page.evaluate(() => window.clipgs.setState(100));
      await wearer.frames(2);
      const before = await normal();
      const states = (await page.evaluate(() => window.clipgs.states))!;
      const position = states.first + 100 * states.spacing;
      const toRoom = await roomFromPatient();
      const held = new Vector3(...states.axis).multiplyScalar(position).applyMatrix4(toRoom);
      await wearer.move("right", { position: held.toArray(), quaternion: [0, 0, 0, 1] });
      await wearer.press("right", "trigger", 1);
      const scale = await page.evaluate(() => window.clipgs.headset.scale);
      const up = new Vector3(...states.axis).transformDirection(toRoom).multiplyScalar(0.02 * scale);
      const target = held.clone().add(up).toArray();
      await wearer.move("right", { position: target, quaternion: [0, 0, 0, 1] });
      await wearer.frames(10);
      const state = (await page.evaluate(() => window.clipgs.state.state))!;
      expect(Math.abs((state - 100) * states.spacing - 20)).toBeLessThan(1 + states.spacing);
      const turned = new Quaternion().setFromAxisAngle(new Vector3(1, 0, 0), 0.5).toArray();
      await wearer.move("right", { position: target, quaternion: turned as Pose["quaternion"] });
      await wearer.press("right", "trigger", 0);
      expect((await normal()).angleTo(before)).toBeLessThan(1e-6);
    });

    it("is used with bare hands as with controllers", async () => {
      await wearer.wear();
      await wearer.use("hand");
      await cutAcross();
      await wearer.frames(2);
      const held = new Vector3(0, 0, 0).applyMatrix4(await roomFromPatient()).toArray();
      await wearer.moveBare("right", { position: held, quaternion: [0, 0, 0, 1] });
      await wearer.pinch("right", 1);
      await wearer.frames(10); // closing, the emulated hand turns a little
      const before = await normal();
      for (let degrees = 8; degrees <= 40; degrees += 8) {
        const turn = new Quaternion().setFromAxisAngle(new Vector3(1, 0, 0), (degrees * Math.PI) / 180);
        await wearer.moveBare("right", { position: held, quaternion: turn.toArray() as Pose["quaternion"] });
      }
      await wearer.frames(10);
      const angle = (before.angleTo(await normal()) * 180) / Math.PI;
      expect(angle).toBeGreaterThan(38);
      expect(angle).toBeLessThan(42);
      await wearer.pinch("right", 0);
      await wearer.use("controller");
    });

    it("measures between two points of a face, and says their values", async () => {
      await wearer.wear();
      await cutAcross();
      await wearer.pressText("right", "Faces");
      await wearer.pressText("right", "Measure");
      const toRoom = await roomFromPatient();
      const plane = await page.evaluate(() => window.clipgs.state.plane);
      for (const [r, a] of [
        [-30, 10],
        [20, 10],
      ] as const) {
        await wearer.pressAt("right", new Vector3(r, a, 0).applyMatrix4(toRoom).toArray());
      }
      const [length] = await page.evaluate(() => window.clipgs.lengths);
      expect(length!.mm).toBeGreaterThan(49);
      expect(length!.mm).toBeLessThan(51);
      expect(Math.abs(length!.from[2])).toBeLessThan(1e-3);
      expect(await page.evaluate(() => window.clipgs.state.plane), "nothing is held meanwhile").toEqual(
        plane,
      );
      const find = (text: string) => page.evaluate((t) => window.clipgs.headset.find(t), text);
      const middle = new Vector3(-5, 10, 0).applyMatrix4(toRoom);
      await expect.poll(async () => await find(`${length!.mm.toFixed(1)} mm`)).not.toBeNull();
      const tag = new Vector3(...(await find(`${length!.mm.toFixed(1)} mm`))!);
      expect(tag.distanceTo(middle)).toBeLessThan(0.06);
      const [pin] = await page.evaluate(() => window.clipgs.pins);
      expect(pin!.text).toMatch(/ HU$/);
      expect(await find(pin!.text)).not.toBeNull();
      await wearer.pressText("right", "Unpin");
      await wearer.pressText("right", "Unpin");
      expect(await page.evaluate(() => window.clipgs.pins)).toEqual([]);
    });

    it("is worked by its panel: planes, undo, and the menu of cases", async () => {
      await wearer.wear();
      await cutAcross();
      await wearer.pressText("right", "Cut");
      await wearer.pressText("right", "Coronal");
      await expect.poll(async () => (await normal()).y).toBeLessThan(-0.99);
      await wearer.pressText("left", "Undo");
      await expect.poll(async () => (await normal()).z).toBeLessThan(-0.99);

      const shown = () => page.evaluate(() => window.clipgs.state.case);
      const message = () => page.evaluate(() => window.clipgs.headset.message);
      await wearer.pressText("right", "Cases");
      await wearer.pressText("right", kOtherTitle);
      await expect.poll(shown).toBe("other");
      expect((await normal()).z, "the plane stays as it is").toBeLessThan(-0.99);
      await wearer.pressText("right", "damaged");
      await expect.poll(message).toContain("damaged");
      expect(await shown()).toBe("other");
      await wearer.pressText("right", "Torso phantom");
      await expect.poll(shown).toBe("phantom");
      expect(await message()).toBe("");
      await wearer.pressText("right", "View");
      await wearer.pressText("right", "Take off");
      await page.waitForFunction(() => !window.clipgs.headset.worn);
    });

    it("draws less where frames come late, and all where it need not be steady", async () => {
      await wearer.wear();
      const drawn = () => page.evaluate(() => window.clipgs.stats.drawn);
      await page.evaluate(() => {
        window.clipgs.setPlane(null);
        window.clipgs.headset.steady = false;
      });
      await wearer.frames(5);
      const all = await drawn();
      await page.evaluate(() => (window.clipgs.headset.steady = true));
      // No software renderer holds 72 frames a second.
      await expect.poll(() => page.evaluate(() => window.clipgs.headset.effort.leastPixels)).toBe(3);
      await expect.poll(drawn).toBeLessThan(0.99 * all);
      await wearer.pressText("right", "View");
      const said = await page.evaluate(
        ({ drawn: some, total }) =>
          [some, total].map((n) => String(n).replace(/\B(?=(\d{3})+$)/g, "\u202f")).join(" of "),
        await page.evaluate(() => window.clipgs.stats),
      );
      const text = `${said} splats, 50 % resolution, to 2.2 σ, from 3 px`;
      await expect.poll(() => page.evaluate((t) => window.clipgs.headset.find(t), text)).not.toBeNull();
      await wearer.pressText("right", "Steady");
      await wearer.frames(5);
      await expect.poll(drawn).toBe(all);
    });

    it("has letters where the patient's sides are", async () => {
      await wearer.wear();
      const { min, max } = await page.evaluate(() => window.clipgs.bounds!);
      const center = min.map((v, k) => 0.5 * (v + max[k]!)) as Triple;
      const toRoom = await roomFromPatient();
      for (const [letter, axis, end] of [
        ["R", 0, max],
        ["L", 0, min],
        ["A", 1, max],
        ["P", 1, min],
        ["S", 2, max],
        ["I", 2, min],
      ] as const) {
        const side = [...center] as Triple;
        side[axis] = end[axis]!;
        const at = new Vector3(...(await page.evaluate((text) => window.clipgs.headset.find(text)!, letter)));
        const beyond = at.applyMatrix4(toRoom.clone().invert()).sub(new Vector3(...side));
        const out = beyond.getComponent(axis) * Math.sign(end[axis]! - center[axis]!);
        expect(out, letter).toBeGreaterThan(0);
        expect(out, letter).toBeLessThan(60);
        expect(beyond.setComponent(axis, 0).length(), letter).toBeLessThan(1);
      }
    });

    it("can be taken off and put on again", async () => {
      await wearer.wear();
      await page.evaluate(() => window.clipgs.headset.leave());
      await page.waitForFunction(() => !window.clipgs.headset.worn);
      const flat = await page.evaluate(async () =>
        Array.from((await window.clipgs.renderToPixels(128, 128)).data),
      );
      expect(coverage({ width: 128, height: 128, data: Uint8Array.from(flat) })).toBeGreaterThan(0.1);
      await wearer.wear();
      expect(await page.evaluate(() => window.clipgs.headset.scale)).toBe(1);
    });
  });
});
