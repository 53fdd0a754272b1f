import { writeFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { Matrix4, Quaternion, Vector3 } from "three";
import { afterAll, beforeAll, describe, expect, it } from "vitest";

import type { Triple } from "../../src/model/geometry";
import type { EyePicture } from "../../src/xr/headset";
import { coverage, type Picture, psnr, readPng } from "./picture";
import { clipgs, makePhantomCase, missing, Session } from "./session";

const kMinPsnr = 33;
/** How far apart the emulated headset's eyes are, m. */
const kEyes = 0.063;

type Side = "left" | "right";
type Pose = { position: Triple; quaternion: [number, number, number, number] };

describe.skipIf(missing !== undefined)(`the headset${missing ? ` (${missing} is missing)` : ""}`, () => {
  const session = new Session();
  const errors: string[] = [];
  let page: Page;

  beforeAll(async () => {
    await session.start(async (cases) => {
      await makePhantomCase(session.folder, join(cases, "phantom.sog"));
    });
    page = await session.openInHeadset("#case=phantom", errors);
    await page.evaluate(() => window.clipgs.ready);
  });

  afterAll(async () => {
    expect(errors).toEqual([]);
    expect(await session.stop(), "exit status of clipgs serve").toBe(0);
  });

  async function wear(): Promise<void> {
    if (!(await page.evaluate(() => window.clipgs.headset.worn))) {
      await expect.poll(() => page.getByTitle("Show it in the headset (V)").count()).toBe(1);
      await page.keyboard.press("v");
      await page.waitForFunction(() => window.clipgs.headset.worn);
    }
    await frames(3);
  }

  /** Waits until the headset has drawn so many pictures, and sorted for the last one. */
  async function frames(count: number): Promise<void> {
    await page.evaluate(async (n) => {
      for (let i = 0; i < n; ++i) {
        await window.clipgs.headset.capture();
      }
    }, count);
  }

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

  async function moveHand(side: Side, { position, quaternion }: Pose): Promise<void> {
    await page.evaluate(
      ([which, [x, y, z], [qx, qy, qz, qw]]) => {
        const hand = window.headset.controllers[which]!;
        hand.position.set(x, y, z);
        hand.quaternion.set(qx, qy, qz, qw);
      },
      [side, position, quaternion] as const,
    );
    await frames(2);
  }

  async function press(side: Side, button: "trigger" | "squeeze", value: 0 | 1): Promise<void> {
    await page.evaluate(
      ([which, name, pressed]) => window.headset.controllers[which]!.updateButtonValue(name, pressed),
      [side, button, value] as const,
    );
    await frames(2);
  }

  const normal = async () => new Vector3(...(await page.evaluate(() => window.clipgs.state.plane!.normal)));

  it("shows each eye what clipgs render makes for its pose, and the eyes not the same", async () => {
    await wear();
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
      await frames(5);
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

  it("turns the plane as the hand turns that holds it", async () => {
    await wear();
    await page.evaluate(() => {
      window.clipgs.setMode("arbitrary");
      window.clipgs.setPlane({ normal: [0, 0, -1], offset: 0 });
    });
    await frames(2);
    const toRoom = await roomFromPatient();
    const held = new Vector3(0, 0, 0).applyMatrix4(toRoom).toArray();
    await moveHand("right", { position: held, quaternion: [0, 0, 0, 1] });
    const before = await normal();
    await press("right", "trigger", 1);
    const axis = new Vector3(1, 0, 0);
    for (let degrees = 8; degrees <= 40; degrees += 8) {
      const turn = new Quaternion().setFromAxisAngle(axis, (degrees * Math.PI) / 180);
      await moveHand("right", { position: held, quaternion: turn.toArray() as Pose["quaternion"] });
    }
    await frames(10);
    await press("right", "trigger", 0);
    const after = await normal();
    const angle = (before.angleTo(after) * 180) / Math.PI;
    expect(angle).toBeGreaterThan(38);
    expect(angle).toBeLessThan(42);
    const inRoom = (direction: Vector3) => direction.clone().transformDirection(toRoom);
    const expected = inRoom(before).applyAxisAngle(axis, (40 * Math.PI) / 180);
    expect(inRoom(after).angleTo(expected)).toBeLessThan(0.04);
    await moveHand("right", { position: [0.3, 1.2, -0.3], quaternion: [0, 0, 0, 1] });
    expect((await normal()).angleTo(after), "once it is let go").toBeLessThan(1e-6);
  });

  it("scales the case with two hands", async () => {
    await wear();
    const middle = new Vector3(0, 0, 0).applyMatrix4(await roomFromPatient());
    const at = (x: number): Pose => ({
      position: [middle.x + x, middle.y, middle.z],
      quaternion: [0, 0, 0, 1],
    });
    await moveHand("left", at(-0.05));
    await moveHand("right", at(0.05));
    await press("left", "squeeze", 1);
    await press("right", "squeeze", 1);
    for (const x of [0.06, 0.08, 0.1]) {
      await moveHand("left", at(-x));
      await moveHand("right", at(x));
    }
    const scale = await page.evaluate(() => window.clipgs.headset.scale);
    expect(scale).toBeGreaterThan(1.9);
    expect(scale).toBeLessThan(2.1);
    await press("left", "squeeze", 0);
    await press("right", "squeeze", 0);
    await moveHand("right", at(0.4));
    expect(await page.evaluate(() => window.clipgs.headset.scale)).toBeCloseTo(scale, 6);
  });

  it("keeps to the states of the axis in the uniaxial mode", async () => {
    await wear();
    await page.evaluate(() => window.clipgs.setState(100));
    await frames(2);
    const before = await normal();
    const states = (await page.evaluate(() => window.clipgs.states))!;
    const position = states.first + 100 * states.spacing;
    const toRoom = await roomFromPatient();
    const held = new Vector3(...states.axis).multiplyScalar(position).applyMatrix4(toRoom);
    await moveHand("right", { position: held.toArray(), quaternion: [0, 0, 0, 1] });
    await press("right", "trigger", 1);
    const scale = await page.evaluate(() => window.clipgs.headset.scale);
    const up = new Vector3(...states.axis).transformDirection(toRoom).multiplyScalar(0.02 * scale);
    const target = held.clone().add(up).toArray();
    await moveHand("right", { position: target, quaternion: [0, 0, 0, 1] });
    await frames(10);
    const state = (await page.evaluate(() => window.clipgs.state.state))!;
    expect(Math.abs((state - 100) * states.spacing - 20)).toBeLessThan(1 + states.spacing);
    const turned = new Quaternion().setFromAxisAngle(new Vector3(1, 0, 0), 0.5).toArray();
    await moveHand("right", { position: target, quaternion: turned as Pose["quaternion"] });
    await press("right", "trigger", 0);
    expect((await normal()).angleTo(before)).toBeLessThan(1e-6);
  });

  it("is used with bare hands as with controllers", async () => {
    await wear();
    await page.evaluate(() => {
      window.headset.primaryInputMode = "hand";
      window.clipgs.setMode("arbitrary");
      window.clipgs.setPlane({ normal: [0, 0, -1], offset: 0 });
    });
    await frames(5);
    const pinch = async (value: number) => {
      await page.evaluate((v) => window.headset.hands["right"]!.updatePinchValue(v), value);
      await frames(3);
    };
    const moveBare = async ({ position, quaternion }: Pose) => {
      await page.evaluate(
        ([[x, y, z], [qx, qy, qz, qw]]) => {
          const hand = window.headset.hands["right"]!;
          hand.position.set(x, y, z);
          hand.quaternion.set(qx, qy, qz, qw);
        },
        [position, quaternion] as const,
      );
      await frames(3);
    };
    const held = new Vector3(0, 0, 0).applyMatrix4(await roomFromPatient()).toArray();
    await moveBare({ position: held, quaternion: [0, 0, 0, 1] });
    await pinch(1);
    await frames(10); // closing, the emulated hand turns a little
    const before = await normal();
    for (let degrees = 8; degrees <= 40; degrees += 8) {
      const turn = new Quaternion().setFromAxisAngle(new Vector3(1, 0, 0), (degrees * Math.PI) / 180);
      await moveBare({ position: held, quaternion: turn.toArray() as Pose["quaternion"] });
    }
    await frames(10);
    const angle = (before.angleTo(await normal()) * 180) / Math.PI;
    expect(angle).toBeGreaterThan(38);
    expect(angle).toBeLessThan(42);
    await pinch(0);
    await page.evaluate(() => (window.headset.primaryInputMode = "controller"));
    await frames(3);
  });

  it("can be taken off and put on again", async () => {
    await wear();
    await page.evaluate(() => window.clipgs.headset.leave());
    await page.waitForFunction(() => !window.clipgs.headset.worn);
    const flat = await page.evaluate(async () =>
      Array.from((await window.clipgs.renderToPixels(128, 128)).data),
    );
    expect(coverage({ width: 128, height: 128, data: Uint8Array.from(flat) })).toBeGreaterThan(0.1);
    await wear();
    expect(await page.evaluate(() => window.clipgs.headset.scale)).toBe(1);
  });
});
