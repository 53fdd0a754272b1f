// What must be the same in every browser: pictures, values and links.

import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { afterAll, beforeAll, describe, expect, it } from "vitest";

import type { Triple } from "../../src/model/geometry";
import { shader } from "../../src/render/shaders";
import { readZip } from "../../src/sog/zip";
import { makeZip } from "../unit/sog_fixture";
import { kBrowsers, missingFor, startBrowser } from "./browsers";
import { copyMadeCases } from "./made_cases";
import { normalCdf, runNormalCdf } from "./normal_cdf";
import { coverage, decodePng, pagePicture, type Picture, psnr } from "./picture";
import { comeToRest, useTabAtRandom } from "./monkey";
import { missing } from "./program";
import { Server } from "./server";
import { choose, facesOf, rendered, type Shot, show, valueAt } from "./shot";
import { type Browser, type Evaluates, type Tab, waitFor } from "./tab";

// dB of pictures that are drawn alike, pixel by pixel; the program has several rays through a pixel at edges alone.
const kMinAlike = 48;
const kMinShown = 35; // dB of what a page shows, whose edges are drawn anew
const kSeed = 20261128;
const kRandomActions = 100;
/** From the middle of the body to its right and forward, mm. */
const kPins = [
  [0, 0],
  [31, 12],
  [-20, 24],
] as const;
const kPoints: Triple[] = [
  [-12, 14, -30],
  [24, -8, 12.5],
  [3, 30, 41],
  [-31, 2, 3],
];

const kViews: Shot["view"][] = [
  [0, 0, 1],
  [35, 20, 1],
  [-110, -30, 1.6],
  [0, 90, 1],
];
const kPlanes: Shot["plane"][] = [
  [0, -1, 0, 0],
  [0.5, 0.3, -0.6, 10],
];
/** Every plane with its faces drawn from the volume and by splats. */
const kShots: Shot[] = [
  ...kViews.map((view): Shot => ({ view, plane: null, clip: "exact" })),
  ...kPlanes.flatMap((plane) =>
    (["hard", "soft", "exact"] as const).flatMap((clip, i) => facesOf({ view: kViews[i]!, plane, clip })),
  ),
  ...facesOf({ view: [60, 10, 3], plane: [-1, 0, 0, -20], clip: "exact" }),
  // A slab and two planes more; a second plane alone.
  ...(["hard", "soft", "exact"] as const).flatMap((clip) =>
    facesOf({
      view: [30, 35, 1],
      plane: [0, 0, -1, -40],
      more: [
        [0.2, -1, 0.1, -20, 45],
        [1, 0.1, 0, -60],
      ],
      clip,
    }),
  ),
  ...facesOf({ view: [-40, 30, 1], plane: [0, -1, 0, 0], more: [[0, 0, -1, -30]], clip: "exact" }),
  // A plane along which one looks, from just before it and just behind it, and two of them.
  { view: [90, 0, 1], plane: [0, -1, 0, 0.5], clip: "exact", section: "volume" },
  { view: [90, 0, 1], plane: [0, -1, 0, -0.5], clip: "exact", section: "splats" },
  {
    view: [90, 0, 1.5],
    plane: [0.004, -1, 0, 0],
    more: [[0, 0.003, -1, -20]],
    clip: "exact",
    section: "volume",
  },
  // Other lights than the case was made in, whole and cut.
  { view: [35, 20, 1], plane: null, clip: "exact", section: "volume", rig: "theatre" },
  { view: [35, 20, 1], plane: [0.5, 0.3, -0.6, 10], clip: "exact", section: "volume", rig: "rim" },
  { view: [35, 20, 1], plane: [0.5, 0.3, -0.6, 10], clip: "exact", section: "volume", rig: "rim", turn: 70 },
  { view: [35, 20, 1], plane: [0, -1, 0, 0], clip: "exact", section: "volume", lamp: [0.5, 0.8, 0.3] },
  // A tone curve, of faces and of splats in other lights.
  { name: "filmic", view: [35, 20, 1], plane: [0, -1, 0, 0], clip: "exact", section: "volume" },
  { name: "filmic", view: [35, 20, 1], plane: null, clip: "exact", section: "volume", rig: "rim" },
  // Placed splats, which are drawn where the surface is not.
  { name: "instant", view: [35, 20, 1], plane: [0.5, 0.3, -0.6, 10], clip: "exact", section: "volume" },
  { name: "instant", view: [35, 20, 1], plane: [0.5, 0.3, -0.6, 10], clip: "exact", section: "splats" },
  // Face colours, at one plane and at three.
  ...(["hard", "soft", "exact"] as const).map(
    (clip, i): Shot => ({ name: "solid", view: kViews[i]!, plane: kPlanes[1]!, clip, section: "splats" }),
  ),
  {
    name: "solid",
    view: [-40, 30, 1.1],
    plane: [0, -1, 0, 0],
    more: [
      [0, 0, -1, -30],
      [1, 0.1, 0, -20, 30],
    ],
    clip: "exact",
    section: "splats",
  },
  ...[0, 1].map(
    (grey): Shot => ({
      name: "photo",
      view: [35, 20, 1],
      plane: [0.2, -1, 0.3, 5],
      clip: "exact",
      section: "volume",
      grey,
    }),
  ),
  { view: [35, 20, 1], plane: [0, -1, 0, 0], clip: "exact", section: "volume", grey: 1, shades: [40, 400] },
  {
    view: [20, 60, 1],
    plane: [0.1, 0, -1, 10],
    clip: "exact",
    section: "volume",
    grey: 0.5,
    shades: [-300, 900],
  },
  // What is behind the openings of grey faces, wholly and in part; in the window of the lungs nothing is.
  ...(["cinematic", "neutral", "values"] as const).map(
    (openings): Shot => ({
      view: [20, 60, 1],
      plane: [0.1, 0, -1, 10],
      clip: "exact",
      section: "volume",
      grey: openings === "neutral" ? 0.6 : 1,
      shades: [40, 400],
      openings,
    }),
  ),
  {
    view: [20, 60, 1],
    plane: [0.1, 0, -1, 10],
    clip: "exact",
    section: "volume",
    grey: 1,
    shades: [-600, 1500],
  },
];

