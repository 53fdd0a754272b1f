import { type ChildProcess, spawn } from "node:child_process";
import {
  chmodSync,
  copyFileSync,
  existsSync,
  mkdtempSync,
  readdirSync,
  readFileSync,
  renameSync,
  rmSync,
  writeFileSync,
} from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type { Browser, Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, inject, it } from "vitest";

import { coverage, pagePicture } from "./picture";
import { clipgs, kProgram, missing } from "./program";
import { launchBrowser, Session } from "./session";

const why = missing ? ` (${missing} is missing)` : "";
const newsOf = (page: Page) => page.getByRole("status", { name: "Quality" });

describe.skipIf(missing !== undefined)(`a better version of a case${why}`, () => {
  const session = new Session();
  const errors: string[] = [];

  beforeAll(() =>
    session.start((cases) =>
      copyFileSync(join(inject("made"), "cases", "instant.sog"), join(cases, "a.sog")),
    ),
  );

  afterAll(async () => {
    expect(errors).toEqual([]);
    await session.stop();
  });

  function replaceBy(name: string): void {
    copyFileSync(join(inject("made"), "cases", name), join(session.cases, "a.part"));
    renameSync(join(session.cases, "a.part"), join(session.cases, "a.sog"));
  }

  it("takes the place of what is shown, and nothing else changes, nor flashes", async () => {
    const page = await session.open("", errors, { width: 500, height: 400, scale: 1 });
    await page.evaluate(() => window.clipgs.ready);
    await newsOf(page).getByText("Instant").waitFor();
    await page.evaluate(() => {
      window.clipgs.setView({ azimuth: 40, elevation: 20, zoom: 1.2 });
      window.clipgs.setPlane({ normal: [0, -1, 0], offset: 0 });
      window.clipgs.setGrey(0.3);
      const { min, max } = window.clipgs.bounds!;
      const point: [number, number, number] = [0.5 * (min[0] + max[0]) - 20, 0, 0.5 * (min[2] + max[2])];
      window.clipgs.addMark({ kind: "point", points: [point], name: "here" });
    });
    await page.waitForFunction(() => window.clipgs.stats.settled);
    const state = () =>
      page.evaluate(() => ({
        ...window.clipgs.state,
        marks: window.clipgs.marks.map(({ id, name }) => id + name),
      }));
    const before = await state();
    expect(before.marks).toHaveLength(1);
    const total = await page.evaluate(() => window.clipgs.stats.total);
    // Of each frame, how much light there is in the middle of the canvas.
    await page.evaluate(() => {
      const canvas = document.querySelector<HTMLCanvasElement>("canvas.stage")!;
      const copy = document.createElement("canvas").getContext("2d", { willReadFrequently: true })!;
      const seen: number[] = [];
      Object.assign(window, { seen });
      const look = () => {
        copy.drawImage(canvas, 100, 150, 100, 100, 0, 0, 20, 20);
        const { data } = copy.getImageData(0, 0, 20, 20);
        seen.push(data.reduce((sum, v) => sum + v, 0));
        requestAnimationFrame(look);
      };
      requestAnimationFrame(look);
      window.clipgs.setView({ azimuth: 40, elevation: 20, zoom: 1.2 }); // drawn again, to compare with
    });
    await page.waitForFunction(() => window.clipgs.stats.settled);
    replaceBy("phantom.sog");
    await page.waitForFunction((known) => window.clipgs.stats.total !== known, total);
    await page.waitForFunction(() => window.clipgs.stats.settled);
    expect(await newsOf(page).isVisible()).toBe(false);
    expect(await state()).toEqual(before);
    expect(coverage(await pagePicture(page, 96, 96))).toBeGreaterThan(0.03);
    const seen = await page.evaluate<number[]>("window.seen");
    const kEmpty = 255 * 20 * 20; // black, which a canvas is between its frames, and no backdrop
    const drawn = seen.filter((light) => light !== kEmpty);
    expect(drawn.length).toBeGreaterThan(1);
    drawn.forEach((light) => expect(Math.abs(light / drawn[0]! - 1)).toBeLessThan(0.15));
    await page.close();
  });

  it("that is broken leaves what is shown", async () => {
    replaceBy("instant.sog");
    const page = await session.open("", errors, { width: 300, height: 200 });
    await page.evaluate(() => window.clipgs.ready);
    const warned = page.waitForEvent("console", (message) => message.type() === "warning");
    const bytes = readFileSync(join(inject("made"), "cases", "phantom.sog"));
    let image = bytes.indexOf("means_l.webp");
    while (bytes.readUInt32LE(image - 30) !== 0x04034b50) {
      image = bytes.indexOf("means_l.webp", image + 1); // not where it is only named
    }
    bytes[image + 300]! ^= 0x10;
    writeFileSync(join(session.cases, "a.part"), bytes);
    renameSync(join(session.cases, "a.part"), join(session.cases, "a.sog"));
    expect((await warned).text()).toMatch(/a: .*damaged/);
    expect(coverage(await pagePicture(page, 96, 96))).toBeGreaterThan(0.03);
    replaceBy("phantom.sog");
    await expect.poll(() => newsOf(page).isVisible()).toBe(false);
    await page.close();
  });
});

