import { execFileSync } from "node:child_process";
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createServer, type Server } from "node:http";
import type { AddressInfo } from "node:net";
import { tmpdir } from "node:os";
import { extname, join, resolve } from "node:path";
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, inject, it } from "vitest";
import { build } from "vite";

import type { ClipgsViewerElement } from "../../src/element";
import { missing } from "./program";
import { launchBrowser } from "./session";

const kTypes: Record<string, string> = {
  ".html": "text/html",
  ".js": "text/javascript",
  ".wasm": "application/wasm",
};

const kPage = `<!doctype html>
  <style>
    button, span, strong { font-size: 40px !important; color: red !important; }
    clipgs-viewer { width: 640px; height: 420px; }
  </style>
  <body>
    <input aria-label="Of the page" />
    <clipgs-viewer src="cases/phantom.sog" link="view=30,20&plane=0,-1,0,0&clip=soft"></clipgs-viewer>
    <script>const viewer = (() => { const first = document.querySelector("clipgs-viewer"); return () => first; })();</script>
  </body>`;

/** How a page may use the package: what its types must take, and what they must not. */
const kConsumer = `import { type ClipgsApi, type ClipgsViewerElement, type Triple } from "clipgs-viewer";

const viewer: ClipgsViewerElement = document.querySelector("clipgs-viewer")!;
const api: ClipgsApi | null = viewer.clipgs;
const middle: Triple = [0, 0, 0];
viewer.src = "head.sog";
viewer.link = "view=30,20";
viewer.addEventListener("error", (event) => console.log(event.message.toUpperCase()));
api?.setPlane({ normal: [0, 0, -1], offset: 40 });
api?.addMark({ kind: "point", points: [middle], name: "here" });
void api?.renderToPixels(64, 64).then(({ data }) => data[0]!.toFixed());
void api?.headset.capture().then((eyes) => eyes[0]?.camera.fl_x);
const scale: number | undefined = api?.headset.effort.scale;
console.log(scale, api?.states?.axis[0], api?.state.window?.center);
// @ts-expect-error: there are three operators
api?.setClip("sharp");
// @ts-expect-error: it may be null
viewer.clipgs.stats;
`;