/** What a shot shows, in words. */
function nameOf(shot: Shot): string {
  const { name, view, plane, more = [], clip, section, grey, shades, openings, rig, turn, lamp } = shot;
  const style = [
    ...(grey ? [`grey ${grey} ${shades?.join() ?? ""} ${openings ?? ""}`] : []),
    ...(rig ? [`${rig} ${turn ?? ""}`] : []),
    ...(lamp ? [`lamp ${lamp.join()}`] : []),
    ...(name ? [name] : []),
  ]
    .map((part) => `, ${part.trim()}`)
    .join("");
  const others = more.map((numbers) => ` and ${numbers.join()}`).join("");
  const cut = plane ? `plane ${plane.join()}${others}, ${clip}, ${section}` : "uncut";
  return `view ${view.join()}, ${cut}${style}`;
}

/** What a case says of its images. */
interface Block {
  checksums?: Record<string, string>;
  section: { checksum?: string };
}

const server = new Server();
const truths = new Map<string, Promise<Picture>>();

/** What `clipgs render` makes of a shot, once for all browsers. */
function truthOf(shot: Shot, size: string, ...options: string[]): Promise<Picture> {
  const key = JSON.stringify([shot, size, options]);
  const truth = truths.get(key) ?? rendered(server, shot, size, options);
  truths.set(key, truth);
  return truth;
}

/** From now on what goes wrong in the page is remembered. */
async function watchErrors(page: Evaluates): Promise<void> {
  await page.evaluate(() => {
    const errors: string[] = [];
    Object.assign(window, { errors });
    addEventListener("error", (event) => errors.push(event.message));
    addEventListener("unhandledrejection", (event) => errors.push(String(event.reason)));
  });
}

/** Opens the viewer; `hash` as in a link. */
async function openViewer(page: Tab, hash: string): Promise<void> {
  await page.open("about:blank"); // else a new hash alone would not open anything
  await page.open(server.url + hash);
  await waitFor(page, () => window.clipgs !== undefined, undefined);
  await watchErrors(page);
  await page.evaluate(() => window.clipgs.ready);
}

const hashOf = (page: Evaluates): Promise<string> => page.evaluate(() => location.hash);

/** Pixels through which one sees, though those around them and they themselves are solid in truth. */
function holes(got: Picture, truth: Picture): [number, number][] {
  const alpha = (picture: Picture, x: number, y: number) => picture.data[4 * (y * picture.width + x) + 3]!;
  const around = [-1, 0, 1].flatMap((dy) => [-1, 0, 1].map((dx) => [dx, dy] as const));
  const found: [number, number][] = [];
  for (let y = 1; y < got.height - 1; ++y) {
    for (let x = 1; x < got.width - 1; ++x) {
      if (alpha(got, x, y) < 230 && around.every(([dx, dy]) => alpha(truth, x + dx, y + dy) === 255)) {
        found.push([x, y]);
      }
    }
  }
  return found;
}