describe.skipIf(missing !== undefined)(`clipgs view${why}`, () => {
  const folder = mkdtempSync(join(tmpdir(), "clipgs-view-"));
  const errors: string[] = [];
  let browser: Browser;

  beforeAll(async () => {
    browser = await launchBrowser();
    await clipgs("phantom", join(folder, "small.nii.gz"), "--size", "48");
  });

  afterAll(async () => {
    await browser.close();
    rmSync(folder, { recursive: true });
    expect(errors).toEqual([]);
  });

  interface Viewing {
    program: ChildProcess;
    said: () => string;
    ended: Promise<number | null>;
  }

  function view(env: Record<string, string>, ...options: string[]): Viewing {
    const all = ["view", join(folder, "small.nii.gz"), "--work", join(folder, "work"), ...options];
    const program = spawn(kProgram, all, { env: { ...process.env, ...env } });
    let said = "";
    for (const stream of [program.stdout, program.stderr]) {
      stream.on("data", (text: Buffer) => (said += text.toString()));
    }
    return { program, said: () => said, ended: new Promise((done) => program.once("exit", done)) };
  }

  async function open(url: string): Promise<Page> {
    const page = await browser.newPage({ viewport: { width: 500, height: 400 } });
    page.setDefaultTimeout(120_000);
    page.on("pageerror", (error) => errors.push(error.message));
    await page.goto(url);
    await page.waitForFunction(() => window.clipgs !== undefined);
    return page;
  }

  const addressIn = (text: string) => /http:\S+/.exec(text)?.[0];

  it("opens the browser, shows the case as soon as it is there, and ends with its last page", async () => {
    const opened = join(folder, "opened");
    const opener = join(folder, "opener");
    writeFileSync(opener, `#!/bin/sh\necho "$1" > "${opened}"\n`);
    chmodSync(opener, 0o700);
    const viewing = view({ BROWSER: opener }, "--quality", "instant");
    await expect.poll(() => existsSync(opened) && addressIn(readFileSync(opened, "utf8"))).toBeTruthy();
    const page = await open(addressIn(readFileSync(opened, "utf8"))!);
    await page.evaluate(() => window.clipgs.ready);
    await newsOf(page).getByText("Instant").waitFor();
    expect(await page.evaluate(() => window.clipgs.state.case)).toMatch(/^volume-[0-9a-f]{8}$/);
    expect(coverage(await pagePicture(page, 96, 96))).toBeGreaterThan(0.03);
    const second = await open(page.url());
    await second.evaluate(() => window.clipgs.ready);
    await page.goto("about:blank");
    await second.reload();
    await second.evaluate(() => window.clipgs.ready);
    expect(viewing.program.exitCode).toBe(null);
    await second.goto("about:blank");
    expect(await viewing.ended, viewing.said()).toBe(0);
    await page.close();
    await second.close();
  });

  it("says when there is a better case, stops by Ctrl-C, and goes on from there", async () => {
    const viewing = view({ BROWSER: "false" }, "--quality", "draft", "--no-open");
    await expect.poll(() => addressIn(viewing.said())).toBeTruthy();
    const page = await open(addressIn(viewing.said())!);
    await page.evaluate(() => window.clipgs.ready);
    await newsOf(page)
      .getByText(/^Instant · draft in \d+ (s|min)$/)
      .waitFor();
    viewing.program.kill("SIGINT");
    expect(await viewing.ended).toBe(0);
    expect(viewing.said()).toContain("goes on from here");
    const name = await page.evaluate(() => window.clipgs.state.case);
    await page.close();
    expect(await clipgs("info", join(folder, "work", `${name}.sog`))).toContain("skin");
    const work = join(folder, "work");
    const kept = readdirSync(work).filter((file) => file.startsWith(name!));
    for (const file of kept) {
      renameSync(join(work, file), join(work, file.replace("volume", "small"))); // as it was called once
    }
    const again = view({}, "--quality", "draft", "--no-open");
    await expect.poll(again.said).toMatch(/instant case: done before[^]*seed points: done before/);
    again.program.kill("SIGTERM");
    expect(await again.ended).toBe(0);
    expect(readdirSync(work)).toEqual(expect.arrayContaining(kept));
  });

  it("says what is wrong with a volume, and which is not there", async () => {
    const gone = view({}, join(folder, "gone.nii.gz"), "--no-open");
    expect(await gone.ended).toBe(1);
    expect(gone.said()).toMatch(/gone\.nii\.gz: does not exist/);
    const broken = join(folder, "broken.nii.gz");
    writeFileSync(broken, "no volume");
    const viewing = view({ BROWSER: "/nowhere", PATH: "" }, broken, "--quality", "instant");
    await expect.poll(viewing.said).toMatch(/broken\.nii\.gz: .*\n/);
    await expect.poll(viewing.said).toContain("no browser could be opened");
    const response = await fetch(`${new URL(addressIn(viewing.said())!).origin}/api/cases`);
    const { making } = (await response.json()) as { making: { name: string; error?: string }[] };
    const failed = making.filter(({ error }) => error !== undefined);
    expect(failed).toHaveLength(1); // the other one is made
    expect(failed[0]!.error!.slice(0, failed[0]!.name.length + 2)).toBe(`${failed[0]!.name}: `);
    expect(JSON.stringify(making)).not.toMatch(/broken|small/); // files' names may be patients'
    viewing.program.kill("SIGINT");
    expect(await viewing.ended).toBe(1);
  });
});
