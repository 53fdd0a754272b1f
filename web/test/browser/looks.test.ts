import { readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";

import { readZip } from "../../src/sog/zip";
import { makeZip } from "../unit/sog_fixture";
import { copyMadeCases } from "./made_cases";
import { missing } from "./program";
import { Session } from "./session";
import { show } from "./shot";

interface Block {
  look: { title: string; description: string };
  sphere: { center: number[]; radius: number };
  checksums: Record<string, string>;
}

describe.skipIf(missing !== undefined)(
  `looks of a volume${missing ? ` (${missing} is missing)` : ""}`,
  () => {
    const session = new Session();
    const errors: string[] = [];
    let page: Page;

    beforeAll(async () => {
      await session.start(async (cases) => {
        copyMadeCases(session);
        await addLook(cases, "solid", "solid", ({ look }) => (look.title = "Without a section"));
        ["layered.sog", "filmic.sog", "instant.sog"].forEach((one) => rmSync(join(cases, one)));
        await addLook(cases, "phantom", "skeleton", ({ look, sphere }) => {
          Object.assign(look, { title: "Skeleton", description: "Bone in ivory." });
          // As that of a look which shows less: the camera would stand elsewhere by itself.
          Object.assign(sphere, { center: sphere.center.map((v) => v + 20), radius: 0.7 * sphere.radius });
        });
        await addLook(cases, "phantom", "torn", ({ look, checksums }) => {
          look.title = "Torn";
          checksums["means_l.webp"] = "00000000";
        });
      });
      page = await session.open("#case=phantom", errors, { width: 680, height: 420 });
      await page.evaluate(() => window.clipgs.ready);
    });

    afterAll(async () => {
      expect(errors).toEqual([]);
      await session.stop();
    });

    /** Another case of the same volume. */
    async function addLook(
      cases: string,
      from: string,
      name: string,
      change: (block: Block) => void,
    ): Promise<void> {
      const archive = await readZip(readFileSync(join(cases, `${from}.sog`)));
      const meta = JSON.parse(new TextDecoder().decode(archive.get("meta.json"))) as { clipgs: Block };
      change(meta.clipgs);
      const json = new TextEncoder().encode(JSON.stringify(meta));
      writeFileSync(
        join(cases, `${name}.sog`),
        makeZip({ ...Object.fromEntries(archive), "meta.json": json }),
      );
    }

    const gallery = () => page.getByRole("dialog", { name: "Looks" });
    const shown = () => page.evaluate(() => window.clipgs.state.case);

    /** Where two points of the patient are seen, and what stays besides. */
    const kept = (where = page) =>
      where.evaluate(() => ({
        seen: [window.clipgs.project([10, 20, 30])!, window.clipgs.project([-30, -40, 0])!],
        state: { ...window.clipgs.state, case: "" },
        marks: window.clipgs.marks.map(({ id }) => id),
      }));

    it("are offered with pictures and words, and change nothing but the look", async () => {
      await show(page, {
        view: [40, 25, 1.3],
        plane: [0, -1, 0, 0],
        clip: "exact",
        grey: 1,
        shades: [300, 1500],
      });
      await page.evaluate(() => {
        const { min, max } = window.clipgs.bounds!;
        const [r, s] = [0.5 * (min[0] + max[0]), 0.5 * (min[2] + max[2])];
        const points: [number, number, number][] = [
          [r - 20, 0, s],
          [r + 20, 0, s],
        ];
        window.clipgs.addMark({ kind: "point", points: points.slice(0, 1) });
        window.clipgs.addMark({ kind: "length", points });
      });
      const before = await kept();
      expect(before.marks.length).toBe(2);
      const opener = page.getByRole("button", { name: "Look: Skin and bone" });
      await opener.click();
      await gallery().getByText("Not for diagnosis", { exact: true }).waitFor();
      expect(await gallery().locator(".card img").count()).toBe(4);
      const current = gallery().locator('[aria-current="true"]');
      expect(await current.textContent()).toMatch(/^Skin and bone.*inside/);
      expect(await current.evaluate((card) => card === document.activeElement)).toBe(true);
      await gallery()
        .getByRole("button", { name: /^Skeleton\s*Bone in ivory/ })
        .press("Enter");
      await expect.poll(shown).toBe("skeleton");
      await page.waitForFunction(() => window.clipgs.stats.sectionBytes > 0);
      await page.getByRole("button", { name: "Look: Skeleton" }).waitFor();
      const after = await kept();
      expect(after.state).toEqual(before.state);
      expect(after.marks).toEqual(before.marks);
      after.seen.forEach(({ x, y }, i) => {
        expect(Math.hypot(x - before.seen[i]!.x, y - before.seen[i]!.y), "px").toBeLessThan(0.01);
      });

      // The link says as much.
      await page.waitForFunction(
        () => location.hash.includes("case=skeleton") && location.hash.includes("back="),
      );
      const linked = await session.open(
        await page.evaluate(() => location.hash),
        errors,
        page.viewportSize()!,
      );
      await linked.evaluate(() => window.clipgs.ready);
      (await kept(linked)).seen.forEach(({ x, y }, i) => {
        expect(Math.hypot(x - before.seen[i]!.x, y - before.seen[i]!.y), "px").toBeLessThan(0.5);
      });
      await linked.close();
    });

    it("have the marks of one that can read values where they cannot", async () => {
      const before = await kept();
      await page.evaluate(() => window.clipgs.open("solid"));
      expect((await kept()).marks).toEqual(before.marks);
      await page.evaluate(() => window.clipgs.removeMark(window.clipgs.marks[1]!.id));
      await page.evaluate(() => window.clipgs.open("skeleton"));
      const after = await kept();
      expect(after.marks).toEqual(before.marks.slice(0, 1));
      expect(after.state).toEqual(before.state);
    });

    it("stay as they are where one is broken", async () => {
      const before = await shown();
      await page.locator("canvas.stage").focus();
      await page.keyboard.press("k");
      await gallery().locator('[data-case="torn"]').click();
      const message = page.getByRole("alert");
      await message.getByText(/torn.*means_l/).waitFor();
      expect(await shown()).toBe(before);
      await page.getByRole("button", { name: "Look: Skeleton" }).waitFor();
      await page.evaluate(() => window.clipgs.open("phantom"));
      await message.waitFor({ state: "hidden" });
    });

    it("stand together among the cases", async () => {
      await page.locator("canvas.stage").focus();
      await page.keyboard.press("m");
      const menu = page.getByRole("dialog", { name: "Cases" });
      const volume = menu.getByRole("region", { name: "One volume, 4 looks" });
      await volume.getByRole("button").nth(3).waitFor(); // the list is fetched anew when the menu opens
      expect(await volume.getByRole("button").count()).toBe(4);
      expect(await menu.locator(".card").count()).toBe(5);
      await menu.locator('[data-case="photo"]').click();
      await expect.poll(shown).toBe("photo");
    });

    it("have room for all that their cards say, whatever the screen, for fingers, too", async () => {
      const devtools = await page.context().newCDPSession(page);
      const library = page.getByRole("dialog", { name: "Cases" });
      const cutOff = () =>
        library.locator(".card").evaluateAll((cards) => {
          const bottom = (element: Element) => element.getBoundingClientRect().bottom;
          return cards
            .filter((card) => bottom(card.lastElementChild!) > bottom(card))
            .map(({ dataset }) => dataset["case"]);
        });
      await page.locator("canvas.stage").focus();
      await page.keyboard.press("m");
      for (const enabled of [true, false]) {
        await devtools.send("Emulation.setTouchEmulationEnabled", { enabled });
        for (const [width, height] of [
          [390, 844],
          [844, 390],
          [820, 1180],
          [680, 420],
        ] as const) {
          await page.setViewportSize({ width, height });
          await library.locator(".card").nth(4).waitFor();
          expect(await cutOff(), `${width} x ${height}`).toEqual([]);
        }
      }
      await page.keyboard.press("Escape");
    });

    it("are found in the library by keys alone, beside the names of their files", async () => {
      await page.locator("canvas.stage").focus();
      await page.keyboard.press("m");
      const library = page.getByRole("dialog", { name: "Cases" });
      const focused = () =>
        page.evaluate(() => document.activeElement?.closest<HTMLElement>("[data-case]")?.dataset["case"]);
      await expect.poll(focused).toBe("photo");
      const text = await library.locator('[data-case="phantom"]').textContent();
      expect(text).toMatch(/phantom\.sog.*Trunk · [\d.]+.[KM]B · \w+.\d+,.\d{4}/);
      await page.keyboard.press("End");
      await page.keyboard.press("ArrowLeft");
      expect(await focused()).not.toBe("photo");
      await page.keyboard.type("trunk SKÉLETON");
      await expect.poll(() => library.getByRole("status").textContent()).toBe("1 of 5 cases");
      expect(await library.locator(".card").count()).toBe(1);
      await page.keyboard.press("Enter");
      await expect.poll(shown).toBe("skeleton");
      expect(await library.count()).toBe(0);
    });

    it("are not offered where there is one", async () => {
      await page.evaluate(() => window.clipgs.open("photo"));
      expect(await page.getByRole("button", { name: /^Look:/ }).count()).toBe(0);
      await page.locator("canvas.stage").focus();
      await page.keyboard.press("k");
      expect(await gallery().count()).toBe(0);
    });
  },
);
