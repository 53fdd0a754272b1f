import { existsSync, mkdirSync, readFileSync, renameSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import type { BrowserContext, Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";

import { copyMadeCases } from "./made_cases";
import { missing } from "./program";
import { Session } from "./session";

type Point = [number, number, number];

describe.skipIf(missing !== undefined)(
  `marks on a server${missing ? ` (${missing} is missing)` : ""}`,
  () => {
    const session = new Session();
    // In a folder below the served one, with what an address has to write in another way.
    const name = "ward 3/2027/phantom";
    const file = () => join(session.cases, `${name}.marks.json`);
    let contexts: BrowserContext[] = [];

    beforeAll(() =>
      session.start(
        () => {
          copyMadeCases(session);
          mkdirSync(join(session.cases, "ward 3/2027"), { recursive: true });
          renameSync(join(session.cases, "phantom.sog"), join(session.cases, `${name}.sog`));
        },
        ...["--keep-marks", "--keep-tours", "--subfolders"],
      ),
    );

    afterAll(async () => {
      await Promise.all(contexts.map((context) => context.close()));
      expect(await session.stop(), "exit status of clipgs serve").toBe(0);
    });

    /** Somebody else's browser. */
    async function visit(): Promise<Page> {
      const context = await session.context();
      contexts = [...contexts, context];
      const page = await context.newPage();
      await page.goto(`${session.url}#case=${encodeURIComponent(name)}&view=10,60&plane=0,0,-1,0`);
      await page.waitForFunction(() => window.clipgs !== undefined);
      await page.evaluate(() => window.clipgs.ready);
      return page;
    }

    const names = (page: Page) => page.evaluate(() => window.clipgs.marks.map(({ name }) => name));
    const mark = (page: Page, name: string, shift: number) =>
      page.evaluate(
        ([text, by]) => {
          const { min, max } = window.clipgs.bounds!;
          const point = [0, 1, 2].map((k) => 0.5 * (min[k]! + max[k]!)) as Point;
          point[0] += by as number;
          return window.clipgs.addMark({ kind: "point", points: [point], name: text as string })!;
        },
        [name, shift],
      );
    const kept = () =>
      existsSync(file())
        ? (JSON.parse(readFileSync(file(), "utf8")) as { marks: { name: string }[] }).marks.map(
            ({ name }) => name,
          )
        : [];

    it("are kept beside the case, and what two do at once is kept of both", async () => {
      const [first, second] = await Promise.all([visit(), visit()]);
      const id = await mark(first, "from the first", -10);
      await expect.poll(kept).toEqual(["from the first"]);
      await mark(second, "from the second", 10); // who knows nothing of the first
      await expect.poll(kept).toEqual(["from the first", "from the second"]);
      await first.evaluate((one) => window.clipgs.removeMark(one), id);
      await expect.poll(kept).toEqual(["from the second"]);
      await first.reload();
      await first.waitForFunction(() => window.clipgs !== undefined);
      await first.evaluate(() => window.clipgs.ready);
      expect(await names(await visit())).toEqual(["from the second"]);
    });

    it("stand beside views, which are flown between, kept as a tour, and say which case is missing", async () => {
      const page = await visit();
      const tour = () => join(session.cases, `${name}.tour.json`);
      const stops = () =>
        existsSync(tour())
          ? (JSON.parse(readFileSync(tour(), "utf8")) as { stops: { name: string; show: string }[] }).stops
          : [];
      await page.getByRole("button", { name: "Save view" }).click();
      await page.evaluate(() => {
        window.clipgs.setView({ azimuth: 100, elevation: 10, zoom: 2 });
        window.clipgs.setPlane(null);
        window.clipgs.saveView("The side", "Said of the side");
      });
      await expect.poll(() => stops().map(({ name }) => name)).toEqual(["View 1", "The side"]);
      await page.getByRole("button", { name: "Change The side" }).click();
      await page.getByRole("spinbutton", { name: "Flight, s" }).fill("1");
      await page.getByRole("textbox", { name: "Name", exact: true }).fill("The left side");
      await page.getByRole("button", { name: "Change The left side" }).click();

      const other = await visit(); // where it is kept
      expect(await other.evaluate(() => window.clipgs.views.map(({ name }) => name))).toEqual([
        "View 1",
        "The left side",
      ]);
      await other.getByRole("button", { name: "The left side", exact: true }).click();
      const azimuth = () => other.evaluate(() => window.clipgs.state.view.azimuth);
      await expect.poll(azimuth).toBe(100);
      expect(await other.evaluate(() => window.clipgs.state.cuts.length)).toBe(0);
      await other.getByRole("region", { name: "Tour" }).getByText("Said of the side").waitFor();
      await other.keyboard.press(",");
      await expect.poll(azimuth).toBe(10);
      expect(await other.evaluate(() => window.clipgs.state.cuts.length)).toBe(1);

      // What somebody else does is not flown over.
      await other.keyboard.press("0");
      await expect.poll(azimuth).not.toBe(10); // it flies
      await other.evaluate(() => window.clipgs.setView({ azimuth: 55, elevation: 5 }));
      await expect.poll(() => other.evaluate(() => window.clipgs.tour.playing)).toBe(false);
      expect(await azimuth()).toBe(55);
      await other.keyboard.press("Escape");
      await other.getByRole("region", { name: "Tour" }).waitFor({ state: "hidden" });

      const [first, second] = stops();
      const missing = { ...second, show: "case=gone&view=1,1" };
      writeFileSync(tour(), JSON.stringify({ clipgs_tour: 1, volume: "", stops: [first, missing] }));
      const last = await visit();
      await last.evaluate(() => window.clipgs.showView(1));
      await last.getByText('View 2 is not shown: its case "gone" is not here').waitFor();
      expect(await last.evaluate(() => window.clipgs.views.length)).toBe(2);
      expect(await last.evaluate(() => window.clipgs.state.case)).toBe(name);
    });

    it("of a newer version are said to be, and left as they are", async () => {
      const text = JSON.stringify({ clipgs_marks: 7, volume: "", marks: [] });
      writeFileSync(file(), text);
      const page = await visit();
      await page
        .getByRole("status")
        .getByText(/phantom\.marks\.json: of a version/)
        .waitFor();
      await mark(page, "lost on nobody", 5);
      await page.waitForTimeout(600);
      expect(readFileSync(file(), "utf8")).toBe(text);
      expect(await names(page)).toEqual(["lost on nobody"]);
    });
  },
);
