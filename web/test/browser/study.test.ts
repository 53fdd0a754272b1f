import { execFileSync } from "node:child_process";
import { mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { Quaternion, Vector3 } from "three";
import { afterAll, beforeAll, describe, expect, it } from "vitest";

import { kNoAnswer } from "../../src/model/case_list";
import { missingFor, startBrowser } from "./browsers";
import { broken, kAxe } from "./axe";
import { copyMadeCases } from "./made_cases";
import { kProgram, missing } from "./program";
import { kSmallEyes, Session } from "./session";
import { waitFor } from "./tab";
import { Wearer } from "./wearer";

type Line = Record<string, unknown> & { seq: number; kind: string };

/** The papers' plan with a task a mode, and no rest. */
function shortPlan(): Record<string, unknown> {
  const plan = JSON.parse(readFileSync("../presets/study/clipgs-vr.json", "utf8")) as {
    tasks: { name: string }[];
  };
  return { ...plan, name: "short", tasks: plan.tasks.slice(0, 1), pause_s: 0 };
}

describe.skipIf(missing !== undefined)(`a study${missing ? ` (${missing} is missing)` : ""}`, () => {
  const session = new Session();
  const errors: string[] = [];
  const folder = join(session.folder, "study");

  beforeAll(async () => {
    await session.start(
      () => {
        copyMadeCases(session);
        ["filmic.sog", "layered.sog", "photo.sog"].forEach((name) => rmSync(join(session.cases, name)));
        mkdirSync(folder);
        writeFileSync(join(folder, "short.json"), JSON.stringify(shortPlan()));
      },
      "--study",
      folder,
    );
  });

  afterAll(async () => {
    expect(errors).toEqual([]);
    expect(await session.stop(), "exit status of clipgs serve").toBe(0);
  });

  function recorded(participant: number): Line[] {
    const name = readdirSync(folder).filter(
      (one) => one.startsWith(`p00${participant}-`) && one.endsWith("l"),
    );
    expect(name).toHaveLength(1);
    const text = readFileSync(join(folder, name[0]!), "utf8");
    return text
      .trimEnd()
      .split("\n")
      .map((line) => JSON.parse(line) as Line);
  }

  const card = (page: Page) => page.locator(".study");
  /** By the keyboard: the emulated headset leaves the canvas over the page. */
  const press = (page: Page, text: string) => card(page).getByRole("button", { name: text }).press("Enter");

  async function begin(page: Page, participant: number, where: string): Promise<void> {
    await card(page).locator("input[type=number]").fill(String(participant));
    await press(page, where);
  }

  /** A participant with the headset on, in a mode: practises, does the task, and answers. */
  class Participant {
    readonly page: Page;
    readonly wearer: Wearer;

    constructor(page: Page) {
      this.page = page;
      this.wearer = new Wearer(page);
    }

    async say(...texts: string[]): Promise<void> {
      for (const text of texts) {
        await this.wearer.frames(2); // the board shows what was pressed before
        await this.wearer.pressText("right", text);
      }
    }

    async stand(): Promise<void> {
      await this.page.waitForFunction(() => window.clipgs.headset.worn);
      await this.wearer.stand([0, 1.6, 0]);
      await this.wearer.frames(3);
    }

    /** Takes hold of the plane before the eyes with the left hand, and pulls it up. */
    async pull(): Promise<void> {
      const at = new Vector3(0, 1.35, -0.8);
      for (const y of [0, 0.02, 0.04]) {
        await this.wearer.reach("left", at.clone().setY(1.35 + y), new Quaternion());
        if (y === 0) {
          await this.wearer.hold("left", 1);
        }
      }
      await this.wearer.hold("left", 0);
      await this.wearer.reach("left", new Vector3(-0.6, 1, 0));
    }

    /** Up to its end. */
    async workOnTask(): Promise<void> {
      await this.say("Start");
      await this.pull();
      await this.wearer.stand([0.1, 1.6, 0]);
      await this.wearer.stand([0, 1.6, 0]);
    }

    async doTask(): Promise<void> {
      await this.workOnTask();
      await this.say("Done");
    }

    /** To odd and even questions, then of efficiency. */
    async answer(odd: string, even: string, efficiency: string): Promise<void> {
      for (let i = 0; i < 10; ++i) {
        await this.say(i % 2 === 0 ? odd : even, i < 9 ? "Next" : "Send");
      }
      await this.say(efficiency, "Send");
    }

    /** A mode, in which the plane moves along the axis, or freely, and which is liked better. */
    async goThrough(mode: "uniaxial" | "arbitrary"): Promise<void> {
      await this.say("Go on");
      await this.doTask();
      await this.doTask();
      await (mode === "uniaxial" ? this.answer("3", "3", "3") : this.answer("5", "1", "5"));
    }

    async end(comment: string): Promise<void> {
      await this.say("Take off");
      await card(this.page).locator("textarea").fill(comment);
      await press(this.page, "Send");
      await card(this.page).getByText("Your answers are recorded").waitFor();
    }
  }

  async function openHere(): Promise<Page> {
    const page = await session.openInHeadset("", errors, kSmallEyes);
    await begun(page);
    return page;
  }

  /** Faces by the splats: frames come sooner, and no picture is looked at here. */
  async function begun(page: Page): Promise<void> {
    await page.waitForFunction(() => window.clipgs !== undefined); // a server begun anew may be slow
    await page.evaluate(() => window.clipgs.ready);
    await page.evaluate(() => window.clipgs.setSection("splats"));
  }

  it("leads three participants through both modes in the headset, whatever the power does meanwhile", async () => {
    const page = await openHere();
    const one = new Participant(page);
    // A slow disk: what is recorded then cannot be pressed past.
    await page.route("**/api/study/sessions/*", async (route) => {
      await new Promise((resolve) => setTimeout(resolve, 700));
      await route.continue();
    });
    await begin(page, 1, "Begin in the headset");
    await one.stand();
    await one.say("Go on");
    await one.goThrough("uniaxial");
    await one.goThrough("arbitrary");
    await one.end('It was, I think, "fine"');
    await press(page, "Next participant");
    await page.unroute("**/api/study/sessions/*");

    const two = new Participant(page);
    await begin(page, 2, "Begin in the headset");
    await two.stand();
    await two.say("Go on", "Go on");
    await two.doTask();
    // The server's power is cut while a task is done: what is recorded then waits, and says so.
    await two.workOnTask();
    await session.cutPower();
    await two.say("Done");
    const trouble = `Please call the experimenter. Nothing is lost: ${kNoAnswer}`;
    await page.waitForFunction((text) => window.clipgs.headset.find(text) !== null, trouble);
    expect(recorded(2).map(({ kind }) => kind)).toEqual(["session", "task"]);
    // Then this machine's, before anything could be sent.
    await session.serveAgain();
    await page.reload();
    await begun(page);
    await begin(page, 2, "Begin in the headset");
    await two.stand();
    await two.answer("5", "1", "5");
    // And once more in the middle of a task, which is begun again.
    await two.say("Go on", "Start");
    await session.cutPower();
    await session.serveAgain();
    await page.reload();
    await begun(page);
    await begin(page, 2, "Begin in the headset");
    await two.stand();
    await two.goThrough("uniaxial");
    await two.end("");
    await press(page, "Next participant");

    const three = new Participant(page);
    await begin(page, 3, "Begin in the headset");
    await three.stand();
    await three.say("Go on");
    await three.goThrough("uniaxial");
    await three.goThrough("arbitrary");
    await three.end("");

    for (const participant of [1, 2, 3]) {
      const lines = recorded(participant);
      expect(lines.map(({ seq }) => seq)).toEqual(lines.map((_, i) => i));
      const half = ["task", "task", "answers", "answers"];
      expect(lines.map(({ kind }) => kind)).toEqual(["session", ...half, ...half, "comment", "end"]);
      const order = participant === 2 ? ["arbitrary", "uniaxial"] : ["uniaxial", "arbitrary"];
      expect(lines[0]).toMatchObject({ plan: "short", participant, order, device: "headset" });
      for (const line of lines.filter(({ kind }) => kind === "task")) {
        const number = (key: string) => line[key] as number;
        expect(number("travel_mm"), "of the plane that was pulled up by 40 mm").toBeGreaterThan(20);
        expect(number("travel_mm")).toBeLessThan(60);
        expect(number("head_mm"), "aside by 100 mm and back").toBeGreaterThan(190);
        expect(line["regrasps"]).toBe(0);
        expect(number("frames")).toBeGreaterThan(10);
        expect(number("frame_ms")).toBeGreaterThan(0);
        expect(number("frames") * number("frame_ms") * 0.001).toBeLessThan(number("seconds") + 1);
        expect([typeof line["low_fps"], typeof line["dropped"]]).toEqual(["number", "number"]);
      }
    }
    expect(recorded(1).at(-2)).toMatchObject({ kind: "comment", text: 'It was, I think, "fine"' });
    await page.close();
  }, 900_000);

  it("takes nobody twice, and says why a number is refused", async () => {
    const page = await openHere();
    await begin(page, 1, "Begin at the desk");
    await card(page).getByText("participant 1 has taken part already").waitFor();
    await begin(page, 0, "Begin at the desk");
    await card(page).getByText("whole number from 1 to 9999").waitFor();
    await page.close();
  });

  it("leads at the desk with a keyboard, without the panel, keeps the mode, and tells of a full disk", async () => {
    const page = await openHere();
    await begin(page, 4, "Begin at the desk");
    await card(page).getByText("Go on").click();
    await card(page).getByText("Go on").click();
    await card(page).getByText("Start").click();
    expect(await page.locator(".panel").isVisible()).toBe(false);
    expect(await page.evaluate(() => window.clipgs.marks.length)).toBe(1);
    for (const part of [".case-button", ".mark-label button"]) {
      expect(await page.locator(part).evaluate((element) => element.closest("[inert]") !== null)).toBe(true);
    }
    const mode = () => page.evaluate(() => window.clipgs.state.mode);
    expect(await mode()).toBe("arbitrary");
    await page.locator("canvas.stage").focus();
    await page.keyboard.press("u");
    await page.keyboard.press("p");
    expect(await mode()).toBe("arbitrary");
    expect(await page.evaluate(() => window.clipgs.state.plane)).not.toBeNull();
    await card(page).getByRole("slider").focus();
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("ArrowRight");
    // A file that cannot be written stands for a full disk.
    const [file] = readdirSync(folder).filter((one) => one.startsWith("p004-") && one.endsWith(".jsonl"));
    const path = join(folder, file!);
    const before = readFileSync(path, "utf8");
    await page.route("**/api/study/sessions/*", (route) =>
      route.fulfill({ status: 507, body: "the disk is full; make room\n" }),
    );
    await press(page, "Done");
    await card(page).getByText("Please call the experimenter. Nothing is lost: the disk is full").waitFor();
    const [download] = await Promise.all([page.waitForEvent("download"), press(page, "Save a copy")]);
    const copy = readFileSync(await download.path(), "utf8");
    expect(copy.startsWith(before)).toBe(true);
    expect(copy).toContain('"kind":"task"');
    expect(readFileSync(path, "utf8")).toBe(before);
    await page.unroute("**/api/study/sessions/*");
    await card(page).getByText("Start").waitFor();
    const lines = copy.trimEnd().split("\n");
    expect(recorded(4)).toEqual(lines.map((line) => JSON.parse(line) as Line));
    const task = recorded(4)[1]!;
    expect(task).toMatchObject({ mode: "arbitrary", practice: true, head_mm: null, display_hz: null });
    expect(task["travel_mm"], "two steps of 0.1 mm, or to the next of them").toBeGreaterThan(0.1);
    expect(task["travel_mm"]).toBeLessThan(0.21);
    await page.close();
  });

  it("speaks the language of its plan, and axe-core finds nothing wrong", async () => {
    const german = JSON.parse(readFileSync("../presets/study/clipgs-vr-de.json", "utf8")) as {
      modes: unknown[];
    };
    const one = german.modes.slice(0, 1);
    writeFileSync(join(folder, "german.json"), JSON.stringify({ ...german, modes: one, name: "german" }));
    const page = await session.openPage(session.url.replace("short", "german"), errors, undefined, [kAxe]);
    await begun(page);
    const found: string[] = [];
    const look = async (title: string) => {
      await card(page).getByRole("heading", { name: title }).waitFor();
      found.push(...(await broken(page)).map((what) => `${title}: ${what}`));
    };
    await look("Eine Achse oder jeder Winkel");
    await begin(page, 7, "Am Bildschirm beginnen");
    await press(page, "Weiter");
    await look("Eine Achse");
    await press(page, "Weiter");
    for (const title of ["Zum Üben", "Aufgabe 1 von 3", "Aufgabe 2 von 3", "Aufgabe 3 von 3"]) {
      await look(title);
      await press(page, "Start");
      await look(title);
      await press(page, "Fertig");
    }
    for (let i = 1; i <= 10; ++i) {
      await card(page)
        .getByRole("heading", { name: `Frage ${i} von 10` })
        .waitFor();
      await press(page, "4");
      await press(page, i < 10 ? "Weiter" : "Absenden");
    }
    await look("Noch eine Frage");
    await press(page, "5");
    await press(page, "Absenden");
    await look("In Ihren Worten");
    expect(await card(page).getAttribute("lang")).toBe("de");
    expect(found).toEqual([]);
    await page.close();
    // Of another plan, it is not to be analysed with the others.
    readdirSync(folder)
      .filter((name) => name.startsWith("p007-"))
      .forEach((name) => rmSync(join(folder, name)));
  });

  it.each(["firefox", "webkit"] as const)("is led through in %s", async (name) => {
    const participant = { firefox: 5, webkit: 6 }[name];
    const reason = missingFor(name);
    if (reason) {
      console.warn(`not tried in ${name}: ${reason}`);
      return;
    }
    const browser = await startBrowser(name);
    const { tab } = browser;
    /** Where a button of this text is, when it can be pressed. */
    const clickText = async (text: string) => {
      const find = (wanted: string) => {
        const all = [...document.querySelectorAll<HTMLButtonElement>(".study button")];
        const box = all.find((one) => one.textContent === wanted && !one.disabled)?.getBoundingClientRect();
        return box ? { x: box.x + box.width / 2, y: box.y + box.height / 2 } : null;
      };
      await waitFor(tab, find, text);
      await tab.click((await tab.evaluate(find, text))!);
    };
    await tab.open(session.url);
    await waitFor(tab, () => document.activeElement?.matches(".study input"), undefined);
    await tab.press(String(participant));
    await clickText("Begin at the desk");
    await clickText("Go on");
    await clickText("Go on");
    await clickText("Start");
    await tab.evaluate(() => document.querySelector<HTMLInputElement>(".study input[type=range]")!.focus());
    await tab.press("\uE014"); // the arrow to the right
    await clickText("Done");
    await waitFor(tab, () => document.querySelector(".study h2")?.textContent === "Task 1 of 1", undefined);
    await browser.close();
    expect(recorded(participant).map(({ kind }) => kind)).toEqual(["session", "task"]);
    expect(recorded(participant)[1]!["travel_mm"], "a state, or a step of the slider").toBeGreaterThan(0);
  });

  it("is refused in one line where the plan, its case or its targets are wrong", async () => {
    const refused = async (change: (plan: Record<string, unknown>) => void): Promise<string> => {
      const plan = shortPlan();
      change(plan);
      writeFileSync(join(folder, "wrong.json"), JSON.stringify(plan));
      const page = await session.openPage(session.url.replace("short", "wrong"), []);
      await page.locator(".message").waitFor();
      const text = await page.locator(".message p").textContent();
      await page.close();
      return text!;
    };
    expect(await refused((plan) => (plan["case"] = "liver"))).toMatch(/its case "liver" is not served/);
    expect(await refused((plan) => (plan["case"] = "solid"))).toMatch(/solid: has no section/);
    expect(await refused((plan) => (plan["pins"] = {}))).toMatch(/is the pin "gallbladder", which the plan/);
    expect(
      await refused((plan) => ((plan["pins"] as Record<string, number[]>)["gallbladder"] = [0, 900, 0])),
    ).toMatch(/the target of "gallbladder" is not in phantom/);
    const page = await session.openPage(session.url.replace("short", "none"), []);
    await page.getByText("there is no plan none.json").waitFor();
    await page.close();
  });

  it("is analysed from what it recorded", () => {
    const file = join(session.folder, "figures.json");
    const report = execFileSync(kProgram, ["study", folder, "--json", file], { encoding: "utf8" });
    expect(report).toMatch(/p004-\w+\.jsonl: is not finished; participant 4 is left out/);
    interface Measure {
      measure: string;
      n: number;
      first: { mean: number };
      second: { mean: number };
    }
    const { measures } = JSON.parse(readFileSync(file, "utf8")) as { measures: Measure[] };
    const means = (name: string) => {
      const { n, first, second } = measures.find(({ measure }) => measure === name)!;
      return [n, first.mean, second.mean];
    };
    expect(means("sus")).toEqual([3, 50, 100]);
    expect(means("efficiency")).toEqual([3, 3, 5]);
    expect(means("regrasps")).toEqual([3, 0, 0]);
    expect(measures.map(({ measure }) => measure)).toEqual(
      expect.arrayContaining(["seconds", "travel_mm", "head_mm", "distance_mm", "frame_ms"]),
    );
  });
});
