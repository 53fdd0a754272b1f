import { copyFileSync, readdirSync, readFileSync, renameSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { afterAll, beforeAll, describe, expect, it } from "vitest";

import { copyMadeCases } from "./made_cases";
import { coverage, pagePicture } from "./picture";
import { missing } from "./program";
import { Session } from "./session";
import { startSlowProxy } from "./slow_proxy";
import { kCountVolumes, volumesOf } from "./volume_memory";

describe.skipIf(missing !== undefined)(`loading${missing ? ` (${missing} is missing)` : ""}`, () => {
  const session = new Session();
  const errors: string[] = [];

  beforeAll(() => session.start(() => copyMadeCases(session)));

  afterAll(async () => {
    expect(errors).toEqual([]);
    await session.stop();
  });

  it("shows what is coming, then the body, before the file is there", async () => {
    const proxy = await startSlowProxy(session.url, "/cases/phantom.sog");
    const visitor = await session.openPage(`${proxy.url}#case=phantom`, errors);
    const loading = visitor.getByRole("progressbar", { name: "Loading" });
    await expect.poll(() => loading.textContent()).toMatch(/Torso phantom\d+ of \d+ KB/);
    expect(await visitor.locator("footer .warning").isVisible()).toBe(true);
    expect(await loading.locator("img").isVisible()).toBe(true);
    await visitor.waitForFunction(() => performance.getEntriesByName("clipgs: picture").length > 0);
    expect(proxy.given()).toBeLessThan(proxy.whole());
    await visitor.evaluate(() => window.clipgs.ready);
    expect(proxy.given()).toBe(proxy.whole());
    expect(await loading.isVisible()).toBe(false);
    expect(await visitor.evaluate(() => window.clipgs.stats.sectionBytes)).toBeGreaterThan(0);
    await visitor.close();
    proxy.stop();
  });

  it("shows nothing of a file that ends too early, not even what was seen of it", async () => {
    const whole = readFileSync(join(session.cases, "phantom.sog"));
    const visitor = await session.openPage("about:blank", errors);
    await visitor.route("**/cases/phantom.sog*", (route) =>
      route.fulfill({ body: whole.subarray(0, whole.length - 1000) }),
    );
    await visitor.goto(`${session.url}#case=phantom`);
    await expect
      .poll(() => visitor.getByRole("alert").textContent())
      .toContain("phantom: the file ends too early");
    expect(await visitor.evaluate(() => window.clipgs.state.case)).toBe(null);
    await visitor.close();
  });

  it("opens files that are dropped or chosen, and sends them nowhere", async () => {
    const visitor = await session.open("#case=solid&view=20,10", errors, { width: 700, height: 500 });
    await visitor.evaluate(() => window.clipgs.ready);
    const sent: string[] = [];
    visitor.on("request", (request) => request.method() !== "GET" && sent.push(request.url()));
    const drop = (name: string, bytes: Buffer) =>
      visitor.evaluate(
        async ([name, base64]) => {
          const bytes = await (await fetch(`data:;base64,${base64}`)).blob();
          const dataTransfer = new DataTransfer();
          dataTransfer.items.add(new File([bytes], name!));
          for (const type of ["dragenter", "dragover", "drop"]) {
            const event = new DragEvent(type, { dataTransfer, bubbles: true, cancelable: true });
            document.querySelector<HTMLCanvasElement>("canvas.stage")!.dispatchEvent(event);
          }
        },
        [name, bytes.toString("base64")],
      );
    const shows = (name: string) =>
      visitor.waitForFunction((name) => window.clipgs.state.case === name, name);

    const scene = readFileSync(join(session.folder, "scene.ply"));
    await drop("scene.ply", scene);
    await shows("scene.ply");
    await expect.poll(() => visitor.getByText("1 unit is taken as 1 m").isVisible()).toBe(true);
    expect(coverage(await pagePicture(visitor, 96, 96))).toBeGreaterThan(0.03);
    expect(new URL(visitor.url()).hash).toBe("");
    const alert = visitor.getByRole("alert");
    await visitor.getByRole("button", { name: "Copy a link" }).click();
    expect(await alert.textContent()).toContain("a file of this computer alone");

    // Points without splats: what was shown stays.
    await drop("points.ply", readFileSync(join(session.folder, "dataset", "points.ply")));
    await expect
      .poll(() => alert.textContent())
      .toContain('points.ply: has no splats: its points have no "scale_0"');
    expect(await visitor.evaluate(() => window.clipgs.state.case)).toBe("scene.ply");

    await visitor.keyboard.press("m");
    const chooser = visitor.waitForEvent("filechooser");
    await visitor.getByRole("button", { name: "Open a file" }).click();
    await (await chooser).setFiles(join(session.cases, "photo.sog"));
    await shows("photo.sog");
    await expect.poll(() => visitor.evaluate(() => window.clipgs.stats.sectionBytes)).toBeGreaterThan(0);
    expect(await visitor.getByText("1 unit is taken").isVisible()).toBe(false);
    await visitor.evaluate(() => window.clipgs.open("solid"));
    await expect.poll(() => new URL(visitor.url()).hash).toContain("case=solid");
    expect(sent).toEqual([]);
    await visitor.close();
  });

  it("shows the body before its section is there, once", async () => {
    const opened = await session.open("#case=phantom", errors);
    const times = await opened.evaluate(async () => {
      const { clipgs } = window;
      await clipgs.ready;
      const whole = performance.now();
      const seen = performance.getEntriesByName("clipgs: picture").map(({ startTime }) => startTime);
      return { whole, seen, section: clipgs.stats.sectionMs };
    });
    expect(times.seen).toHaveLength(1);
    expect(times.section).toBeGreaterThan(0);
    expect(times.whole - times.seen[0]!).toBeGreaterThan(times.section);
    await opened.close();
  });

  it("shows why a case cannot be opened, and goes on", async () => {
    const whole = readFileSync(join(session.cases, "phantom.sog"));
    writeFileSync(join(session.cases, "truncated.sog"), whole.subarray(0, whole.length / 2));
    writeFileSync(join(session.cases, "page.sog"), "<html>not a case</html>");
    copyFileSync(join(session.cases, "phantom.sog"), join(session.cases, "second.sog"));
    const visitor = await session.open("#case=truncated", errors);
    const alert = visitor.getByRole("alert");
    await alert.waitFor();
    expect(await alert.textContent()).toContain("truncated");
    await expect(visitor.evaluate(() => window.clipgs.ready)).rejects.toThrow();

    await alert.getByRole("button", { name: "Choose a case" }).click();
    const menu = visitor.getByRole("dialog", { name: "Cases" });
    const cases = readdirSync(session.cases).length;
    await menu
      .locator(".card")
      .nth(cases - 1)
      .waitFor(); // the list is fetched anew when the menu opens
    expect(await menu.locator(".card").count()).toBe(cases);
    expect(await menu.locator('[data-case="page"]').textContent()).toMatch(/not|ZIP|archive/i);
    await menu.locator('[data-case="page"]').click();
    await expect.poll(() => alert.textContent()).toContain("page");

    await visitor.keyboard.press("m");
    await menu.locator('[data-case="second"]').click();
    await visitor.waitForFunction(() => window.clipgs.state.case === "second");
    expect(await alert.isVisible()).toBe(false);
    expect(coverage(await pagePicture(visitor, 96, 96))).toBeGreaterThan(0.03);

    await expect(visitor.evaluate(() => window.clipgs.open("nobody"))).rejects.toThrow(/no such case/);
    expect(await alert.textContent()).toContain("nobody");
    await visitor.close();
  });

  it("says that the folder of the cases is gone, until it is back", async () => {
    const away = join(session.folder, "away");
    renameSync(session.cases, away);
    const visitor = await session.open("", errors);
    const alert = visitor.getByRole("alert");
    await alert.waitFor();
    expect(await alert.textContent()).toContain("the folder of the cases cannot be read");
    await expect(visitor.evaluate(() => window.clipgs.open("phantom"))).rejects.toThrow(/cannot be read/);
    renameSync(away, session.cases);
    await visitor.evaluate(() => window.clipgs.open("phantom"));
    expect(await alert.isVisible()).toBe(false);
    await visitor.close();
  });

  it("finds damage that the server's index does not look for", async () => {
    const bytes = Uint8Array.from(readFileSync(join(session.cases, "phantom.sog")));
    const visitor = await session.open("#case=phantom", errors);
    await visitor.evaluate(() => window.clipgs.ready);
    const failure = async (body: Uint8Array): Promise<string> => {
      await visitor.route("**/cases/phantom.sog*", (route) => route.fulfill({ body: Buffer.from(body) }));
      const message = await visitor.evaluate(() =>
        window.clipgs.open("phantom").then(
          () => "",
          (e: Error) => e.message,
        ),
      );
      await visitor.unroute("**/cases/phantom.sog*");
      expect(await visitor.getByRole("alert").textContent()).toContain(message);
      return message;
    };
    expect(await failure(bytes.slice(0, 5000))).toMatch(/too early/);
    const flipped = bytes.slice();
    flipped[300]! ^= 0x10;
    expect(await failure(flipped)).toMatch(/damaged/);
    expect(await failure(new TextEncoder().encode("<!doctype html>"))).toMatch(/not a SOG file/);
    await visitor.evaluate(() => window.clipgs.open("phantom"));
    expect(await visitor.getByRole("alert").isVisible()).toBe(false);
    await visitor.close();
  });

  it("does not download a case to its end when another is chosen", async () => {
    const proxy = await startSlowProxy(session.url, "/cases/phantom.sog");
    const visitor = await session.openPage(`${proxy.url}#case=solid&size=64x64`, errors);
    await visitor.waitForFunction(() => window.clipgs !== undefined);
    await visitor.evaluate(() => window.clipgs.ready);
    const superseded = visitor.evaluate(() =>
      window.clipgs.open("phantom").then(
        () => "",
        (error: Error) => error.message,
      ),
    );
    await expect.poll(() => proxy.given()).toBeGreaterThan(0);
    await visitor.evaluate(() => window.clipgs.open("photo"));
    expect(await superseded).toBe("another case was chosen meanwhile");
    await proxy.ended();
    expect(proxy.given()).toBeLessThan(0.5 * proxy.whole());
    await visitor.close();
    proxy.stop();
  });

  it("holds codes and values of the section on the GPU, or its colours, and gives them there in pieces", async () => {
    for (const [name, channels, volumes] of [
      ["phantom", 1, 2],
      ["photo", 3, 1],
    ] as const) {
      const visitor = await session.open(`#case=${name}&size=64x64`, errors, { width: 64, height: 64 }, [
        kCountVolumes,
      ]);
      await visitor.evaluate(() => window.clipgs.ready);
      await pagePicture(visitor, 64, 64);
      const { bytes, pieces } = await volumesOf(visitor);
      const { sectionBytes } = await visitor.evaluate(() => window.clipgs.stats);
      const [, dims] = /"dims":\[(\d+,\d+,\d+)\]/.exec(
        readFileSync(join(session.cases, `${name}.sog`)).toString("latin1"),
      )!;
      const voxels = dims!.split(",").reduce((product, n) => product * Number(n), 1);
      expect(sectionBytes).toBe(channels * volumes * voxels);
      expect(bytes[0]).toBe(channels * voxels);
      // Beside it stand blocks of 2³ voxels and, the light on surfaces, as the case was made, now and next: of at most 48³ cells.
      const blocks = dims!.split(",").reduce((product, n) => product * Math.ceil(Number(n) / 2), 1);
      const sum = (sizes: number[]) => sizes.reduce((all, n) => all + n);
      expect(sum(bytes)).toBeLessThan(channels * volumes * voxels + blocks + 3 * 12 * 4 * 48 ** 3);
      // Each is given once; blocks may still be on their way, a single one in their place.
      const given = channels * volumes * voxels;
      expect([given, given + blocks]).toContain(sum(pieces.filter((bytes) => bytes > 1)));
      await visitor.close();
    }
  });

  it("holds nothing of a section when another case is there", async () => {
    const visitor = await session.open("#case=solid&size=64x64", errors, { width: 200, height: 150 });
    await visitor.evaluate(() => window.clipgs.ready);
    const devtools = await visitor.context().newCDPSession(visitor);
    const held = async () => {
      await devtools.send("HeapProfiler.collectGarbage");
      return (await devtools.send("Runtime.getHeapUsage")) as { backingStorageSize: number };
    };
    const before = await held();
    await visitor.evaluate(() => window.clipgs.open("phantom"));
    const { sectionBytes } = await visitor.evaluate(() => window.clipgs.stats);
    await visitor.evaluate(() => window.clipgs.open("solid"));
    const after = await held();
    expect(after.backingStorageSize - before.backingStorageSize).toBeLessThan(0.3 * sectionBytes);
    await visitor.close();
  });

  it("frees what it held when cases are switched, twenty times", async () => {
    const script = {
      content: `window.held = { textures: 0, buffers: 0 };
        for (const kind of ["Texture", "Buffer"]) {
          const { prototype } = WebGL2RenderingContext;
          for (const [verb, step] of [["create", 1], ["delete", -1]]) {
            const original = prototype[verb + kind];
            prototype[verb + kind] = function (...args) {
              window.held[kind.toLowerCase() + "s"] += step;
              return original.apply(this, args);
            };
          }
        }`,
    };
    const small = { width: 200, height: 150 };
    const visitor = await session.open("#case=phantom&plane=0,0,-1,0&size=64x64", errors, small, [script]);
    await visitor.evaluate(() => window.clipgs.ready);
    const devtools = await visitor.context().newCDPSession(visitor);
    const switchCases = async (times: number) => {
      await visitor.evaluate(async (n) => {
        for (let i = 0; i < n; ++i) {
          await window.clipgs.open(i % 2 === 0 ? "solid" : "phantom");
        }
      }, times);
      await visitor.waitForFunction(() => window.clipgs.stats.settled); // the light in what is cut open is there, too
      await devtools.send("HeapProfiler.collectGarbage");
      const heap = (await devtools.send("Runtime.getHeapUsage")) as {
        usedSize: number;
        backingStorageSize: number;
      };
      return { heap, gpu: await visitor.evaluate("window.held") };
    };
    const before = await switchCases(4);
    const after = await switchCases(20);
    expect(after.gpu).toEqual(before.gpu);
    expect(after.heap.usedSize - before.heap.usedSize).toBeLessThan(1e6);
    expect(after.heap.backingStorageSize - before.heap.backingStorageSize).toBeLessThan(1e6);
    await visitor.close();
  });
});