/** How much of the slice is black, and grey; null: it is not drawn yet. Runs in the page. */
function greysOfSlice(): { black: number; between: number } | null {
  const canvas = document.querySelector<HTMLCanvasElement>(".slice.axial canvas");
  const copy = document.createElement("canvas");
  copy.width = copy.height = 64;
  const context = copy.getContext("2d")!;
  if (!canvas || canvas.width === 0) {
    return null;
  }
  context.drawImage(canvas, 0, 0, 64, 64);
  const { data } = context.getImageData(0, 0, 64, 64);
  const values = Array.from({ length: 64 * 64 }, (_, i) => data[4 * i]!);
  const share = (is: (value: number) => boolean) => values.filter(is).length / values.length;
  const between = share((value) => value > 20 && value < 235);
  return between > 0 ? { black: share((value) => value < 20), between } : null;
}

/** By how much two values differ, such as "−71 ± 7 HU". */
function off(one: string, other: string): number {
  const value = (text: string): number => Number.parseFloat(text.replace("\u2212", "-"));
  return Math.abs(value(one) - value(other));
}

/** What of an element is seen; null: none is there, or not seen. */
function textOf(page: Evaluates, selector: string): Promise<string | null> {
  return page.evaluate((wanted: string) => {
    const element = document.querySelector(wanted);
    return element?.checkVisibility() ? element.textContent : null;
  }, selector);
}

