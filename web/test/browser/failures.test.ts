import { readFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";

import { readZip } from "../../src/sog/zip";
import { makeZip } from "../unit/sog_fixture";
import { copyMadeCases } from "./made_cases";
import { coverage, decodePng, pagePicture, type Picture, psnr } from "./picture";
import { missing } from "./program";
import { Session } from "./session";
import { show } from "./shot";

/** For a page, before its own scripts: its workers are known. */
const kKnowWorkers = {
  content: `window.workers = [];
    window.Worker = class extends Worker {
      constructor(...args) {
        super(...args);
        window.workers.push(this);
      }
    };`,
};

/** For a page, before its own scripts: its GPU has no memory for volumes. */
const kNoRoomForVolumes = {
  content: `let full = false;
    const { prototype } = WebGL2RenderingContext;
    const { getError } = prototype;
    prototype.texStorage3D = function () {
      full = true;
    };
    prototype.getError = function () {
      const error = full ? this.OUT_OF_MEMORY : getError.call(this);
      full = false;
      return error;
    };`,
};

interface CaseMeta {
  sphere?: unknown;
  section: { checksum: string; version: number; file: string; materials?: unknown };
}

describe.skipIf(missing !== undefined)(`what fails${missing ? ` (${missing} is missing)` : ""}`, () => {
  const session = new Session();
  const errors: string[] = [];

  beforeAll(() => session.start(() => copyMadeCases(session)));

  afterAll(async () => {
    expect(errors).toEqual([]);
    await session.stop();
  });

  async function opened(name: string, ...scripts: { content: string }[]): Promise<Page> {
    const page = await session.open(
      `#case=${name}&size=64x64`,
      errors,
      { width: 400, height: 300, scale: 1 },
      scripts,
    );
    await page.evaluate(() => window.clipgs.ready);
    return page;
  }

  /** The phantom's case with something else in its meta.json. */
  async function changedPhantom(change: (meta: CaseMeta) => void): Promise<Buffer> {
    const archive = await readZip(readFileSync(join(session.cases, "phantom.sog")));
    const meta = JSON.parse(new TextDecoder().decode(archive.get("meta.json"))) as { clipgs: CaseMeta };
    change(meta.clipgs);
    const json = new TextEncoder().encode(JSON.stringify(meta));
    return Buffer.from(makeZip({ ...Object.fromEntries(archive), "meta.json": json }));
  }

  /** Why a case of the server is not opened where it has these bytes. */
  async function refusal(page: Page, body: Buffer): Promise<string> {
    await page.route("**/cases/phantom.sog*", (route) => route.fulfill({ body }));
    return page.evaluate(() =>
      window.clipgs.open("phantom").then(
        () => "",
        (error: Error) => error.message,
      ),
    );
  }

  /** What the page shows of a case, on black. */
  async function shown(page: Page): Promise<Picture> {
    await page.addStyleTag({ content: "footer, .message, .loading { display: none !important }" });
    await page.evaluate(
      () => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))),
    );
    return decodePng(await page.screenshot({ clip: { x: 0, y: 0, width: 64, height: 64 } }));
  }

  function brightest({ data }: Picture): number {
    return data.reduce((most, value, i) => (i % 4 === 3 ? most : Math.max(most, value)), 0);
  }

  it("shows a case by its splats alone where its section is broken, and says what is wrong", async () => {
    const page = await opened("solid");
    const broken: [(meta: CaseMeta) => void, RegExp][] = [
      [({ section }) => (section.checksum = "00000000"), /section\.obu does not decode to what was written/],
      [({ section }) => (section.version = 4), /section is of a version .* newer clipgs/],
      [({ section }) => delete section.materials, /materials/],
      [({ section }) => (section.file = "gone.webp"), /gone\.webp is missing/],
    ];
    for (const [change, message] of broken) {
      expect(await refusal(page, await changedPhantom(change))).toBe("");
      expect(await page.locator(".message").textContent()).toMatch(message);
      expect(await page.evaluate(() => window.clipgs.state.case)).toBe("phantom");
      expect(await page.evaluate(() => window.clipgs.stats.sectionBytes)).toBe(0);
      expect(coverage(await pagePicture(page, 64, 64))).toBeGreaterThan(0.1);
      await page.unroute("**/cases/phantom.sog*");
    }
    await page.evaluate(() => window.clipgs.open("phantom"));
    expect(await page.locator(".message").isVisible()).toBe(false);
    expect(await page.evaluate(() => window.clipgs.stats.sectionBytes)).toBeGreaterThan(0);
    await page.close();
  });

  it("shows nothing of the case before, whose order is gone, where one cannot be shown", async () => {
    const page = await opened("solid");
    expect(brightest(await shown(page))).toBeGreaterThan(50);
    expect(await refusal(page, await changedPhantom((meta) => delete meta.sphere))).toMatch(/sphere/);
    expect(await page.evaluate(() => window.clipgs.state.case)).toBe(null);
    expect(brightest(await shown(page))).toBe(0);
    await page.unroute("**/cases/phantom.sog*");
    await page.evaluate(() => window.clipgs.open("phantom"));
    expect(brightest(await shown(page))).toBeGreaterThan(50);
    await page.close();
  });

  it("says that the GPU has no memory for the section, and draws faces by splats", async () => {
    const page = await session.open("#case=phantom", errors, undefined, [kNoRoomForVolumes]);
    await page.evaluate(() => window.clipgs.ready);
    await page.getByText("This device cannot hold the values of the scan").waitFor();
    expect(await page.evaluate(() => window.clipgs.stats.sectionBytes)).toBe(0);
    const shot = { view: [20, 15, 1], plane: [0, -1, 0, 0], clip: "exact" } as const;
    const pictures = [];
    for (const section of ["volume", "splats"] as const) {
      await show(page, { ...shot, view: [...shot.view], plane: [...shot.plane], section });
      pictures.push(await pagePicture(page, 96, 96));
    }
    expect(coverage(pictures[0]!)).toBeGreaterThan(0.1);
    expect(psnr(pictures[0]!, pictures[1]!).color).toBeGreaterThan(60);
    await page.close();
  });

  it("says that the worker stopped while it sorted, and opens the case again", async () => {
    const page = await opened("solid", kKnowWorkers);
    const before = await pagePicture(page, 64, 64);
    const failure = page.evaluate(async () => {
      const [worker] = (window as unknown as { workers: Worker[] }).workers;
      worker!.postMessage = () => {}; // it hears nothing any more
      const picture = window.clipgs.renderToPixels(64, 64).then(
        () => "",
        (error: Error) => error.message,
      );
      await new Promise((resolve) => setTimeout(resolve, 300));
      worker!.dispatchEvent(new ErrorEvent("error"));
      return picture;
    });
    expect(await failure).toMatch(/before its picture was drawn/);
    const alert = page.getByRole("alert");
    expect(await alert.textContent()).toContain("the viewer's worker stopped");
    expect(await page.evaluate(() => window.clipgs.state.case)).toBe(null);
    await alert.getByRole("button", { name: "Try again" }).click();
    await page.waitForFunction(() => window.clipgs.state.case === "solid");
    expect(psnr(await pagePicture(page, 64, 64), before).color).toBeGreaterThan(60);
    expect(await alert.isVisible()).toBe(false);
    await page.close();
  });

  it("fetches again what could not be fetched of the viewer itself", async () => {
    const page = await session.openPage("about:blank", errors);
    await page.route("**/*.wasm", (route) => route.abort());
    await page.goto(`${session.url}#case=solid`);
    const alert = page.getByRole("alert");
    await alert.waitFor();
    expect(await alert.textContent()).toContain("a part of the viewer cannot be fetched");
    await page.unroute("**/*.wasm");
    await alert.getByRole("button", { name: "Try again" }).click();
    await page.waitForFunction(() => window.clipgs.state.case === "solid");
    expect(await alert.isVisible()).toBe(false);
    await page.close();
  });

  it("follows the last of two links, however fast they come", async () => {
    const page = await opened("solid");
    let asked = false;
    let release = (): void => {};
    const released = new Promise<void>((resolve) => (release = resolve));
    await page.route("**/cases/photo.sog*", async (route) => {
      asked = true;
      await released;
      await route.continue().catch(() => {}); // nobody may want it by now
    });
    await page.evaluate(() => (location.hash = "#case=photo&size=64x64"));
    await expect.poll(() => asked).toBe(true);
    await page.evaluate(() => (location.hash = "#case=solid&view=12,34&size=64x64"));
    await page.waitForTimeout(200);
    release();
    await expect.poll(() => page.locator(".loading:visible").count()).toBe(0);
    const { case: name, view } = await page.evaluate(() => window.clipgs.state);
    expect([name, view.azimuth, view.elevation]).toEqual(["solid", 12, 34]);
    await page.close();
  });
});