describe.skipIf(missing !== undefined)(`the package${missing ? ` (${missing} is missing)` : ""}`, () => {
  const folder = mkdtempSync(join(tmpdir(), "clipgs-package-"));
  const errors: string[] = [];
  let server: Server;
  let url: string;
  let browser: Awaited<ReturnType<typeof launchBrowser>>;
  let page: Page;

  beforeAll(async () => {
    const npm = (cwd: string, ...args: string[]) => execFileSync("npm", args, { cwd, encoding: "utf8" });
    npm(resolve("."), "run", "--silent", "pack", "--", folder);
    const { version } = JSON.parse(readFileSync(join(folder, "clipgs-viewer/package.json"), "utf8")) as {
      version: string;
    };
    writeFileSync(join(folder, "package.json"), JSON.stringify({ private: true, type: "module" }));
    npm(folder, "install", "--offline", "--no-audit", "--no-fund", `clipgs-viewer-${version}.tgz`);
    rmSync(join(folder, "clipgs-viewer"), { recursive: true });
    mkdirSync(join(folder, "cases"));
    cpSync(join(inject("made"), "cases"), join(folder, "cases"), { recursive: true });
    const module = '<script type="module" src="node_modules/clipgs-viewer/index.js"></script>';
    writeFileSync(join(folder, "index.html"), kPage + module);
    const set = '<script>viewer().src = "cases/solid.sog"; viewer().link = "view=7,8";</script>';
    writeFileSync(join(folder, "early.html"), kPage + set + module);
    writeFileSync(join(folder, "app.html"), `${kPage}<script type="module" src="./app.js"></script>`);
    writeFileSync(join(folder, "app.js"), 'import "clipgs-viewer";');
    server = createServer((request, response) => {
      const path = join(folder, new URL(request.url!, "http://host").pathname);
      try {
        const body = readFileSync(path);
        response.writeHead(200, { "content-type": kTypes[extname(path)] ?? "application/octet-stream" });
        response.end(body);
      } catch {
        response.writeHead(404).end();
      }
    });
    await new Promise<void>((done) => server.listen(0, "127.0.0.1", done));
    url = `http://127.0.0.1:${(server.address() as AddressInfo).port}`;
    browser = await launchBrowser();
    page = await openPage("index.html");
  });

  afterAll(async () => {
    await browser?.close();
    server?.close();
    rmSync(folder, { recursive: true, force: true });
  });

  /** A page of the folder, once its first viewer has drawn its case. */
  async function openPage(path: string): Promise<Page> {
    const opened = await browser.newPage({ viewport: { width: 900, height: 600 } });
    opened.setDefaultTimeout(120_000);
    opened.on("pageerror", (error) => errors.push(error.message));
    opened.on("console", (message) => {
      // The browser's own word for a file that is not there, and for its icon.
      if (message.type() === "error" && !message.text().includes("404")) {
        errors.push(message.text());
      }
    });
    await opened.goto(`${url}/${path}`);
    await opened.evaluate(() => customElements.whenDefined("clipgs-viewer"));
    await opened.evaluate(() => viewer().clipgs!.ready);
    return opened;
  }

  it("shows a case in a page that is not isolated, with what it is not for", async () => {
    expect(await page.evaluate(() => crossOriginIsolated)).toBe(false);
    expect(await coverage(page)).toBeGreaterThan(0.03);
    const label = page.getByText("Not for diagnosis");
    expect(await label.isVisible()).toBe(true);
    expect(await page.evaluate(() => viewer().clipgs!.state)).toMatchObject({
      case: "phantom",
      view: { azimuth: 30, elevation: 20 },
      cuts: [{ normal: [0, -1, 0] }],
      clip: "soft",
    });
    // The page's styles end at the element, and the other way round.
    expect(await label.evaluate((element) => getComputedStyle(element).fontSize)).toBe("12px");
    expect(await page.evaluate(() => getComputedStyle(document.body).overflow)).toBe("visible");
  });

  it("has types of its own", () => {
    writeFileSync(join(folder, "consumer.ts"), kConsumer);
    for (const resolution of ["bundler", "nodenext"]) {
      const module = resolution === "bundler" ? "esnext" : "nodenext";
      const options = `--noEmit --strict --noUncheckedIndexedAccess --target es2022 --module ${module} --moduleResolution ${resolution}`;
      const tsc = resolve("node_modules/.bin/tsc");
      execFileSync(tsc, [...options.split(" "), "consumer.ts"], {
        cwd: folder,
        stdio: "inherit",
      });
    }
  });

  it("works in a bundle", async () => {
    await build({
      root: folder,
      logLevel: "warn",
      configFile: false,
      base: "./",
      build: { outDir: "bundle", rollupOptions: { input: join(folder, "app.html") } },
      worker: { format: "es" },
    });
    cpSync(join(folder, "cases"), join(folder, "bundle/cases"), { recursive: true });
    const bundled = await openPage("bundle/app.html");
    expect(await coverage(bundled)).toBeGreaterThan(0.03);
    await bundled.close();
  });

  it("hears keys while it has the focus", async () => {
    const clip = () => page.evaluate(() => viewer().clipgs!.state.clip);
    const zoom = () => page.evaluate(() => viewer().clipgs!.state.view.zoom);
    await page.evaluate(() => (document.body.style.height = "2000px"));
    await page.getByLabel("Of the page").focus();
    await page.keyboard.press("1");
    expect(await clip()).toBe("soft");
    await page.mouse.move(100, 300);
    await page.mouse.wheel(0, 40); // scrolls the page
    await page.waitForFunction(() => scrollY > 0);
    expect(await zoom()).toBe(1);
    await page.evaluate(() => scrollTo(0, 0));
    await page.locator("canvas").click({ position: { x: 60, y: 300 } });
    await page.keyboard.press("1");
    expect(await clip()).toBe("hard");
    await page.getByRole("button", { name: "Exact" }).click();
    await page.keyboard.press("2");
    expect(await clip()).toBe("soft");
    await page.mouse.move(100, 300);
    await page.mouse.wheel(0, -40);
    await expect.poll(zoom).toBeGreaterThan(1);
    expect(await page.evaluate(() => scrollY)).toBe(0);
    const isFull = () => page.evaluate(() => viewer().shadowRoot!.fullscreenElement !== null);
    await page.keyboard.press("z");
    await expect.poll(isFull).toBe(true);
    await page.keyboard.press("z");
    await expect.poll(isFull).toBe(false);
  });

  it("follows its attributes, and tells what happens", async () => {
    const told = await page.evaluate(async () => {
      const events: string[] = [];
      const next = (type: string) =>
        new Promise<Event>((resolve) => viewer().addEventListener(type, resolve, { once: true }));
      for (const type of ["ready", "error", "change"]) {
        viewer().addEventListener(type, () => events.at(-1) === type || events.push(type));
      }
      const ready = next("ready");
      viewer().src = "cases/photo.sog";
      await ready;
      const opened = viewer().clipgs!.state;
      const error = next("error");
      viewer().src = "cases/nobody.sog";
      const { message } = (await error) as ErrorEvent;
      const rejected = await viewer().clipgs!.ready.then(
        () => "",
        (reason: Error) => reason.message,
      );
      await viewer().clipgs!.open("cases/phantom.sog");
      const change = next("change");
      viewer().link = "view=10,5&state=57";
      await change;
      const { state } = viewer().clipgs!.state;
      return { events, opened, message, rejected, state, link: viewer().link };
    });
    expect(told.opened).toMatchObject({ case: "photo", view: { azimuth: 30 }, clip: "soft" });
    expect(told.message).toMatch(/no such case/);
    expect(told.rejected).toBe(told.message);
    expect(told.state).toBe(57);
    expect(told.link).toMatch(/^#view=10,5,1&state=57&/);
    expect(told.events).toContain("ready");
    expect(await page.getByRole("alert").isVisible()).toBe(false);

    const panel = page.getByRole("region", { name: "Cutting plane" });
    expect(await panel.isVisible()).toBe(true);
    await page.evaluate(() => viewer().setAttribute("panel", "none"));
    await panel.waitFor({ state: "hidden" });
    expect(await page.getByText("Not for diagnosis").isVisible()).toBe(true);
    const ground = () =>
      page
        .locator("canvas")
        .evaluate((canvas) => getComputedStyle(canvas.parentElement!).getPropertyValue("--ground"));
    await page.evaluate(() => viewer().setAttribute("theme", "dark"));
    const dark = await ground();
    await page.evaluate(() => viewer().setAttribute("theme", "light"));
    await expect.poll(ground).not.toBe(dark);
    expect(await page.getByTitle("Colours:").isVisible()).toBe(false);
  });

  it("takes properties that were set before it was known", async () => {
    const early = await browser.newPage();
    await early.goto(`${url}/early.html`);
    await early.evaluate(() => customElements.whenDefined("clipgs-viewer"));
    await early.evaluate(() => viewer().clipgs!.ready);
    expect(await early.evaluate(() => viewer().clipgs!.state)).toMatchObject({
      case: "solid",
      view: { azimuth: 7 },
    });
    await early.close();
  });

  it("stands beside others, and gives back what it held when it goes", async () => {
    const workers = page.workers().length;
    for (let i = 0; i < 10; ++i) {
      const lost = await page.evaluate(async () => {
        const other = document.createElement("clipgs-viewer");
        other.src = "cases/solid.sog";
        document.body.append(other);
        document.body.prepend(other); // moved, not removed
        await new Promise((resolve) => other.addEventListener("ready", resolve, { once: true }));
        const canvas = other.shadowRoot!.querySelector("canvas")!;
        const context = canvas.getContext("webgl2")!;
        other.remove();
        await new Promise((resolve) => setTimeout(resolve));
        return { lost: context.isContextLost(), clipgs: other.clipgs, shown: viewer().clipgs!.state.case };
      });
      expect(lost).toEqual({ lost: true, clipgs: null, shown: "phantom" });
    }
    await expect.poll(() => page.workers().length).toBe(workers);
    expect(await coverage(page)).toBeGreaterThan(0.03); // the first one was not taken its context
    // One that has gone comes back.
    await page.evaluate(async () => {
      const element = viewer();
      element.remove();
      await new Promise((resolve) => setTimeout(resolve));
      document.body.append(element);
      await element.clipgs!.ready;
    });
    expect(await coverage(page)).toBeGreaterThan(0.03);
  });

  it("leaves no error in the page", () => {
    expect(errors).toEqual([]);
  });
});

/** In the page: its first viewer. */
declare function viewer(): ClipgsViewerElement;

/** Share of the pixels of the first viewer's case that show anything. */
async function coverage(page: Page): Promise<number> {
  return page.evaluate(async () => {
    const { data } = await viewer().clipgs!.renderToPixels(96, 96);
    return data.filter((v, i) => i % 4 === 3 && v > 25).length / (96 * 96);
  });
}
