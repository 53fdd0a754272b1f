// The page of all cases that `clipgs overview` writes, served and from the disk.

import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";

import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";

import { broken, kAxe } from "./axe";
import { copyMadeCases } from "./made_cases";
import { clipgs, missing } from "./program";
import { Session } from "./session";

/** What a batch would have noted: a case that failed, and one whose table was taken off. */
function addNotes(cases: string): void {
  const note = (name: string, file: string, text: string) => {
    const batch = join(cases, `${name}.clipgs-work`, "batch");
    mkdirSync(batch, { recursive: true });
    writeFileSync(join(batch, file), text);
  };
  const failed = { status: "failed", last_line: "clipgs: /data/Doe/ct: is truncated", seconds: 3 };
  note("broken", "build.json", JSON.stringify(failed));
  note("phantom", "build.log", "warning: /data/Doe/ct: took 312 ml of table, cushions and the like off\n");
  writeFileSync(join(cases, "batch.json"), JSON.stringify({ cases: [{ name: "broken", last: "eval" }] }));
}

describe.skipIf(missing !== undefined)(`overview${missing ? ` (${missing} is missing)` : ""}`, () => {
  const session = new Session();
  const errors: string[] = [];
  let page: Page;

  beforeAll(async () => {
    await session.start(async (cases) => {
      copyMadeCases(session);
      addNotes(cases);
      await clipgs("overview", cases);
    });
    const phone = { width: 390, height: 800, scale: 0.5 };
    page = await session.openPage(`${session.url}overview/`, errors, phone, [kAxe]);
  });

  afterAll(async () => {
    expect(errors).toEqual([]);
    await session.stop();
  });

  /** The cases that are shown, in their order. */
  const names = () => page.locator("tbody tr:visible b").allTextContents();

  it("says what failed first, and names no file", async () => {
    expect((await names())[0]).toBe("broken");
    const text = (await page.locator("main").textContent())!;
    expect(text).toContain("build: clipgs: …: is truncated");
    expect(text).toContain("312 ml of table and cushions taken off");
    expect(text).not.toContain("Doe");
    await page.waitForFunction(() => [...document.images].some((image) => image.naturalWidth > 0));
  });

  it("breaks no rule of axe-core on a telephone, nor on a desk, dark", async () => {
    expect(await broken(page)).toEqual([]);
    expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBe(390);
    await page.setViewportSize({ width: 1100, height: 700 });
    await page.emulateMedia({ colorScheme: "dark" });
    expect(await broken(page)).toEqual([]);
  });

  it("is sorted and filtered", async () => {
    await page.getByRole("button", { name: "MB" }).click();
    const sizes = await page.locator("tbody tr:visible td:last-child").count();
    const megabytes = (await page.locator('tbody tr:visible td[data-label="MB"]').allTextContents()).map(
      Number,
    );
    expect(megabytes.length).toBe(sizes);
    expect(megabytes.slice(0, -1)).toEqual([...megabytes.slice(0, -1)].sort((a, b) => b - a));
    expect((await names()).at(-1)).toBe("broken"); // it has no size
    await page.getByRole("combobox", { name: "Order" }).selectOption("Name");
    expect(await names()).toEqual([...(await names())].sort());
    await page.getByRole("searchbox", { name: "Search" }).fill("table TAKEN");
    expect(await names()).toEqual(["phantom"]);
    expect(await page.getByRole("status").textContent()).toMatch(/^1 of \d+ shown$/);
    await page.getByRole("searchbox", { name: "Search" }).fill("");
    await page.getByRole("combobox", { name: "Show" }).selectOption("Failed");
    expect(await names()).toEqual(["broken"]);
  });

  it("leads to the case in the viewer, and works without a server", async () => {
    await page.getByRole("combobox", { name: "Show" }).selectOption("All cases");
    await page.getByRole("link", { name: "phantom", exact: true }).click();
    await page.waitForFunction(() => window.clipgs !== undefined);
    expect(page.url()).toContain("#case=phantom");
    await page.goto(`file://${join(session.cases, "overview", "index.html")}`);
    expect((await names())[0]).toBe("broken");
    expect(await page.getByRole("link", { name: "phantom", exact: true }).count()).toBe(0);
    await page.waitForFunction(() => [...document.images].some((image) => image.naturalWidth > 0));
  });
});