describe.skipIf(missing !== undefined)(`browsers${missing ? ` (${missing} is missing)` : ""}`, () => {
  beforeAll(() =>
    server.start(async (cases) => {
      copyMadeCases(server);
      const phantom = join(cases, "phantom.sog");
      await remake(phantom, join(cases, "other-voxels.sog"), ({ section }) => {
        section.checksum = "00000000";
      });
      await remake(phantom, join(cases, "other-texels.sog"), ({ checksums }) => {
        checksums!["quats.webp"] = "00000000";
      });
      await remake(phantom, join(cases, "older.sog"), (block) => {
        delete block.checksums;
        delete block.section.checksum;
      });
    }),
  );

  afterAll(async () => {
    expect(await server.stop(), "exit status of clipgs serve").toBe(0);
  });

  for (const name of kBrowsers) {
    const lacking = missingFor(name);
    describe.skipIf(lacking !== undefined)(`${name}${lacking ? ` (${lacking})` : ""}`, () => {
      let browser: Browser;
      let page: Tab;
      let least = Infinity; // dB

      beforeAll(async () => {
        browser = await startBrowser(name);
        page = browser.tab;
        // What the page itself shows is small: it is drawn, too, whenever something changes.
        await openViewer(page, "#case=phantom&size=64x64");
      });

      afterAll(async () => {
        console.log(
          `${browser?.version}: pictures equal those of clipgs render to ${least.toFixed(1)} dB or more`,
        );
        try {
          expect(await page.evaluate(() => (window as unknown as { errors: string[] }).errors)).toEqual([]);
        } finally {
          await browser?.close();
        }
      });

      for (const shot of kShots) {
        it(`equals clipgs render: ${nameOf(shot)}`, async () => {
          const truth = await truthOf(shot, "210x154");
          await choose(page, shot.name ?? "phantom");
          await show(page, shot);
          const got = await pagePicture(page, truth.width, truth.height);
          expect(coverage(truth)).toBeGreaterThan(0.03);
          const { color, alpha } = psnr(got, truth);
          least = Math.min(least, color, alpha);
          expect(color).toBeGreaterThan(kMinAlike);
          expect(alpha).toBeGreaterThan(kMinAlike);
        });
      }

      it("draws states by layers as clipgs render does, and other cuts exactly", async () => {
        await choose(page, "layered");
        const none: Shot = {
          name: "layered",
          view: [25, 30, 1],
          plane: null,
          clip: "layers",
          section: "splats",
        };
        for (const state of [60, 110, 150]) {
          const truth = await truthOf(none, "210x154", "--state", String(state));
          await show(page, none);
          await page.evaluate((k: number) => window.clipgs.setState(k), state);
          const got = await pagePicture(page, truth.width, truth.height);
          expect(coverage(truth)).toBeGreaterThan(0.03);
          expect(psnr(got, truth).color, `state ${state}`).toBeGreaterThan(kMinAlike);
          expect(psnr(got, truth).alpha, `state ${state}`).toBeGreaterThan(kMinAlike);
          await page.evaluate(() => window.clipgs.setClip("exact"));
          const exact = await pagePicture(page, truth.width, truth.height);
          expect(psnr(exact, truth).color, `state ${state}`).toBeLessThan(kMinAlike - 5);
        }
        const pictures = [];
        for (const clip of ["layers", "exact"] as const) {
          await show(page, { ...none, plane: [0.2, -1, -0.1, 0], clip });
          pictures.push(await pagePicture(page, 160, 160));
        }
        expect(pictures[0]!.data).toEqual(pictures[1]!.data);
        await choose(page, "phantom");
      });

      it("cuts more or less as the plane moves", async () => {
        const at = async (offset: number) => {
          await show(page, { view: [0, 0, 1], plane: [0, 0, -1, offset], clip: "exact" });
          return pagePicture(page, 160, 160);
        };
        const most = await at(-120);
        const half = await at(0);
        const little = await at(120);
        expect(coverage(most)).toBeGreaterThan(1.3 * coverage(half));
        expect(coverage(half)).toBeGreaterThan(1.3 * coverage(little));
        expect(psnr(most, half).color).toBeLessThan(20);
      });

      it("has no holes in a face wherever its plane is", async () => {
        for (let step = 0; step < 12; ++step) {
          const shot: Shot = { view: [20, 40, 1], plane: [0, 0.1, -1, 7.3 - 3.1 * step], clip: "exact" };
          const truth = await truthOf(shot, "128x128");
          await show(page, shot);
          const got = await pagePicture(page, 128, 128);
          expect(holes(got, truth), `plane ${shot.plane!.join()}`).toEqual([]);
          expect(psnr(got, truth).alpha).toBeGreaterThan(kMinAlike);
          expect(psnr(got, truth).color).toBeGreaterThan(kMinAlike);
        }
      });

      it("has a Φ that is the normal distribution's to 1.5e-4", async () => {
        const at = Array.from({ length: 1601 }, (_, i) => 0.01 * i - 8);
        const got = await page.evaluate(runNormalCdf, { text: shader("gaussian.glsl"), at });
        at.forEach((z, i) => {
          expect(Math.abs(got[i]! - normalCdf(z)), `Φ(${z.toFixed(2)}) = ${got[i]}`).toBeLessThan(1.5e-4);
        });
      });

      it("tells the three operators apart", async () => {
        const pictures = [];
        for (const clip of ["hard", "soft", "exact"] as const) {
          await show(page, { view: [0, 0, 1], plane: [0, -1, 0, 0], clip, section: "splats" });
          pictures.push(await pagePicture(page, 160, 160));
        }
        for (const [a, b] of [
          [0, 1],
          [1, 2],
          [0, 2],
        ] as const) {
          const { color } = psnr(pictures[a]!, pictures[b]!);
          expect(color).toBeGreaterThan(20); // a cut of the same thing
          expect(color).toBeLessThan(58); // equal pictures have no error at all
        }
      });

      it("says values under the pointer and of pins as clipgs render does", async () => {
        await openViewer(page, "#case=phantom");
        await show(page, { view: [10, 60, 1], plane: [0, 0, -1, 0], clip: "exact" });
        const [r, a] = await page.evaluate(() =>
          window.clipgs.bounds!.min.map((low, k) => 0.5 * (low + window.clipgs.bounds!.max[k]!)),
        );
        for (const [toRight, forward] of kPins) {
          const point: Triple = [r! + toRight, a! + forward, 0];
          const at = (await page.evaluate((p: Triple) => window.clipgs.project(p), point))!;
          await page.move(at);
          await waitFor(
            page,
            () => document.querySelector("[aria-label='Value under the pointer']")?.checkVisibility(),
            undefined,
          );
          await page.press("i");
          const pin = (await page.evaluate(() => window.clipgs.marks)).at(-1)!;
          expect(Math.abs(pin.points[0]![0] - point[0])).toBeLessThan(1.5); // the mouse is at a whole pixel
          expect(pin.points[0]![2]).toBeCloseTo(0, 3);
          expect(pin.text.replace("\u2212", "-")).toBe(await valueAt(server, pin.points[0]!));
          expect(await textOf(page, "[aria-label='Value under the pointer']")).toContain(pin.text);
        }
        await waitFor(page, () => location.hash.split("pin=").length === 4, undefined);
        const pins = await page.evaluate(() => window.clipgs.marks);
        await openViewer(page, await hashOf(page));
        const followed = await page.evaluate(() => window.clipgs.marks);
        expect(followed).toHaveLength(pins.length);
        // A link has hundredths of millimetres, by which a value may be rounded to its neighbour.
        followed.forEach(({ text }, i) => expect(off(text, pins[i]!.text)).toBeLessThanOrEqual(1));
      });

      it("refuses what does not decode to what was written, and shows nothing of it", async () => {
        const failure = (wanted: string) =>
          page.evaluate(
            (one: string) =>
              window.clipgs.open(one).then(
                () => "",
                (error: Error) => error.message,
              ),
            wanted,
          );
        await choose(page, "phantom");
        expect(await failure("other-texels")).toMatch(/^quats\.webp .*its checksum differs.*not shown/);
        expect(await page.evaluate(() => window.clipgs.state.case)).toBe("phantom");
        expect(await failure("other-voxels")).toBe("");
        expect(await textOf(page, ".message[role=alert]")).toMatch(
          /without the values of the scan.*section\.obu .*checksum differs/,
        );
        expect(await page.evaluate(() => window.clipgs.stats.sectionBytes)).toBe(0);
        expect(await failure("older")).toBe("");
        expect(await textOf(page, ".message[role=alert]")).toBeNull();
        await choose(page, "phantom");
      });

      it("gives points the same values as clipgs render", async () => {
        for (const point of kPoints) {
          const text = await page.evaluate((p: Triple) => {
            const id = window.clipgs.addMark({ kind: "point", points: [p] });
            const said = id ? window.clipgs.marks.at(-1)!.text : null;
            if (id) {
              window.clipgs.removeMark(id);
            }
            return said;
          }, point);
          expect(text?.replace("\u2212", "-")).toBe(await valueAt(server, point));
        }
      });

      it("follows links, and writes them", async () => {
        await openViewer(
          page,
          "#case=solid&view=12,34,1.5&plane=0,0,-1,5&slab=0,1,0,-20,35&clip=hard&size=64x64",
        );
        const state = () => page.evaluate(() => window.clipgs.state);
        expect(await state()).toMatchObject({
          case: "solid",
          view: { azimuth: 12, elevation: 34, zoom: 1.5 },
          clip: "hard",
          cuts: [
            { normal: [0, 0, -1], offset: 5 },
            { normal: [0, 1, 0], offset: -20, thickness: 35 },
          ],
        });
        await page.evaluate(() => {
          window.clipgs.marks.forEach(({ id }) => window.clipgs.removeMark(id)); // kept of another look of the volume
          window.clipgs.setPlane({ normal: [1, 0, 0], offset: 3 });
        });
        await waitFor(page, () => location.hash.includes("plane=1,0,0,3"), undefined);
        expect(await hashOf(page)).toBe("#case=solid&view=12,34,1.5&plane=1,0,0,3&clip=hard&size=64x64");
        await page.evaluate(() => void (location.hash = "#case=phantom&state=42&size=64x64"));
        await waitFor(
          page,
          () => window.clipgs.state.case === "phantom" && window.clipgs.state.state === 42,
          undefined,
        );
      });

      it("has the rooms around a case: cases, views, slices, a case beside, files of one's own", async () => {
        await openViewer(page, "#case=phantom&view=20,20&plane=0,0,-1,0&grey=1");
        const press = (key: string) =>
          page.evaluate((one: string) => {
            const stage = document.querySelector<HTMLElement>("canvas.stage")!;
            stage.focus();
            stage.dispatchEvent(new KeyboardEvent("keydown", { key: one, bubbles: true }));
          }, key);
        const cards = (wanted: number) =>
          waitFor(page, (n: number) => document.querySelectorAll("dialog[open] .card").length === n, wanted);
        const type = (text: string) =>
          page.evaluate((what: string) => {
            const field = document.querySelector<HTMLInputElement>("dialog[open] [type=search]")!;
            field.value = what;
            field.dispatchEvent(new Event("input"));
          }, text);

        // Slices: the axial one has the values that are read in the cut.
        await press("q");
        await waitFor(page, () => document.querySelector(".slice canvas") !== null, undefined);
        await page.evaluate(() =>
          document.querySelectorAll<HTMLElement>(".slice-tools .segments button")[1]!.click(),
        );
        await waitFor(page, greysOfSlice, undefined);
        const greys = (await page.evaluate(greysOfSlice))!;
        expect(greys.black).toBeGreaterThan(0.1); // around the body
        expect(greys.between).toBeGreaterThan(0.05); // in it
        await press("q");

        // Cases, of which one is searched for and shown beside.
        await press("y");
        await waitFor(page, () => document.querySelector("dialog[open] .card") !== null, undefined);
        await type("striped");
        await cards(1);
        await page.evaluate(() => document.querySelector<HTMLElement>("dialog[open] .card")!.click());
        await waitFor(page, () => location.hash.includes("beside=photo"), undefined);
        await expect.poll(() => textOf(page, ".beside-title")).toContain("Striped ball");
        await press("y");
        await waitFor(page, () => !location.hash.includes("beside="), undefined);

        // A view that is saved, and flown to.
        await page.evaluate(() => {
          window.clipgs.saveView("Here");
          window.clipgs.setView({ azimuth: 80, elevation: 5 });
        });
        await page.evaluate(() => window.clipgs.showView(0));
        await waitFor(
          page,
          () => Math.abs(window.clipgs.state.view.azimuth - 20) < 0.01 && window.clipgs.stats.settled,
          undefined,
        );

        // A file, through the field that a person chooses one with.
        await press("m");
        await waitFor(page, () => document.querySelector("dialog[open] [type=file]") !== null, undefined);
        await page.evaluate(async () => {
          const bytes = await (await fetch("cases/photo.sog")).blob();
          const given = new DataTransfer();
          given.items.add(new File([bytes], "mine.sog"));
          const field = document.querySelector<HTMLInputElement>("dialog[open] [type=file]")!;
          field.files = given.files;
          field.dispatchEvent(new Event("change"));
        });
        await waitFor(page, () => window.clipgs.state.case === "mine.sog", undefined);
        expect(await textOf(page, ".title")).toBe("Striped ball");
        await openViewer(page, "#case=phantom&size=64x64");
      });

      it("shows on the page what it gives to scripts", async () => {
        await openViewer(page, "#case=phantom&view=35,20&plane=0,-1,0,0&size=160x160");
        await page.evaluate(() =>
          document.head.append(
            Object.assign(document.createElement("style"), { textContent: "footer { display: none }" }),
          ),
        );
        await page.press("h"); // without the handle
        const side = 160 * (await page.evaluate(() => devicePixelRatio));
        const picture = await pagePicture(page, side, side);
        await waitFor(page, () => window.clipgs.stats.settled, undefined);
        await page.evaluate(
          () =>
            new Promise<void>((drawn) => requestAnimationFrame(() => requestAnimationFrame(() => drawn()))),
        );
        const shown = decodePng(await page.screenshot());
        expect(psnr(topLeft(shown, side, side), onBlack(picture)).color).toBeGreaterThan(kMinShown);
      });

      it("stands random input, and shows the case afterwards", async () => {
        await openViewer(page, "#case=phantom&size=240x160");
        await useTabAtRandom(page, kSeed, kRandomActions);
        await comeToRest(page, "phantom");
        expect(coverage(await pagePicture(page, 96, 96))).toBeGreaterThan(0.03);
      });
    });
  }
});

function topLeft({ width, data }: Picture, w: number, h: number): Picture {
  const rows = Array.from({ length: h }, (_, y) => data.subarray(4 * width * y, 4 * (width * y + w)));
  return { width: w, height: h, data: Uint8Array.from(rows.flatMap((row) => [...row])) };
}

/** The case with its `clipgs` block changed. */
async function remake(from: string, to: string, change: (block: Block) => void): Promise<void> {
  const entries = await readZip(Uint8Array.from(readFileSync(from)));
  const meta = JSON.parse(new TextDecoder().decode(entries.get("meta.json"))) as { clipgs: Block };
  change(meta.clipgs);
  entries.set("meta.json", new TextEncoder().encode(JSON.stringify(meta)));
  writeFileSync(to, makeZip(Object.fromEntries(entries)));
}

/** Opaque. */
function onBlack({ width, height, data }: Picture): Picture {
  const over = data.map((v, i) => (i % 4 === 3 ? 255 : Math.round((v * data[i - (i % 4) + 3]!) / 255)));
  return { width, height, data: over };
}
