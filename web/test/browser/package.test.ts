import { execFileSync } from "node:child_process";
import {
  cpSync,
  existsSync,
  mkdirSync,
  mkdtempSync,
  readFileSync,
  rmSync,
  symlinkSync,
  writeFileSync,
} from "node:fs";
import { createServer, type RequestListener, type Server } from "node:http";
import type { AddressInfo } from "node:net";
import { tmpdir } from "node:os";
import { dirname, extname, join, resolve } from "node:path";
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, inject, it } from "vitest";
import { build } from "vite";

import type * as Three from "three";

import type { ClippableSplats } from "../../src/clippable_splats";
import type { ClipgsViewerElement } from "../../src/element";
import { ofPage, psnr } from "./picture";
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

/** A page that draws a case among its own objects, with its own three.js. */
const kThreePage = `<!doctype html>
  <script type="importmap">{"imports": {
    "three": "./node_modules/three/build/three.module.js",
    "clipgs-viewer/three": "./node_modules/clipgs-viewer/three.js"
  }}</script>
  <script type="module">
    import * as three from "three";
    import { ClippableSplats } from "clipgs-viewer/three";
    const renderer = new three.WebGLRenderer();
    renderer.setSize(192, 192);
    document.body.append(renderer.domElement);
    const scene = new three.Scene();
    const splats = new ClippableSplats(renderer);
    const box = new three.Mesh(new three.BoxGeometry(20, 20, 20), new three.MeshBasicMaterial({ color: 0xff0000 }));
    box.visible = false;
    splats.add(box);
    scene.add(splats);
    const camera = new three.PerspectiveCamera(40, 1, 0.05, 10);
    let changes = 0;
    splats.addEventListener("change", () => ++changes);
    window.made = { three, renderer, scene, splats, camera, box, changes: () => changes };
    window.loaded = splats.load("cases/phantom.sog").then(() => {});
  </script>`;

