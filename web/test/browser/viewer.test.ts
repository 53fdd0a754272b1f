import { copyFileSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";

import type { Triple } from "../../src/model/geometry";
import { coverage, pagePicture, type Picture, psnr, readPng } from "./picture";
import { copyMadeCases } from "./made_cases";
import { clipgs, missing } from "./program";
import { loseGpu, Session } from "./session";
import { choose, rendered, renderedAndPrinted, type Shot, show, valueAt } from "./shot";

const kMinPsnr = 35;
const kMinAlike = 50; // of pictures that are drawn alike, pixel by pixel
const kMinCued = 45; // the same where what is faint is rounded twice
const kMinMoving = 31; // of a picture with a quarter of the rays
/** Whole, across an opaque face, and along one whose edge ends at splats. */
const kMovingShots: Pick<Shot, "view" | "plane">[] = [
  { view: [35, 20, 2], plane: null },
  { view: [35, 20, 2], plane: [0.5, 0.3, -0.6, 10] },
  { view: [60, 10, 3], plane: [-1, 0, 0, -20] },
];

describe.skipIf(missing !== undefined)(`the viewer${missing ? ` (${missing} is missing)` : ""}`, () => {
  const session = new Session();
  const errors: string[] = [];
  let page: Page;

  beforeAll(async () => {
    await session.start(() => copyMadeCases(session));
    page = await session.open("#case=phantom", errors);
    await page.evaluate(() => window.clipgs.ready);
  });

  afterAll(async () => {
    expect(await session.stop(), "exit status of clipgs serve").toBe(0);
  });

  const removeMarks = () =>
    page.evaluate(() => window.clipgs.marks.forEach(({ id }) => window.clipgs.removeMark(id)));

  it("shows on the page what it gives to scripts", async () => {
    const framed = await session.open(
      "#case=phantom&view=35,20&plane=0,-1,0,0&clip=soft&size=256x256",
      errors,
      { width: 256, height: 256, scale: 1 },
    );
    await framed.evaluate(() => window.clipgs.ready);
    const picture = await pagePicture(framed, 256, 256);
    const path = join(session.folder, "page.png");
    // Without the handle and the label; of a fixed size, the picture is on black.
    await framed.addStyleTag({ content: "footer { display: none }" });
    await framed.keyboard.press("h");
    await settled(framed);
    await framed.screenshot({ path, clip: { x: 0, y: 0, width: 256, height: 256 } });
    const shown = readPng(path);
    expect(psnr(shown, { ...picture, data: onBlack(picture.data) }).color).toBeGreaterThan(kMinPsnr);
    expect(await framed.evaluate(() => window.clipgs.state.clip)).toBe("soft");
    await framed.close();
  });

  it("draws faces from the volume unless the link or a button says otherwise", async () => {
    const state = () => page.evaluate(() => window.clipgs.state.section);
    await show(page, { view: [20, 15, 1], plane: [0, -1, 0, 0], clip: "exact" });
    expect(await page.evaluate(() => window.clipgs.stats.sectionBytes)).toBeGreaterThan(1e5);
    const volume = await pagePicture(page, 160, 160);
    await page.getByRole("group", { name: "Cut face" }).getByRole("button", { name: "Splats" }).click();
    expect(await state()).toBe("splats");
    expect(psnr(await pagePicture(page, 160, 160), volume).color).toBeLessThan(45);
    await page.waitForFunction(() => location.hash.includes("section=splats"));
    const linked = await session.open(await hashOf(page), errors);
    await linked.evaluate(() => window.clipgs.ready);
    expect(await linked.evaluate(() => window.clipgs.state.section)).toBe("splats");
    await linked.close();
    await page.getByRole("group", { name: "Cut face" }).getByRole("button", { name: "Volume" }).click();
    expect(await state()).toBe("volume");
  });

  it("shows while something moves what it shows at rest, though of fewer splats' pixels", async () => {
    const [width, height] = [127, 95]; // not whole pixels of splats
    for (const { view, plane } of kMovingShots) {
      await show(page, { view, plane, clip: "exact", section: "volume" });
      const still = await pagePicture(page, width, height);
      const moving = await pagePicture(page, width, height, true);
      expect(psnr(moving, still).color).toBeGreaterThan(kMinMoving);
    }
  });

  it("leaves out the body, the faces and marks, as its buttons say", async () => {
    await show(page, { view: [20, 15, 1], plane: [0, -1, 0, 0], clip: "exact" });
    const layer = (name: string) => page.getByRole("group", { name: "Layers" }).getByRole("button", { name });
    const whole = await pagePicture(page, 160, 160);
    await layer("Body").click();
    const face = await pagePicture(page, 160, 160);
    expect(coverage(face)).toBeGreaterThan(0.1);
    expect(coverage(face)).toBeLessThan(0.9 * coverage(whole));
    expect(await layer("Body").getAttribute("aria-pressed")).toBe("false");
    await page.keyboard.press("o");
    expect(psnr(await pagePicture(page, 160, 160), whole).color).toBe(Infinity);
    await layer("Cut faces").click();
    expect(psnr(await pagePicture(page, 160, 160), whole).color).toBeLessThan(45);
    await layer("Cut faces").click();
    await layer("Marks").click();
    expect(await page.evaluate(() => window.clipgs.state.layers)).toEqual({
      body: true,
      faces: true,
      marks: false,
    });
    await layer("Marks").click();
  });

  it("shows faces in grey, with windows by buttons, numbers and keys", async () => {
    const state = () => page.evaluate(() => window.clipgs.state);
    await show(page, { view: [20, 15, 1], plane: [0, -1, 0, 0], clip: "exact" });
    expect(await page.getByRole("group", { name: "Window" }).isVisible()).toBe(false);
    await page.keyboard.press("g");
    expect((await state()).grey).toBe(1);
    const marks = page.getByRole("img", {
      name: /left R.*, right L.*, top S.*, bottom I.* Scale bar: \d+ mm/,
    });
    await marks.waitFor();
    const soft = await pagePicture(page, 160, 160);
    await page.getByRole("group", { name: "Window" }).getByRole("button", { name: "Bone" }).click();
    expect((await state()).window).toEqual({ center: 400, width: 1800 });
    expect(psnr(await pagePicture(page, 160, 160), soft).color).toBeLessThan(40);
    await page.keyboard.press("w");
    expect((await state()).window).toEqual({ center: -600, width: 1500 });
    await page.getByRole("spinbutton", { name: "Width of the window" }).fill("300");
    await page.keyboard.press("Enter");
    expect((await state()).window).toEqual({ center: -600, width: 300 });
    await page.waitForFunction(() => location.hash.includes("grey=1&window=-600,300"));
    await page.locator("canvas.stage").focus();
    await page.keyboard.press("g");
    expect((await state()).grey).toBe(0);
    await marks.waitFor({ state: "hidden" });
  });

  it("fades what is far away as clipgs render does, before the background that its panel offers", async () => {
    const shot = { view: [35, 20, 1], plane: [0.5, 0.3, -0.6, 10], clip: "exact" } as const;
    const corner = async () => {
      const path = join(session.folder, "corner.png");
      await settled(page);
      await page.screenshot({ path, clip: { x: 8, y: 200, width: 8, height: 8 } });
      return [...readPng(path).data.subarray(0, 3)];
    };
    for (const section of ["volume", "splats"] as const) {
      await show(page, { ...shot, view: [...shot.view], plane: [...shot.plane], section });
      const plain = await pagePicture(page, 210, 154);
      await page.evaluate(() => window.clipgs.setDepthCue(0.8));
      const cued = await pagePicture(page, 210, 154);
      const truth = await rendered(
        session,
        { ...shot, view: [...shot.view], plane: [...shot.plane], section },
        "210x154",
        ["--depth-cue", "0.8"],
      );
      expect(psnr(cued, plain).color, section).toBeLessThan(30);
      expect(psnr(cued, truth).color, section).toBeGreaterThan(kMinCued);
      expect(psnr(cued, truth).alpha, section).toBeGreaterThan(kMinCued);
      await page.evaluate(() => window.clipgs.setDepthCue(0));
    }
    const background = page.getByRole("combobox", { name: "Background" });
    await background.selectOption("White");
    expect(await page.evaluate(() => window.clipgs.state.background)).toBe("white");
    expect((await corner()).every((value) => value >= 254)).toBe(true);
    expect(await page.locator(".viewer.light").count()).toBe(1);
    await page.getByRole("slider", { name: /^Depth/ }).fill("0.5");
    expect(await page.evaluate(() => window.clipgs.state.depthCue)).toBe(0.5);
    await page.waitForFunction(() => location.hash.includes("background=white&depth-cue=0.5"));
    const linked = await session.open(await hashOf(page), errors);
    await linked.evaluate(() => window.clipgs.ready);
    expect(await linked.evaluate(() => window.clipgs.state.background)).toBe("white");
    expect(await linked.evaluate(() => window.clipgs.state.depthCue)).toBe(0.5);
    await linked.close();
    expect(await page.evaluate(() => window.clipgs.setBackground("pink"))).toBe(false);
    await page.evaluate(() => window.clipgs.setDepthCue(0));
    await background.selectOption("Black");
    expect((await corner()).every((value) => value <= 1)).toBe(true);
    expect(await page.locator(".viewer.light").count()).toBe(0);
    await background.selectOption({ index: 0 });
    expect(await page.evaluate(() => window.clipgs.state.background)).toBe(null);
  });

  it("offers lights as soon as they can be chosen", async () => {
    const fresh = await session.open("#case=phantom&plane=0,0,-1,0", errors);
    await fresh.getByRole("combobox", { name: /^Light/ }).waitFor();
    await fresh.close();
  });

  it("is lit by a lamp in hand, from where it is held, and by lights that are turned", async () => {
    const state = () => page.evaluate(() => window.clipgs.state);
    /** How much brighter the left half of the picture is than the right one. */
    const leftward = async () => {
      const { data, width, height } = await pagePicture(page, 128, 128);
      const sum = (from: number, to: number) => {
        let light = 0;
        for (let y = 0; y < height; ++y) {
          for (let x = from; x < to; ++x) {
            const at = 4 * (y * width + x);
            light += (data[at + 1]! * data[at + 3]!) / 255;
          }
        }
        return light;
      };
      return sum(0, 64) / sum(64, 128);
    };
    await show(page, { view: [0, 0, 1], plane: null, clip: "exact" });
    const made = await leftward();
    const light = page.getByRole("combobox", { name: /^Light/ });
    await light.selectOption("Lamp in hand");
    const pad = page.getByRole("slider", { name: "Where the lamp shines from" });
    const { x, y, width, height } = (await pad.boundingBox())!;
    const drag = async (right: number, up: number) => {
      await page.mouse.move(x + 0.5 * width, y + 0.5 * height);
      await page.mouse.down();
      await page.mouse.move(x + (0.5 + right) * width, y + (0.5 - up) * height, { steps: 3 });
      await page.mouse.up();
    };
    await drag(-0.28, 0); // seen from the front the patient's right is to the left
    expect((await state()).lamp![0]).toBeGreaterThan(0.9);
    expect(await leftward()).toBeGreaterThan(1.2 * made);
    await drag(0.28, 0);
    expect((await state()).lamp![0]).toBeLessThan(-0.9);
    expect(await leftward()).toBeLessThan(made / 1.2);
    expect(await pad.getAttribute("aria-valuetext")).toMatch(/degrees from the camera, right$/);
    await pad.press("ArrowUp");
    expect((await state()).lamp![2]).toBeGreaterThan(0.05);
    // Not the first drag's link: the address follows when all has been still for a while.
    await page.waitForFunction(
      (right) => Math.abs(Number(/lamp=([-\d.]+)/.exec(location.hash)?.[1]) - right) < 0.01,
      (await state()).lamp![0],
    );
    const linked = await session.open(await hashOf(page), errors);
    await linked.evaluate(() => window.clipgs.ready);
    expect(await linked.evaluate(() => window.clipgs.state.lamp![0])).toBeCloseTo(
      (await state()).lamp![0],
      2,
    );
    await linked.close();
    await page.waitForTimeout(1000); // a movement is one step of the history
    await light.selectOption("As the case was made");
    expect((await state()).lamp).toBe(null);
    await page.getByLabel("Turn the light, degrees").fill("90");
    expect((await state()).turn).toBe(90);
    expect(Math.abs((await leftward()) / made - 1)).toBeGreaterThan(0.03);
    await page.waitForTimeout(1000);
    await page.keyboard.press("Control+z");
    expect((await state()).turn).toBe(0);
    await page.evaluate(() => window.clipgs.setTurn(0));
  });

  it("shows walls, clay or values where grey faces open, as its buttons say", async () => {
    await show(page, { view: [35, 20, 1], plane: [0, -1, 0, 0], clip: "exact", grey: 1 });
    const group = page.getByRole("group", { name: "Openings" });
    const pictures = [];
    for (const [label, openings] of [
      ["Lit", "cinematic"],
      ["Clay", "neutral"],
      ["Values", "values"],
    ] as const) {
      await group.getByRole("button", { name: label }).click();
      expect(await page.evaluate(() => window.clipgs.state.openings)).toBe(openings);
      pictures.push(await pagePicture(page, 128, 128));
    }
    const colored = ({ data }: Picture, more: number, less: number) =>
      data.filter((v, i) => i % 4 === more && v > data[i - more + less]! + 25).length;
    const [lit, clay, values] = pictures as [Picture, Picture, Picture];
    expect(colored(lit, 0, 2)).toBeGreaterThan(colored(values, 0, 2) + 200); // red
    expect(colored(clay, 2, 0)).toBeGreaterThan(colored(values, 2, 0) + 200); // blue
    await page.evaluate(() => window.clipgs.setGrey(0));
    await page.evaluate(() => window.clipgs.setOpenings("cinematic"));
  });

  it("drags the window with the right button on a grey face, and moves the view elsewhere", async () => {
    const state = () => page.evaluate(() => window.clipgs.state.window!);
    const pan = () => page.evaluate(() => window.clipgs.project([0, 0, 0])!.x);
    const { center } = await readBounds(session.cases);
    const drag = async (from: Triple, shift = false) => {
      const at = await page.evaluate((p) => window.clipgs.project(p)!, from);
      await page.mouse.move(at.x, at.y);
      if (shift) {
        await page.keyboard.down("Shift");
      }
      await page.mouse.down({ button: "right" });
      await page.mouse.move(at.x + 30, at.y - 20, { steps: 3 });
      await page.mouse.up({ button: "right" });
      await page.keyboard.up("Shift");
    };
    const face: Triple = [center[0], center[1], 0];
    await show(page, { view: [10, 60, 1], plane: [0, 0, -1, 0], clip: "exact", grey: 1, shades: [40, 400] });
    const before = await pan();
    await drag(face);
    expect((await state()).width).toBeGreaterThan(440);
    expect((await state()).center).toBeGreaterThan(50);
    expect(await pan()).toBe(before);
    await drag(face, true);
    expect(await pan()).toBeGreaterThan(before + 20);
    await show(page, { view: [10, 60, 1], plane: [0, 0, -1, 0], clip: "exact", grey: 0, shades: [40, 400] });
    await drag(face);
    expect(await pan()).toBeGreaterThan(before + 20);
    expect(await state()).toEqual({ center: 40, width: 400 });
  });

  it("says values under the pointer and of points as clipgs render does", async () => {
    await show(page, { view: [10, 60, 1], plane: [0, 0, -1, 0], clip: "exact" });
    const { center } = await readBounds(session.cases);
    const reading = page.getByLabel("Value under the pointer");
    const labels = page.getByRole("list", { name: "Marks" });
    for (const [r, a] of [
      [0, 0],
      [31, 12],
      [-20, 24],
    ] as const) {
      const at = await page.evaluate((p) => window.clipgs.project(p)!, [
        center[0] + r,
        center[1] + a,
        0,
      ] as Triple);
      await page.mouse.move(at.x, at.y);
      await reading.waitFor();
      await page.keyboard.press("i");
      const mark = (await page.evaluate(() => window.clipgs.marks)).at(-1)!;
      const [point] = mark.points as [Triple];
      expect(point[0]).toBeCloseTo(center[0] + r, 0);
      expect(point[2]).toBeCloseTo(0, 3);
      const value = await valueAt(session, point);
      expect(value).toMatch(/ HU$/);
      expect(mark.text.replace("\u2212", "-")).toBe(value);
      expect(await reading.textContent()).toContain(mark.text);
      await expect.poll(() => labels.getByRole("button").last().textContent()).toBe(mark.text);
    }
    await page.mouse.move(5, 300);
    await reading.waitFor({ state: "hidden" });
    await expect.poll(() => labels.locator(".faded").count()).toBe(0);
    await show(page, { view: [10, 60, 1], plane: [0, 0, -1, 20], clip: "exact" });
    await expect.poll(() => labels.locator(".faded").count()).toBe(3);
    await removeMarks();

    await page
      .getByRole("group", { name: "Mark", exact: true })
      .getByRole("button", { name: "Point" })
      .click();
    const view = await page.evaluate(() => window.clipgs.state.view);
    const at = await page.evaluate((p) => window.clipgs.project(p)!, [center[0], center[1], -20] as Triple);
    await page.mouse.click(at.x, at.y);
    await expect.poll(() => labels.getByRole("listitem").count()).toBe(1);
    expect(await page.evaluate(() => window.clipgs.state.view)).toEqual(view);
    const air: Triple = [1000, 0, 0];
    expect(await page.evaluate((p) => window.clipgs.addMark({ kind: "point", points: [p] }), air)).toBeNull();
    await removeMarks();
  });

  it("measures lengths, angles, circles and outlines on a face, with labels that keep clear of each other", async () => {
    await show(page, { view: [10, 60, 1], plane: [0, 0, -1, 0], clip: "exact" });
    const { center } = await readBounds(session.cases);
    const press = async (points: readonly (readonly [number, number])[]) => {
      for (const [r, a] of points) {
        const { x, y } = await page.evaluate((p) => window.clipgs.project(p)!, [
          center[0] + r,
          center[1] + a,
          0,
        ] as Triple);
        await page.mouse.click(x, y);
      }
    };
    const tool = (name: string) =>
      page
        .getByRole("group", { name: "Mark", exact: true })
        .getByRole("button", { name, exact: true })
        .click();
    const marks = () => page.evaluate(() => window.clipgs.marks);
    const view = await page.evaluate(() => window.clipgs.state.view);
    await tool("Length");
    await press([
      [-30, 0],
      [10, 30],
    ]);
    await tool("Angle");
    await press([
      [-30, 0],
      [0, 0],
      [0, 30],
    ]);
    await tool("Circle");
    await press([
      [0, 0],
      [10, 0],
    ]);
    await tool("Outline");
    await press([
      [-20, -20],
      [20, -20],
      [20, 10],
      [-20, 10],
      [-20, -20],
    ]);
    const [length, angle, circle, outline] = await marks();
    expect(length!.mm).toBeCloseTo(50, 0);
    expect(length!.text).toBe(`${length!.mm!.toFixed(1)} mm`);
    expect(Math.abs(angle!.degrees! - 90)).toBeLessThan(5);
    expect(circle!.area! / (100 * Math.PI)).toBeGreaterThan(0.8);
    expect(circle!.area! / (100 * Math.PI)).toBeLessThan(1.2);
    expect(outline!.area! / 1200).toBeGreaterThan(0.9);
    expect(outline!.area! / 1200).toBeLessThan(1.1);
    expect(outline!.mean).not.toBeNull();
    expect(outline!.text).toContain(" cm² · mean ");
    expect(await page.evaluate(() => window.clipgs.state.view)).toEqual(view);
    await page.waitForFunction(() => /&length=.*&angle=.*&region=.*&outline=/.test(location.hash));

    const labels = page.getByRole("list", { name: "Marks" }).getByRole("listitem");
    await expect.poll(() => labels.count()).toBe(4);
    const boxes = await Promise.all((await labels.all()).map(async (label) => (await label.boundingBox())!));
    boxes.forEach((a, i) =>
      boxes.slice(i + 1).forEach((b) => {
        const apart =
          a.x + a.width <= b.x || b.x + b.width <= a.x || a.y + a.height <= b.y || b.y + b.height <= a.y;
        expect(apart, JSON.stringify([a, b])).toBe(true);
      }),
    );
    await removeMarks();

    const at = async (r: number, a: number) => {
      const { x, y } = await page.evaluate((p) => window.clipgs.project(p)!, [
        center[0] + r,
        center[1] + a,
        0,
      ] as Triple);
      await page.mouse.move(x, y);
    };
    await at(10, -20);
    await page.keyboard.press("l"); // from here
    await at(10, 0);
    await page.keyboard.press("l"); // to there
    expect((await marks())[0]!.mm).toBeCloseTo(20, 0);
    await removeMarks();
  });

  it("names marks, removes them by a button alone, and brings them back", async () => {
    await show(page, { view: [10, 60, 1], plane: [0, 0, -1, 0], clip: "exact" });
    const { center } = await readBounds(session.cases);
    const points = [
      [center[0] - 20, center[1], 0],
      [center[0] + 20, center[1], 0],
    ] as Triple[];
    await page.evaluate((all) => window.clipgs.addMark({ kind: "length", points: all }), points);
    const label = page.getByRole("list", { name: "Marks" }).getByRole("button");
    const marks = () => page.evaluate(() => window.clipgs.marks);
    await label.click();
    const card = page.getByRole("region", { name: "Mark", exact: true });
    await card.getByLabel("Name").fill("Nodule axis");
    await card.getByLabel("Note").fill("grown since May");
    expect((await marks())[0]).toMatchObject({ name: "Nodule axis", note: "grown since May" });
    await expect.poll(() => label.textContent()).toBe("Nodule axis · 40.0 mm");
    await label.click(); // once more
    await card.waitFor({ state: "hidden" });
    expect((await marks()).length).toBe(1);
    await page.waitForFunction(() => location.hash.includes("name=Nodule%20axis&note=grown"));

    await page.getByRole("button", { name: /^Remove Nodule axis/ }).click();
    expect(await marks()).toEqual([]);
    await page.locator("canvas.stage").focus();
    await page.keyboard.press("Control+z");
    expect((await marks())[0]!.name).toBe("Nodule axis");
    await label.click();
    await page.locator("canvas.stage").focus();
    await page.keyboard.press("Delete");
    expect(await marks()).toEqual([]);
  });

  it("keeps marks of a case in the browser, and as files", async () => {
    const context = await session.context();
    const visit = async (hash: string) => {
      const visitor = await context.newPage();
      await visitor.goto(session.url + hash);
      await visitor.waitForFunction(() => window.clipgs !== undefined);
      await visitor.evaluate(() => window.clipgs.ready);
      return visitor;
    };
    const shot = "#case=phantom&view=10,60&plane=0,0,-1,0";
    const first = await visit(shot);
    const { center } = await readBounds(session.cases);
    await first.evaluate(
      (point) => {
        window.clipgs.addMark({ kind: "point", points: [point], name: "Größe" });
        window.clipgs.addMark({ kind: "point", points: [[point[0] + 15, point[1], point[2]]] });
      },
      [...center] as Triple,
    );
    const marks = (where: Page) =>
      where.evaluate(() => window.clipgs.marks.map(({ id, name }) => ({ id, name })));
    const made = await marks(first);
    await first.waitForFunction(() =>
      Object.keys(localStorage).some((key) => key.startsWith("clipgs.marks.")),
    );
    const saving = first.waitForEvent("download");
    await first.getByRole("button", { name: "Save marks" }).click();
    const file = await saving;
    expect(file.suggestedFilename()).toBe("phantom.marks.json");
    const path = join(session.folder, "marks.json");
    await file.saveAs(path);
    await first.close();

    const again = await visit(shot);
    expect(await marks(again)).toEqual(made);
    const linked = await visit(`${shot}&pin=${center.join()}`); // a link says what is shown
    expect((await marks(linked)).length).toBe(1);
    await linked.close();
    await again.evaluate((id) => window.clipgs.removeMark(id), made[0]!.id);
    await again.close();
    const third = await visit(shot);
    expect(await marks(third)).toEqual(made.slice(1));

    const ofMarks = third.locator("div").filter({ has: third.locator(":scope > .mark-list") });
    const open = (name: string) => ofMarks.locator("input[type=file]").setInputFiles(name);
    await open(path);
    await expect.poll(() => marks(third)).toHaveLength(2);
    const other = join(session.folder, "other.json");
    writeFileSync(other, JSON.stringify({ ...JSON.parse(readFileSync(path, "utf8")), clipgs_marks: 9 }));
    await open(other);
    await third
      .getByRole("alert")
      .getByText(/other\.json: of a version/)
      .waitFor();
    expect(await marks(third)).toHaveLength(2);
    await third.getByRole("alert").getByRole("button", { name: "Dismiss" }).click();
    await third.getByRole("alert").waitFor({ state: "hidden" });
    const before = await marks(third);
    await third.evaluate(() => window.clipgs.open("photo"));
    expect(await marks(third)).toEqual([]);
    await third.evaluate(() => window.clipgs.open("phantom"));
    expect(await marks(third)).toEqual(before);
    await context.close();
  });

  it("shows everybody the marks beside a case, and keeps in the browser what somebody changes", async () => {
    const context = await session.context();
    const file = join(session.cases, "phantom.marks.json");
    const visit = async () => {
      const visitor = await context.newPage();
      await visitor.goto(`${session.url}#case=phantom&view=10,60&plane=0,0,-1,0`);
      await visitor.waitForFunction(() => window.clipgs !== undefined);
      await visitor.evaluate(() => window.clipgs.ready);
      return visitor;
    };
    const names = (where: Page) => where.evaluate(() => window.clipgs.marks.map(({ name }) => name));
    const point = (id: string, x: number) => ({ id, kind: "point", name: id, points: [[x, 0, 0]] });
    const text = JSON.stringify({ clipgs_marks: 1, volume: "", marks: [point("a", 0), point("b", 5)] });
    writeFileSync(file, text);
    const first = await visit();
    expect(await names(first)).toEqual(["a", "b"]);
    await first.evaluate(() => window.clipgs.removeMark("a"));
    await first.evaluate(() => window.clipgs.describeMark("b", { name: "mine" }));
    await first.close();
    const again = await visit();
    expect(await names(again)).toEqual(["mine"]);
    expect(readFileSync(file, "utf8")).toBe(text);
    await context.close();
    rmSync(file);
  });

  it("takes a movement for one step, however long it pauses", async () => {
    await show(page, { view: [35, 20, 1], plane: [0, 0, -1, 0], clip: "exact" });
    const slider = page.getByRole("slider", { name: "Position of the plane, mm" });
    await slider.scrollIntoViewIfNeeded();
    const { x, y, width, height } = (await slider.boundingBox())!;
    const offset = () => page.evaluate(() => window.clipgs.state.plane!.offset);
    await page.waitForTimeout(600);
    const before = await offset();
    await page.mouse.move(x + 0.5 * width, y + 0.5 * height);
    await page.mouse.down();
    for (const share of [0.55, 0.65, 0.75]) {
      await page.mouse.move(x + share * width, y + 0.5 * height);
      await page.waitForTimeout(600);
    }
    await page.mouse.up();
    expect(Math.abs((await offset()) - before)).toBeGreaterThan(1);
    await page.locator("canvas.stage").focus();
    await page.keyboard.press("Control+z");
    expect(await offset()).toBeCloseTo(before, 6);
  });

  it("has all that is shown in its link: what is hidden, and which plane is moved", async () => {
    const hash = "#case=phantom&view=35,20&plane=0,0,-1,0&plane=0,-1,0,10&active=1&hide=body,handle";
    const visitor = await session.open(hash, errors);
    await visitor.evaluate(() => window.clipgs.ready);
    const state = await visitor.evaluate(() => window.clipgs.state);
    expect(state.layers).toEqual({ body: false, faces: true, marks: true });
    expect(state.plane!.normal).toEqual([0, -1, 0]);
    await visitor.waitForFunction(() => /active=1&.*hide=body,handle/.test(location.hash));
    await visitor.close();
  });

  it("speaks the language that is wanted, and shows experts more", async () => {
    const german = await session.openPage(`${session.url}?lang=de-CH#case=phantom&plane=0,0,-1,5`, errors);
    await german.getByRole("region", { name: "Schnittebene" }).waitFor();
    await german.evaluate(() => window.clipgs.ready);
    expect(await german.evaluate(() => document.documentElement.lang)).toBe("de");
    await german.getByText("Axial, superior entfernt", { exact: true }).waitFor();
    await german.getByText("S \u22125.0 mm", { exact: true }).waitFor();
    const operators = german.getByRole("group", { name: "Schnittoperator" });
    expect(await operators.isVisible()).toBe(true);
    await german.getByRole("button", { name: "Experte" }).click();
    expect(await operators.isVisible()).toBe(false);
    await german.evaluate(() => window.clipgs.setClip("soft")); // which is not what everyone has
    await operators.waitFor();
    await expect(german.evaluate(() => window.clipgs.open("nobody"))).rejects.toThrow();
    const said = await german.getByRole("alert").locator("p").textContent();
    expect(said).toBe("nobody: Diesen Fall gibt es nicht; bitte einen anderen aus dem Menü wählen");
    await german.close();
  });

  it("is turned, moved, zoomed and cut, and marked, by keys alone", async () => {
    const keyed = await session.open("#case=phantom&view=10,60&plane=0,0,-1,0", errors);
    await keyed.evaluate(() => window.clipgs.ready);
    const state = () => keyed.evaluate(() => window.clipgs.state);
    const place = () => keyed.evaluate(() => window.clipgs.project([0, 0, 0])!);
    await keyed.keyboard.press("Tab");
    expect(await keyed.evaluate(() => document.activeElement?.tagName)).toBe("CANVAS");
    await keyed.locator(".reticle").waitFor();
    await keyed.keyboard.press("i"); // where the reticle is
    const [mark] = await keyed.evaluate(() => window.clipgs.marks);
    expect(mark!.text).toMatch(/ HU$/);
    expect(mark!.points[0]![2]).toBeCloseTo(0, 3);
    await keyed.keyboard.press("ArrowRight");
    await keyed.keyboard.press("PageDown");
    expect((await state()).view).toMatchObject({ azimuth: 15, elevation: 55 });
    await keyed.keyboard.press("+");
    expect((await state()).view.zoom).toBeCloseTo(1.15, 6);
    const before = await place();
    await keyed.keyboard.press("Alt+ArrowRight");
    expect((await place()).x).toBeGreaterThan(before.x + 5);
    await keyed.keyboard.press("Control+ArrowUp");
    const { normal } = (await state()).plane!;
    expect(Math.acos(-normal[2]) * (180 / Math.PI)).toBeCloseTo(2, 3);
    await keyed.keyboard.press("ArrowUp");
    expect((await state()).plane!.normal).toEqual(normal);
    await keyed.close();
  });

  it("says once what to do first", async () => {
    const context = await session.context();
    const visit = async () => {
      const visitor = await context.newPage();
      await visitor.goto(`${session.url}#case=phantom`);
      await visitor.waitForFunction(() => window.clipgs !== undefined);
      await visitor.evaluate(() => window.clipgs.ready);
      return visitor;
    };
    const first = await visit();
    const hint = (where: Page) => where.getByRole("note");
    await hint(first).getByText("Drag to turn").waitFor();
    await first.mouse.move(300, 300);
    await first.mouse.wheel(0, 50);
    await hint(first).waitFor({ state: "hidden" });
    expect(await hint(await visit()).count()).toBe(0);
    await context.close();
  });

  it("offers to look at a cut on the far side", async () => {
    await show(page, { view: [35, 40, 1], plane: [0, 0, 1, 0], clip: "exact" }); // from above: what is below is removed
    const offer = page.getByRole("button", { name: "The cut is on the far side: look at it" });
    await offer.click();
    const { azimuth, elevation } = await page.evaluate(() => window.clipgs.state.view);
    expect(azimuth).toBeCloseTo(35, 6);
    expect(elevation).toBeCloseTo(-40, 6);
    expect(await offer.isVisible()).toBe(false);
  });

  it("says so where a case has no section volume", async () => {
    const bare = join(session.cases, "bare.sog");
    await clipgs("pack", join(session.folder, "scene.ply"), "-o", bare, "--no-section");
    const visitor = await session.open("#case=bare&plane=0,-1,0,0", errors);
    await visitor.evaluate(() => window.clipgs.ready);
    expect(await visitor.getByText("no values of the scan").isVisible()).toBe(true);
    expect(await visitor.getByRole("button", { name: "Volume" }).isDisabled()).toBe(true);
    expect(coverage(await pagePicture(visitor, 96, 96))).toBeGreaterThan(0.03);
    await visitor.evaluate(() => window.clipgs.open("phantom"));
    expect(await visitor.getByText("no values of the scan").isVisible()).toBe(false);
    await visitor.close();
    rmSync(bare);
  });

  it("slides the plane by its arrow and tilts it by its rim, with the mouse", async () => {
    await show(page, { view: [20, 15, 1], plane: [0, 0, -1, 0], clip: "exact" });
    const screen = (point: Triple) => page.evaluate((p) => window.clipgs.project(p)!, point);
    const plane = () => page.evaluate(() => window.clipgs.state.plane!);
    const view = () => page.evaluate(() => window.clipgs.state.view);
    const drag = async (from: { x: number; y: number }, dx: number, dy: number) => {
      await page.mouse.move(from.x, from.y);
      await page.mouse.down();
      await page.mouse.move(from.x + 0.5 * dx, from.y + 0.5 * dy);
      await page.mouse.move(from.x + dx, from.y + dy);
      await page.mouse.up();
    };
    const bounds = await readBounds(session.cases);
    const center: Triple = [bounds.center[0], bounds.center[1], 0];
    const before = await view();

    const arrow = await screen([center[0], center[1], 0.2 * bounds.radius]);
    await drag(arrow, 0, -60);
    const slid = await plane();
    expect(slid.normal[2]).toBeCloseTo(-1);
    expect(-slid.offset).toBeGreaterThan(20); // upwards: less is removed
    // The arrow is still under the mouse.
    const followed = await screen([center[0], center[1], 0.2 * bounds.radius - slid.offset]);
    expect(Math.hypot(followed.x - arrow.x, followed.y - (arrow.y - 60))).toBeLessThan(4);

    const rim = await screen([center[0] + 0.98 * bounds.radius, center[1], -slid.offset]); // at the patient's right
    await drag(rim, 0, 50);
    const tilted = await plane();
    expect(Math.abs(tilted.normal[0])).toBeGreaterThan(0.1);
    expect(Math.hypot(...tilted.normal)).toBeCloseTo(1);
    expect(await view()).toEqual(before); // the case did not turn meanwhile

    await drag({ x: 120, y: 500 }, 80, 0); // beside the handle: turns the case
    expect((await view()).azimuth).not.toBeCloseTo(before.azimuth, 0);
    expect(await plane()).toEqual(tilted);
  });

  it("has buttons and keys for planes and operators", async () => {
    const plane = () => page.evaluate(() => window.clipgs.state.plane);
    await show(page, { view: [20, 15, 1], plane: null, clip: "exact" });
    await page.getByRole("button", { name: "Coronal" }).click();
    expect((await plane())!.normal.map((v) => v + 0)).toEqual([0, -1, 0]);
    await page.getByRole("button", { name: "Flip" }).click();
    expect((await plane())!.normal[1]).toBe(1);
    await page.keyboard.press("s");
    expect(Math.abs((await plane())!.normal[0])).toBe(1);
    const offset = (await plane())!.offset;
    await page.keyboard.press("ArrowUp");
    expect((await plane())!.offset).toBeCloseTo(offset - 1);
    await page.keyboard.press("p");
    expect(await plane()).toBeNull();
    await page.getByRole("button", { name: "Hard" }).click();
    expect(await page.evaluate(() => window.clipgs.state.clip)).toBe("hard");
    await page.keyboard.press("2");
    expect(await page.evaluate(() => window.clipgs.state.clip)).toBe("soft");
    await page.getByRole("button", { name: "Look from left" }).click();
    expect((await page.evaluate(() => window.clipgs.state.view)).azimuth).toBe(90);
    await page.keyboard.press("r");
    expect(await plane()).not.toBeNull();
  });

  it("undoes what was done to the cut, movement by movement, and does it again", async () => {
    const state = () =>
      page.evaluate(() => [window.clipgs.state.plane!.normal[2] + 0, window.clipgs.state.clip]);
    await show(page, { view: [20, 15, 1], plane: [0, 0, -1, 0], clip: "exact" });
    const settle = () => page.waitForTimeout(600);
    await settle();
    // Within one task: however slow the machine is, no pause parts them.
    await page.evaluate(() => {
      for (const key of ["s", "ArrowUp"]) {
        window.dispatchEvent(new KeyboardEvent("keydown", { key }));
      }
    });
    await settle();
    await page.keyboard.press("2");
    await page.keyboard.press("Control+z");
    expect(await state()).toEqual([0, "exact"]);
    await page.keyboard.press("Control+z");
    expect(await state()).toEqual([-1, "exact"]);
    await page.keyboard.press("Control+Shift+z");
    await page.getByTitle("Redo (Ctrl+Shift+Z)").click();
    expect(await state()).toEqual([0, "soft"]);
    expect(await page.getByTitle("Redo (Ctrl+Shift+Z)").isDisabled()).toBe(true);
  });

  it("equals clipgs render in the states of the uniaxial mode", async () => {
    // A case with states of its own: along another axis, keeping what is above.
    const scene = join(session.folder, "scene");
    const tilted = JSON.parse(readFileSync(`${scene}.json`, "utf8")) as object;
    const states = { count: 40, first: -60, spacing: 3, keeps: "above" };
    copyFileSync(`${scene}.ply`, `${scene}-tilted.ply`);
    writeFileSync(`${scene}-tilted.json`, JSON.stringify({ ...tilted, axis: [0.36, -0.48, 0.8], states }));
    const own = join(session.cases, "tilted.sog");
    await clipgs("pack", `${scene}-tilted.ply`, "-o", own, "--no-section");
    for (const [name, state, clip, section] of [
      ["phantom", 57, "hard", "splats"],
      ["phantom", 120, "soft", "splats"],
      ["phantom", 120, "exact", "splats"],
      ["phantom", 83, "exact", "volume"],
      ["photo", 111, "exact", "volume"],
      ["tilted", 17, "exact", "splats"],
    ] as const) {
      const shot: Shot = { name, view: [35, 20, 1], plane: null, clip, section };
      const { picture: truth, printed } = await renderedAndPrinted(session, shot, "210x154", [
        "--state",
        String(state),
      ]);
      await choose(page, name);
      await show(page, shot);
      expect(await page.evaluate((k) => window.clipgs.setState(k), state)).toBe(true);
      const got = await pagePicture(page, truth.width, truth.height);
      expect(coverage(truth)).toBeGreaterThan(0.03);
      expect(psnr(got, truth).color, `${name}, state ${state}, ${clip}`).toBeGreaterThan(kMinAlike);
      expect(psnr(got, truth).alpha, `${name}, state ${state}, ${clip}`).toBeGreaterThan(kMinAlike);
      const said = /^state (\d+) of (\d+): (-?[\d.]+) mm$/.exec(printed.trim())!;
      const readout = new RegExp(
        `^State ${said[1]} / ${said[2]} · [A-Z]+ ${said[3]!.replace("-", "\u2212")} mm$`,
      );
      expect(await page.getByText(readout).isVisible(), String(readout)).toBe(true);
    }
    await choose(page, "phantom");
    rmSync(own);
  });

  it("moves the plane from state to state in the uniaxial mode", async () => {
    const state = () => page.evaluate(() => window.clipgs.state);
    const button = (name: string) => page.getByRole("button", { name, exact: true });
    const states = await page.evaluate(() => window.clipgs.states!);
    expect(states).toMatchObject({ axis: [0, 0, 1], count: 200, keeps: "below" });
    await show(page, { view: [20, 15, 1], plane: [0.1, 0.2, -1, 5], more: [[1, 0, 0, -40]], clip: "exact" });
    const free = (await state()).cuts;
    expect((await state()).state).toBeNull();

    await button("Uniaxial").click(); // the plane that was moved is left, at the nearest state
    expect(await state()).toMatchObject({ mode: "uniaxial", state: expect.any(Number) as number });
    const start = (await state()).state!;
    const offsetOf = (k: number) => -(states.first + k * states.spacing);
    expect((await state()).cuts.map(({ offset }) => offset)).toEqual([offsetOf(start)]);
    expect((await state()).plane!.normal.map((v) => v + 0)).toEqual([0, 0, -1]);
    for (const name of ["Flip", "Slab", "Plane"]) {
      expect(await button(name).isDisabled(), name).toBe(true);
    }
    expect(await button("Coronal").isVisible()).toBe(false);

    const keys = ["ArrowUp", "ArrowUp", "ArrowDown", "Shift+ArrowUp", "Shift+ArrowDown", "ArrowDown"];
    const reached = [];
    for (const key of [...keys, "f", "c", "n", "b", "e"]) {
      await page.keyboard.press(key);
      reached.push((await state()).state! - start);
    }
    expect(reached).toEqual([1, 2, 1, 11, 1, 0, 0, 0, 0, 0, 0]);
    const slider = page.getByRole("slider", { name: "State of the plane" });
    await slider.fill("42");
    await slider.press("ArrowUp");
    expect((await state()).state).toBe(43);
    expect(await slider.getAttribute("aria-valuetext")).toMatch(/^State 43 \/ 200 · S \u2212?\d+\.\d\d mm$/);
    await page.mouse.move(300, 300);
    await page.keyboard.down("Alt");
    const scale = await page.evaluate(() => devicePixelRatio); // the driver's pixels are not of CSS
    for (let i = 0; i < 3; ++i) {
      await page.mouse.wheel(0, -20 * scale); // by 0.4 of a state
    }
    await expect.poll(async () => (await state()).state).toBe(44);
    await page.mouse.wheel(0, 100 * scale); // back by 2
    await expect.poll(async () => (await state()).state).toBe(42);
    await page.keyboard.up("Alt");

    await page.waitForFunction(() => location.hash.includes("&state=42&"));
    expect(await hashOf(page)).not.toContain("plane=");
    const linked = await session.open(await hashOf(page), errors);
    await linked.evaluate(() => window.clipgs.ready);
    expect(await linked.evaluate(() => [window.clipgs.state.mode, window.clipgs.state.state])).toEqual([
      "uniaxial",
      42,
    ]);
    await linked.evaluate(() => void (location.hash = "#state=999"));
    await linked.waitForFunction(() => window.clipgs.state.state === 199);
    await linked.evaluate(() => void (location.hash = "#plane=1,0,0,3"));
    await linked.waitForFunction(() => window.clipgs.state.mode === "arbitrary");
    expect(await linked.evaluate(() => window.clipgs.state.plane)).toEqual({ normal: [1, 0, 0], offset: 3 });
    await linked.close();

    await page.keyboard.press("p");
    expect(await state()).toMatchObject({ mode: "uniaxial", state: null, cuts: [] });
    await page.waitForFunction(() => location.hash.includes("&state=off&"));
    await page.keyboard.press("p");
    expect((await state()).state).toBe(42);
    expect(await page.evaluate(() => [200, -1, 1.5].map((k) => window.clipgs.setState(k)))).toEqual([
      false,
      false,
      false,
    ]);
    await button("Arbitrary").click(); // the plane stays
    expect(await state()).toMatchObject({ mode: "arbitrary", state: null });
    expect((await state()).plane!.offset).toBe(offsetOf(42));
    await page.keyboard.press("u");
    expect((await state()).state).toBe(42);
    await page.evaluate((cuts) => window.clipgs.setCuts(cuts), free);
    expect((await state()).state).toBe(start);
  });

  it("slides the plane by all of its handle in the uniaxial mode", async () => {
    const bounds = await readBounds(session.cases);
    await show(page, { view: [20, 15, 1], plane: null, clip: "exact" });
    await page.evaluate(() => window.clipgs.setState(100));
    const { states, plane } = await page.evaluate(() => ({
      states: window.clipgs.states!,
      plane: window.clipgs.state.plane!,
    }));
    const rim = await page.evaluate((p) => window.clipgs.project(p)!, [
      bounds.center[0] + 0.98 * bounds.radius,
      bounds.center[1],
      -plane.offset,
    ] as Triple);
    await page.mouse.move(rim.x, rim.y);
    await page.mouse.down();
    await page.mouse.move(rim.x, rim.y - 30, { steps: 3 });
    await page.mouse.up();
    const { state, plane: moved } = await page.evaluate(() => window.clipgs.state);
    expect(state).toBeGreaterThan(105);
    expect(moved!.normal).toEqual(plane.normal);
    expect(moved!.offset).toBe(-(states.first + state! * states.spacing));
  });

  it("cuts with several planes and slabs", async () => {
    const cuts = () => page.evaluate(() => window.clipgs.state.cuts);
    await show(page, { view: [20, 15, 1], plane: [0, 0, -1, 5], clip: "exact" });
    await page.getByRole("button", { name: "Plane", exact: true }).click();
    expect((await cuts()).map(({ normal }) => normal.map(Math.abs))).toEqual([
      [0, 0, 1],
      [0, 1, 0],
    ]);
    await page.getByRole("button", { name: "Slab" }).click();
    expect((await cuts())[1]!.thickness).toBe(20);
    await page.getByRole("slider", { name: "Thickness of the slab, mm" }).fill("35");
    expect((await cuts()).map(({ thickness }) => thickness)).toEqual([undefined, 35]);
    const before = await cuts();
    await page.getByRole("button", { name: "Flip" }).click(); // turns the slab round where it is
    expect((await cuts())[1]!.offset).toBeCloseTo(-before[1]!.offset - 35);
    await page.waitForFunction(() => /plane=0,0,-1,5&slab=[-\d.,]+,35&/.test(location.hash));
    await page.keyboard.press("n");
    await page.keyboard.press("b");
    expect((await cuts()).length).toBe(3);
    await page.keyboard.press("n"); // the sixth plane
    expect(await page.getByRole("button", { name: "Plane", exact: true }).isDisabled()).toBe(true);
    await page.keyboard.press("n");
    expect((await cuts()).length).toBe(4);
    await page.keyboard.press("x");
    await page.keyboard.press("e"); // from the third to the first
    await page.keyboard.press("ArrowUp");
    expect((await cuts()).map(({ offset }) => offset)[0]).toBeCloseTo(4);
    const kept = await cuts();
    await page.keyboard.press("p");
    expect(await cuts()).toEqual([]);
    await page.keyboard.press("p");
    expect(await cuts()).toEqual(kept);
    await page.keyboard.press("r");
    expect((await cuts()).length).toBe(1);
  });

  it("shows slices beside it, which go with the cut and say what is read of the volume", async () => {
    await show(page, { view: [20, 15, 1], plane: [0, 0, -1, 5], clip: "exact", shades: [40, 400] });
    await page.keyboard.press("q");
    const pane = page.getByRole("slider", { name: "Axial slice" });
    await pane.waitFor();
    await settled(page);
    expect(await pane.getAttribute("aria-valuetext")).toBe("S −5.0 mm");
    expect(await page.locator(".slice .edge").allTextContents()).toEqual(["R", "L", "A", "P"]);
    const { x, y, width, height } = (await pane.boundingBox())!;
    const reading = page.locator(".slice-reading");
    let read = 0;
    for (const [right, down] of [
      [0.5, 0.5],
      [0.44, 0.41],
      [0.57, 0.48],
    ] as const) {
      // In the middle of a pixel, of which this page has few.
      const { at, pixel } = await pane.evaluate(
        (canvas: HTMLCanvasElement, shares) => {
          const [i, j] = [Math.floor(shares.right * canvas.width), Math.floor(shares.down * canvas.height)];
          const px = canvas.clientWidth / canvas.width;
          const { data } = canvas.getContext("2d")!.getImageData(i, j, 1, 1);
          return { at: { x: (i + 0.5) * px, y: (j + 0.5) * px }, pixel: data[0]! };
        },
        { right, down },
      );
      await page.mouse.move(x + at.x, y + at.y);
      const said = /^(−?\d+) ± \S+ HU · R (\S+) A (\S+) S (\S+) mm$/.exec((await reading.textContent())!);
      if (said) {
        const numbers = said.slice(1).map((text) => Number(text.replace("−", "-")));
        const shade = Math.min(1, Math.max(0, (numbers[0]! - 40) / 400 + 0.5));
        expect(Math.abs(pixel - 255 * shade)).toBeLessThan(2);
        expect(numbers[3]).toBe(-5);
        ++read;
      }
    }
    expect(read).toBeGreaterThan(1);

    // Slices and the cut go together, by the wheel, by keys and by the crosshair.
    const cut = () => page.evaluate(() => window.clipgs.state.plane!);
    await page.mouse.wheel(0, 120);
    expect((await cut()).offset).toBeGreaterThan(5.3);
    const below = (await cut()).offset;
    await pane.press("ArrowUp");
    expect((await cut()).offset).toBeLessThan(below - 0.3);
    const shown = page.getByRole("group", { name: "Which slice is shown" });
    await shown.getByRole("button", { name: "Coronal" }).click();
    expect(Math.abs((await cut()).normal[1])).toBe(1);
    const coronal = page.getByRole("slider", { name: "Coronal slice" });
    await coronal.waitFor();
    await page.getByRole("button", { name: "The cut goes through the crosshair" }).click();
    const before = await cut();
    await coronal.press("Shift+ArrowDown");
    expect(await cut()).toEqual(before);

    // What is marked in a slice lies in it.
    await page.keyboard.press("Escape");
    await page.getByRole("group", { name: "Mark" }).getByRole("button", { name: "Length" }).click();
    await page.mouse.click(x + 0.45 * width, y + 0.5 * height);
    await page.mouse.click(x + 0.55 * width, y + 0.5 * height);
    const [mark] = await page.evaluate(() => window.clipgs.marks);
    const mm = Number(/[\d.]+/.exec((await page.locator(".slice-scale span").textContent())!)![0]);
    const bar = (await page.locator(".slice-scale i").boundingBox())!.width;
    expect(mark!.mm! / ((0.1 * width * mm) / bar)).toBeCloseTo(1, 1);
    expect(mark!.points[0]![1]).toBeCloseTo(mark!.points[1]![1], 6);
    await page.getByRole("region", { name: "Slices" }).getByRole("button", { name: "mm" }).waitFor();
    await removeMarks();

    await page.waitForFunction(() => location.hash.includes("slices=coronal,unlinked&cross="));
    const linked = await session.open(await hashOf(page), errors);
    await linked.getByRole("slider", { name: "Coronal slice" }).waitFor();
    await linked.close();
    await page.getByRole("button", { name: "Close the slices (Q)" }).click();
    await coronal.waitFor({ state: "hidden" });
    await page.waitForFunction(() => !location.hash.includes("slices"));
  });

  it("shows another case beside it, and what is done with either is done with both", async () => {
    await show(page, { view: [20, 15, 1], plane: [0, 0, -1, 5], clip: "exact" });
    await page.keyboard.press("y");
    await page.getByRole("dialog", { name: "Cases" }).locator('[data-case="photo"]').click();
    const beside = page.getByRole("region", { name: "Beside it" });
    await beside.getByText("Positions are relative to the middle of each").waitFor();
    expect(await beside.getByText("Not for diagnosis", { exact: true }).isVisible()).toBe(true);
    expect(await page.evaluate(() => window.clipgs.state.case)).toBe("phantom");
    await page.waitForFunction(() => location.hash.endsWith("&beside=photo"));
    const { x, y, height } = (await beside.locator("canvas.stage").boundingBox())!;
    await page.mouse.move(x + 10, y + height - 60);
    await page.mouse.down();
    await page.mouse.move(x + 60, y + height - 60, { steps: 2 });
    await page.mouse.up();
    expect(await page.evaluate(() => window.clipgs.state.view.azimuth)).toBeCloseTo(0, 3);
    const canvas = () => beside.locator("canvas.stage").screenshot();
    const before = await canvas();
    await page.evaluate(() => window.clipgs.setPlane({ normal: [1, 0, 0], offset: 0 }));
    await expect.poll(async () => (await canvas()).equals(before)).toBe(false);
    await page.keyboard.press("y");
    await beside.waitFor({ state: "hidden" });
    await page.waitForFunction(() => !location.hash.includes("beside"));
  });

  it("says what it is not for, and keeps the view in the address", async () => {
    expect(await page.locator("footer").getByText("Not for diagnosis", { exact: true }).isVisible()).toBe(
      true,
    );
    await show(page, { view: [12, 34, 1.5], plane: [0, 0, -1, 5], clip: "hard" });
    await page.waitForFunction(() => location.hash.includes("view=12,34,1.5"));
    expect(await hashOf(page)).toBe("#case=phantom&view=12,34,1.5&plane=0,0,-1,5&clip=hard");
  });

  it("draws the same after the GPU was lost", async () => {
    await show(page, { view: [20, 15, 1], plane: [0, -1, 0, 0], clip: "exact" });
    const before = await pagePicture(page, 128, 128);
    await loseGpu(page);
    expect(psnr(await pagePicture(page, 128, 128), before).color).toBeGreaterThan(60);
  });

  it("leaves no error in the page", () => {
    expect(errors).toEqual([]);
  });
});

/** Once the page shows its state at full resolution, with all of it drawn. */
async function settled(page: Page): Promise<void> {
  await page.waitForFunction(() => window.clipgs.stats.settled);
  await page.evaluate(
    () => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))),
  );
}

/** What the address of the page says. */
function hashOf(page: Page): Promise<string> {
  return page.evaluate(() => location.hash);
}

/** Straight RGBA over black, opaque. */
function onBlack(data: Uint8Array): Uint8Array {
  return data.map((v, i) => (i % 4 === 3 ? 255 : Math.round((v * data[i - (i % 4) + 3]!) / 255)));
}

/** Where the phantom lies: the middle and radius of its sphere, from the end of the case where meta.json is. */
async function readBounds(cases: string): Promise<{ center: Triple; radius: number }> {
  const text = readFileSync(join(cases, "phantom.sog")).toString("latin1");
  const sphere = /"sphere":(\{.*?\})/.exec(text)!;
  return JSON.parse(sphere[1]!) as { center: Triple; radius: number };
}
