import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";

import { copyMadeCases } from "./made_cases";
import { pagePicture, type Picture, psnr, readPng } from "./picture";
import { missing } from "./program";
import { Session } from "./session";
import { type Shot, show } from "./shot";

describe.skipIf(missing !== undefined)(`the screen${missing ? ` (${missing} is missing)` : ""}`, () => {
  const session = new Session();
  const errors: string[] = [];
  let page: Page;

  beforeAll(async () => {
    await session.start(() => copyMadeCases(session));
    page = await session.open("#case=phantom", errors, { width: 900, height: 600, scale: 1 });
    await page.evaluate(() => window.clipgs.ready);
  });

  afterAll(async () => {
    expect(errors).toEqual([]);
    await session.stop();
  });

  async function saved(save: () => Promise<void>): Promise<Picture> {
    const [download] = await Promise.all([page.waitForEvent("download"), save()]);
    expect(download.suggestedFilename()).toBe("phantom.png");
    return readPng(await download.path());
  }

  /** A part of a picture. */
  function crop({ width, data }: Picture, x: number, y: number, w: number, h: number): Picture {
    const part = new Uint8Array(4 * w * h);
    for (let row = 0; row < h; ++row) {
      const from = 4 * ((y + row) * width + x);
      part.set(data.subarray(from, from + 4 * w), 4 * w * row);
    }
    return { width: w, height: h, data: part };
  }

  it("saves what is seen, with its title, what it is not for, and marks", async () => {
    await show(page, { view: [10, 60, 1], plane: [0, 0, -1, 0], clip: "exact" });
    const key = () => page.keyboard.press("d");
    const plain = await saved(key);
    const panel = (await page.getByRole("region", { name: "Cutting plane" }).boundingBox())!;
    expect([plain.width, plain.height]).toEqual([panel.x, 600]);

    // The middle is what the page shows.
    await page.waitForFunction(() => window.clipgs.stats.settled);
    const path = `${session.folder}/shown.png`;
    await page.screenshot({ path });
    const [x, y, w, h] = [150, 120, 300, 360] as const;
    const shown = readPng(path);
    expect(psnr(crop(plain, x, y, w, h), crop(shown, x, y, w, h)).color).toBeGreaterThan(35);

    // Text lies on its box at the bottom left and at the top left.
    const colors = (picture: Picture, top: number) => {
      const { data } = crop(picture, 16, top, 110, 24);
      return new Set(Array.from({ length: data.length / 4 }, (_, i) => data[4 * i])).size;
    };
    expect(colors(plain, 600 - 16 - 24)).toBeGreaterThan(40);
    expect(colors(plain, 16)).toBeGreaterThan(40);
    expect(colors(plain, 60)).toBeLessThan(10); // between them nothing but the background

    const pins = await page.evaluate(() => {
      const { min, max } = window.clipgs.bounds!;
      const [r, a] = [0.5 * (min[0] + max[0]), 0.5 * (min[1] + max[1])];
      window.clipgs.addMark({
        kind: "length",
        points: [
          [r - 30, a, 0],
          [r + 30, a, 0],
        ],
      });
      return window.clipgs.marks[0]!.points.map((point) => window.clipgs.project(point)!);
    });
    expect(pins.length).toBe(2);
    const marked = await saved(() => page.getByRole("button", { name: "Save a picture (D)" }).click());
    const changed = (px: number, py: number) => {
      const [a, b] = [plain, marked].map((one) => crop(one, Math.round(px) - 8, Math.round(py) - 8, 16, 16));
      return psnr(a!, b!).color < 25;
    };
    for (const pin of pins) {
      expect(changed(pin.x, pin.y)).toBe(true);
      expect(changed(pin.x, pin.y + 40)).toBe(false);
    }
    expect(changed(0.5 * (pins[0]!.x + pins[1]!.x), 0.5 * (pins[0]!.y + pins[1]!.y))).toBe(true);
    const uncut = await page.evaluate(() => window.clipgs.state.cuts.length);
    expect(uncut).toBe(1); // nothing of the state was touched
  });

  it("gives pictures of any size, transparent, and with what stands over them", async () => {
    await show(page, { view: [10, 60, 1], plane: [0, 0, -1, 0], clip: "exact" });
    await page.keyboard.press("Shift+D");
    await page.getByLabel("Width, px").fill("240");
    await page.getByLabel("Height, px").fill("160");
    await page.getByLabel("Transparent background").check();
    await page.getByLabel(/Marks, directions/).uncheck();
    const alone = await saved(() => page.getByRole("button", { name: "Save (PNG)" }).click());
    expect([alone.width, alone.height]).toEqual([240, 160]);
    const { data } = await page.evaluate(async () => {
      const picture = await window.clipgs.renderToPixels(240, 160);
      return { data: Array.from(picture.data) };
    });
    expect(psnr(alone, { width: 240, height: 160, data: Uint8Array.from(data) }).color).toBeGreaterThan(45);
    expect(alone.data[3]).toBe(0);
    const full = await page.evaluate(async () => {
      const blob = await window.clipgs.picture({ width: 240, height: 160 });
      const bitmap = await createImageBitmap(blob);
      const context = new OffscreenCanvas(240, 160).getContext("2d")!;
      context.drawImage(bitmap, 0, 0);
      return Array.from(context.getImageData(0, 0, 240, 160).data);
    });
    expect(full.filter((_, i) => i % 4 === 3).every((alpha) => alpha === 255)).toBe(true);
    const refused = page.evaluate(() => window.clipgs.picture({ width: 20000, height: 20 }));
    await expect(refused).rejects.toThrow("16 to 16384 px a side");
  });

  it("saves and gives what was shown when it was asked for, whatever changes meanwhile", async () => {
    const shot: Shot = { view: [10, 60, 1], plane: [0, 0, -1, 0], clip: "exact" };
    const moveOn = () => {
      window.clipgs.marks.forEach(({ id }) => window.clipgs.removeMark(id));
      window.clipgs.setView({ azimuth: 80, elevation: 5 });
      window.clipgs.setPlane(null);
    };
    await show(page, shot);
    const pin = () => page.evaluate(() => window.clipgs.addMark({ kind: "point", points: [[0, 0, 0]] }));
    await page.evaluate(() => window.clipgs.marks.forEach(({ id }) => window.clipgs.removeMark(id)));
    expect(await pin()).not.toBeNull();
    const still = await saved(() => page.keyboard.press("d"));
    const key = `document.body.dispatchEvent(new KeyboardEvent("keydown", { key: "d", bubbles: true }))`;
    const meanwhile = await saved(() => page.evaluate(`${key}; (${moveOn.toString()})()`));
    expect(psnr(meanwhile, still).color).toBeGreaterThan(60);
    expect(await page.evaluate(() => window.clipgs.state.view.azimuth)).toBe(80);

    await show(page, shot);
    const before = await pagePicture(page, 96, 96);
    const data = await page.evaluate<number[]>(
      `{ const picture = window.clipgs.renderToPixels(96, 96); (${moveOn.toString()})();
        picture.then(({ data }) => Array.from(data)) }`,
    );
    expect(psnr({ ...before, data: Uint8Array.from(data) }, before).color).toBeGreaterThan(60);
  });

  it("fills the screen with a key and a button", async () => {
    const isFull = () => page.evaluate(() => document.fullscreenElement?.tagName ?? "");
    const button = page.getByRole("button", { name: "Full screen (Z)" });
    expect(await button.getAttribute("aria-pressed")).toBe("false");
    await page.keyboard.press("z");
    await expect.poll(isFull).toBe("MAIN");
    await expect.poll(() => button.getAttribute("aria-pressed")).toBe("true");
    await button.click();
    await expect.poll(isFull).toBe("");
    await expect.poll(() => button.getAttribute("aria-pressed")).toBe("false");
  });

  it("hides what the browser does not offer", async () => {
    const content = `Object.defineProperty(Document.prototype, "fullscreenEnabled", { value: false });`;
    const visitor = await session.open("#case=phantom", errors, undefined, [{ content }]);
    await visitor.evaluate(() => window.clipgs.ready);
    expect(await visitor.getByTitle("Full screen (Z)").filter({ visible: true }).count()).toBe(0);
    expect(await visitor.getByTitle("Save a picture (D)").isVisible()).toBe(true);
    await visitor.close();
  });
});