const kThreeConsumer = `import { ClippableSplats } from "clipgs-viewer/three";
import { Plane, Scene, Vector3, WebGLRenderer } from "three";

const splats = new ClippableSplats(new WebGLRenderer());
new Scene().add(splats);
splats.addEventListener("change", () => console.log(splats.title));
await splats.load("head.sog", (share) => console.log(share.toFixed()));
splats.planes = [new Plane(new Vector3(0, 0, -1), 40)];
splats.clip = "exact";
const radius: number | undefined = splats.sphere?.radius;
console.log(radius);
// @ts-expect-error: there are three operators
splats.clip = "sharp";
`;

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
  const servers: Server[] = [];
  let url: string;
  let elsewhere: string; // another origin, which allows to be used
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
    const answer: RequestListener = (request, response) => {
      const path = join(folder, new URL(request.url!, "http://host").pathname);
      try {
        const body = readFileSync(path);
        response.writeHead(200, {
          "content-type": kTypes[extname(path)] ?? "application/octet-stream",
          ...(request.headers.host === new URL(elsewhere).host && { "access-control-allow-origin": "*" }),
        });
        response.end(body);
      } catch {
        response.writeHead(404).end();
      }
    };
    url = await listen(answer);
    elsewhere = await listen(answer);
    const cdn = `${elsewhere}/node_modules/clipgs-viewer/index.js`;
    writeFileSync(join(folder, "cdn.html"), `${kPage}<script type="module" src="${cdn}"></script>`);
    writeFileSync(join(folder, "three.html"), kThreePage);
    for (const peer of ["three", "@types/three"]) {
      mkdirSync(join(folder, "node_modules", dirname(peer)), { recursive: true });
      symlinkSync(resolve("node_modules", peer), join(folder, "node_modules", peer));
    }
    browser = await launchBrowser();
    page = await openPage("index.html");
  });

  afterAll(async () => {
    await browser?.close();
    servers.forEach((server) => server.close());
    rmSync(folder, { recursive: true, force: true });
  });

  async function listen(answer: RequestListener): Promise<string> {
    const server = createServer(answer);
    servers.push(server);
    await new Promise<void>((done) => server.listen(0, "127.0.0.1", done));
    return `http://127.0.0.1:${(server.address() as AddressInfo).port}`;
  }

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
    const label = page.getByText("Not for diagnosis", { exact: true });
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
    for (const [module, moduleResolution] of [
      ["esnext", "bundler"],
      ["nodenext", "nodenext"],
    ]) {
      const compilerOptions = {
        module,
        moduleResolution,
        target: "es2022",
        noEmit: true,
        strict: true,
        noUncheckedIndexedAccess: true,
        types: [], // that nothing is needed beside it
        skipDefaultLibCheck: true, // TypeScript's own
      };
      writeFileSync(
        join(folder, "tsconfig.json"),
        JSON.stringify({ compilerOptions, files: ["consumer.ts"] }),
      );
      execFileSync(resolve("node_modules/.bin/tsc"), [], { cwd: folder, stdio: "inherit" });
    }
  });

  it("can be served by another origin than the page's", async () => {
    const served = await openPage("cdn.html");
    expect(await coverage(served)).toBeGreaterThan(0.03);
    await served.close();
  });

  it("says what it has: of the element, and of the package", async () => {
    const inPackage = (name: string) =>
      JSON.parse(readFileSync(join(folder, "node_modules/clipgs-viewer", name), "utf8")) as unknown;
    const manifest = inPackage("custom-elements.json") as ElementManifest;
    const [element] = manifest.modules[0]!.declarations;
    const { observed, members, parts } = await page.evaluate(() => ({
      observed: [
        ...(customElements.get("clipgs-viewer") as unknown as typeof ClipgsViewerElement).observedAttributes,
      ],
      members: Object.getOwnPropertyNames(customElements.get("clipgs-viewer")!.prototype),
      parts: [...viewer().shadowRoot!.querySelectorAll("[part]")].map((part) => part.getAttribute("part")!),
    }));
    const names = (of: readonly { name: string }[]) => of.map(({ name }) => name).sort();
    expect(names(element!.attributes)).toEqual(observed.sort());
    expect(members).toEqual(expect.arrayContaining(names(element!.members)));
    expect(parts).toEqual(expect.arrayContaining(names(element!.cssParts)));
    const { exports } = inPackage("package.json") as {
      exports: Record<string, string | Record<string, string>>;
    };
    for (const file of Object.values(exports).flatMap((one) =>
      typeof one === "string" ? one : Object.values(one),
    )) {
      expect(existsSync(join(folder, "node_modules/clipgs-viewer", file)), file).toBe(true);
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
    await page.locator("canvas.stage").click({ position: { x: 60, y: 300 } });
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
    expect(await page.getByText("Not for diagnosis", { exact: true }).isVisible()).toBe(true);
    const ground = () =>
      page
        .locator("canvas.stage")
        .evaluate((canvas) => getComputedStyle(canvas.parentElement!).getPropertyValue("--ground"));
    await page.evaluate(() => viewer().setAttribute("theme", "dark"));
    const dark = await ground();
    await page.evaluate(() => viewer().setAttribute("theme", "light"));
    await expect.poll(ground).not.toBe(dark);
    expect(await page.getByTitle("Colours:").filter({ visible: true }).count()).toBe(0);
  });

  it("flies the tour that the page names, and has a case beside it", async () => {
    const stops = ["view=0,0&plane=0,0,-1,5", "view=60,10,2&plane=-1,0,0,0"].map((show, i) => ({
      id: String(i),
      name: ["The front", "The side"][i],
      text: `Said of ${i + 1}`,
      show,
      fly: 0.5,
      stay: 0.1,
    }));
    const tour = { clipgs_tour: 1, volume: "", stops };
    writeFileSync(join(folder, "cases/shown.tour.json"), JSON.stringify(tour));
    writeFileSync(join(folder, "cases/newer.tour.json"), JSON.stringify({ ...tour, clipgs_tour: 2 }));
    const set = (name: string, value: string | null) =>
      page.evaluate(
        ([name, value]) => {
          if (value === null) {
            viewer().removeAttribute(name);
          } else {
            viewer().setAttribute(name, value);
          }
        },
        [name, value] as const,
      );
    const shown = () => page.evaluate(() => viewer().clipgs!.state);
    await set("tour", "cases/shown.tour.json");
    await expect.poll(() => page.evaluate(() => viewer().clipgs!.views.length)).toBe(2);
    await page.evaluate(() => viewer().clipgs!.playTour());
    const caption = page.getByRole("region", { name: "Tour" });
    await caption.getByText("Said of 2").waitFor();
    await expect.poll(async () => (await shown()).view).toMatchObject({ azimuth: 60, zoom: 2 });
    expect((await shown()).cuts).toMatchObject([{ normal: [-1, 0, 0] }]);
    await caption.getByTitle("Leave the tour (Escape)").click();
    await caption.waitFor({ state: "hidden" });
    await set("tour", "cases/newer.tour.json");
    await page.getByRole("alert").getByText("newer.tour.json: of a version").waitFor();
    expect(await page.evaluate(() => viewer().clipgs!.views.length)).toBe(0);
    await set("tour", null);
    await page.getByRole("button", { name: "Dismiss" }).click();

    await set("beside", "cases/photo.sog");
    const beside = page.getByRole("region", { name: "Beside it" });
    await beside.getByText("Positions are relative to the middle of each").waitFor();
    expect(await page.evaluate(() => viewer().link)).not.toMatch(/beside|case/);
    const told = page.evaluate(
      () =>
        new Promise<string>((resolve) =>
          viewer().addEventListener("error", (event) => resolve(event.message), {
            once: true,
          }),
        ),
    );
    await set("beside", "cases/nobody.sog");
    const message = await told;
    expect(message).toMatch(/nobody/);
    await page.getByRole("alert").getByText(message).waitFor();
    await page.getByRole("button", { name: "Dismiss" }).click();
    await set("beside", null);
    await beside.waitFor({ state: "hidden" });
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
        const canvas = other.shadowRoot!.querySelector<HTMLCanvasElement>("canvas.stage")!;
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

  it("draws a case among the objects of a page that has three.js", async () => {
    writeFileSync(join(folder, "three_consumer.ts"), kThreeConsumer);
    const options =
      "--noEmit --strict --skipLibCheck --target es2022 --module esnext --moduleResolution bundler";
    execFileSync(resolve("node_modules/.bin/tsc"), [...options.split(" "), "three_consumer.ts"], {
      cwd: folder,
      stdio: "inherit",
    });
    const own = await browser.newPage();
    own.on("pageerror", (error) => errors.push(error.message));
    await own.goto(`${url}/three.html`);
    await own.waitForFunction(() => "loaded" in window);
    await own.evaluate(() => loaded);
    // As the element shows it, uncut and cut.
    await page.evaluate(() => {
      viewer().src = "cases/phantom.sog";
      viewer().link = "view=30,20&clip=exact";
      return viewer().clipgs!.ready;
    });
    for (const plane of [null, [0, -1, 0, -5] as const]) {
      await page.evaluate((cut) => {
        viewer().clipgs!.setMode("arbitrary");
        viewer().clipgs!.setPlane(cut && { normal: [cut[0], cut[1], cut[2]], offset: cut[3] });
      }, plane);
      const wanted = await page.evaluate(async () => {
        const { data } = await viewer().clipgs!.renderToPixels(192, 192);
        return btoa(Array.from(data, (byte) => String.fromCharCode(byte)).join(""));
      });
      const drawn = await own.evaluate(drawAmongOthers, plane);
      const size = { width: 192, height: 192 };
      const picture = { ...size, data: ofPage(drawn.picture) };
      expect(psnr(picture, { ...size, data: ofPage(wanted) }).color).toBeGreaterThan(40);
      expect(drawn.linear).toBeLessThan(0.01);
      expect(drawn.before).toEqual([255, 0, 0]);
      expect(drawn.behind[0]! - drawn.behind[1]!).toBeLessThan(128);
      expect(drawn.changes).toBeGreaterThan(0);
      expect(drawn.autoClear).toBe(true);
    }
    expect(await own.evaluate(() => made.splats.title)).toBe("Torso phantom");
    await own.evaluate(() => made.splats.dispose());
    await expect.poll(() => own.workers().length).toBe(0);
    await own.close();
  });

  it("leaves no error in the page", () => {
    expect(errors).toEqual([]);
  });
});

interface ElementManifest {
  modules: {
    declarations: Record<"attributes" | "members" | "cssParts", { name: string }[]>[];
  }[];
}

/** In the page of kThreePage. */
declare const loaded: Promise<void>;
declare const made: {
  three: typeof Three;
  renderer: Three.WebGLRenderer;
  scene: Three.Scene;
  splats: ClippableSplats;
  camera: Three.PerspectiveCamera;
  box: Three.Mesh;
  changes: () => number;
};

/** There: the case from 30° to the left and 20° above, at rest, on black; and what a box before and behind it shows. */
async function drawAmongOthers(plane: readonly [number, number, number, number] | null) {
  const { three, renderer, scene, splats, camera, box, changes } = made;
  const [azimuth, elevation] = [Math.PI / 6, Math.PI / 9];
  const { center, radius } = splats.sphere!;
  const towards = new three.Vector3(
    -Math.sin(azimuth) * Math.cos(elevation),
    Math.cos(azimuth) * Math.cos(elevation),
    Math.sin(elevation),
  );
  const fov = 0.6981317;
  const distance = radius / Math.sin(Math.atan(0.9 * Math.tan(0.5 * fov)));
  const at = (along: number) => center.clone().addScaledVector(towards, along);
  splats.updateMatrixWorld();
  camera.fov = (fov * 180) / Math.PI;
  camera.position.copy(splats.localToWorld(at(distance)));
  camera.lookAt(splats.localToWorld(center.clone()));
  camera.updateProjectionMatrix();
  splats.planes = plane ? [new three.Plane(new three.Vector3(plane[0], plane[1], plane[2]), -plane[3])] : [];
  const frame = () => new Promise((resolve) => requestAnimationFrame(resolve));
  const read = () => {
    renderer.render(scene, camera);
    const gl = renderer.getContext();
    const bytes = new Uint8Array(4 * 192 * 192);
    gl.readPixels(0, 0, 192, 192, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    return bytes;
  };
  do {
    renderer.render(scene, camera);
    await frame();
  } while (!splats.settled);
  const rows = read();
  // The same in linear light.
  const target = new three.WebGLRenderTarget(192, 192, { type: three.FloatType });
  renderer.setRenderTarget(target);
  renderer.setClearAlpha(0);
  renderer.render(scene, camera);
  renderer.setClearAlpha(1);
  const light = new Float32Array(4 * 192 * 192);
  renderer.readRenderTargetPixels(target, 0, 0, 192, 192, light);
  renderer.setRenderTarget(null);
  target.dispose();
  let linear = 0; // the largest difference
  rows.forEach((byte, i) => {
    // What is behind shines through otherwise there: light adds up, display values do not.
    if (i % 4 !== 3 && light[i - (i % 4) + 3]! > 0.999) {
      const wanted = new three.Color().setRGB(byte / 255, 0, 0, "srgb").r;
      linear = Math.max(linear, Math.abs(wanted - light[i]!));
    }
  });
  const middle = () => [...read().subarray(4 * (96 * 192 + 96), 4 * (96 * 192 + 96) + 3)];
  box.visible = true;
  box.position.copy(at(radius));
  const before = middle();
  box.position.copy(at(-radius));
  const behind = middle();
  box.visible = false;
  const upright = new Uint8Array(rows.length);
  for (let y = 0; y < 192; ++y) {
    upright.set(rows.subarray(4 * 192 * (191 - y), 4 * 192 * (192 - y)), 4 * 192 * y);
  }
  const picture = btoa(Array.from(upright, (byte) => String.fromCharCode(byte)).join(""));
  return {
    picture,
    linear,
    before,
    behind,
    changes: changes(),
    autoClear: renderer.autoClear,
  };
}

/** In the page: its first viewer. */
declare function viewer(): ClipgsViewerElement;

/** Share of the pixels of the first viewer's case that show anything. */
async function coverage(page: Page): Promise<number> {
  return page.evaluate(async () => {
    const { data } = await viewer().clipgs!.renderToPixels(96, 96);
    return data.filter((v, i) => i % 4 === 3 && v > 25).length / (96 * 96);
  });
}
