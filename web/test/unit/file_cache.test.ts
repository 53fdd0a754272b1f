import { createServer, type Server } from "node:http";
import type { AddressInfo } from "node:net";
import { afterAll, beforeAll, beforeEach, describe, expect, it, vi } from "vitest";

import { FileCache } from "../../src/worker/file_cache";

const kLarge = 30_000_000;
const wanted = new AbortController().signal;

describe("the cache of files", () => {
  let server: Server;
  let url = "";
  let version = 1;
  let answers: number[] = [];

  beforeAll(async () => {
    server = createServer((request, response) => {
      const etag = `"${version}"`;
      const known = request.headers["if-none-match"] === etag;
      const missing = request.url === "/missing";
      const status = missing ? 422 : known ? 304 : 200;
      answers.push(status);
      response.writeHead(status, missing ? { "content-type": "text/plain" } : { etag });
      const large = request.url?.startsWith("/large") ? Buffer.alloc(kLarge, version) : `version ${version}`;
      response.end(missing ? "it is broken\n" : known ? "" : large);
    });
    await new Promise<void>((listening) => server.listen(0, "127.0.0.1", listening));
    url = `http://127.0.0.1:${(server.address() as AddressInfo).port}/`;
  });

  afterAll(() => void server.close());

  beforeEach(() => {
    version = 1;
    answers = [];
  });

  const text = async (cache: FileCache, path: string) =>
    new TextDecoder().decode(await cache.get(url + path, () => {}, wanted));

  it("fetches a file once, and again when it changed", async () => {
    const cache = new FileCache();
    expect([await text(cache, "a"), await text(cache, "a")]).toEqual(["version 1", "version 1"]);
    version = 2;
    expect(await text(cache, "a")).toBe("version 2");
    expect(answers).toEqual([200, 304, 200]);
  });

  it("shares what is being fetched with who wants it meanwhile", async () => {
    const cache = new FileCache();
    const prefetched = cache.prefetch(`${url}a`);
    expect(await text(cache, "a")).toBe("version 1");
    await prefetched;
    expect(answers).toEqual([200]);
  });

  it("says what the server says, and forgets what it cannot have", async () => {
    const cache = new FileCache();
    await cache.prefetch(`${url}missing`);
    await expect(text(cache, "missing")).rejects.toThrow("it is broken");
    await expect(cache.get("http://127.0.0.1:1/", () => {}, wanted)).rejects.toThrow(/does not answer/);
  });

  describe("that takes its time", () => {
    const kParts = 400;
    const part = Buffer.alloc(1 << 16, 7);
    let slow: Server;
    let slowUrl = "";
    let given = 0; // bytes
    let ended: Promise<void>; // the answer, or its connection

    beforeAll(async () => {
      slow = createServer((_request, response) => {
        given = 0;
        response.writeHead(200, { "content-length": kParts * part.length, etag: '"1"' });
        const timer = setInterval(() => {
          response.write(part);
          given += part.length;
          if (given === kParts * part.length) {
            clearInterval(timer);
            response.end();
          }
        }, 2);
        ended = new Promise((done) => response.once("close", done)).then(() => clearInterval(timer));
      });
      await new Promise<void>((listening) => slow.listen(0, "127.0.0.1", listening));
      slowUrl = `http://127.0.0.1:${(slow.address() as AddressInfo).port}/`;
    });

    afterAll(() => {
      slow.closeAllConnections();
      slow.close();
    });

    /** Begins, and resolves with what comes of it once some of the file is there. */
    const begun = (cache: FileCache, path: string, signal: AbortSignal) =>
      new Promise<{ file: Promise<Uint8Array> }>((resolve) => {
        const file: Promise<Uint8Array> = cache.get(slowUrl + path, () => resolve({ file }), signal);
        file.catch(() => {});
      });

    it("does not download what nobody wants any more", async () => {
      const unwanted = new AbortController();
      const { file } = await begun(new FileCache(), "a", unwanted.signal);
      unwanted.abort();
      await expect(file).rejects.toThrow("another case was chosen meanwhile");
      await ended;
      expect(given).toBeLessThan(0.5 * kParts * part.length);
    });

    it("goes on where somebody else wants it", async () => {
      const cache = new FileCache();
      const unwanted = new AbortController();
      const { file } = await begun(cache, "b", unwanted.signal);
      const same = cache.get(`${slowUrl}b`, () => {}, wanted);
      unwanted.abort();
      expect((await same).length).toBe(kParts * part.length);
      expect(await file).toBe(await same);
    });

    it("ends a prefetch when another file is chosen", async () => {
      given = 0;
      const cache = new FileCache();
      const prefetched = cache.prefetch(`${slowUrl}c`);
      await expect.poll(() => given).toBeGreaterThan(0);
      expect(await text(cache, "d")).toBe("version 1");
      await prefetched;
      await ended;
      expect(given).toBeLessThan(0.5 * kParts * part.length);
    });
  });

  it("asks other origins plainly, for nothing that they would have to allow", async () => {
    const asked: unknown[] = [];
    vi.stubGlobal("fetch", async (_url: string, { headers }: RequestInit) => {
      asked.push(headers);
      const response = new Response("of another origin", { headers: { etag: '"1"' } });
      return Object.defineProperty(response, "type", { value: "cors" });
    });
    const cache = new FileCache();
    expect([await text(cache, "a"), await text(cache, "a")]).toEqual(Array(2).fill("of another origin"));
    vi.unstubAllGlobals();
    expect(asked).toEqual([{}, {}]);
  });

  it("keeps no more than it may, the oldest go", async () => {
    const cache = new FileCache();
    for (const path of ["large1", "large2", "large1", "large3", "large1", "large2"]) {
      expect((await cache.get(url + path, () => {}, wanted)).length).toBe(kLarge);
    }
    expect(answers).toEqual([200, 200, 304, 200, 304, 200]);
  });
});
