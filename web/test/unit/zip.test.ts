import { deflateRawSync } from "node:zlib";
import { describe, expect, it } from "vitest";

import { CaseError, crc32, readZip } from "../../src/sog/zip";
import { makeZip } from "./sog_fixture";

const bytes = (text: string) => new TextEncoder().encode(text);

/** Node 18 does not have it; browsers do. */
const hasDeflateRaw = (() => {
  try {
    new DecompressionStream("deflate-raw");
    return true;
  } catch {
    return false;
  }
})();

describe("readZip", () => {
  const zip = makeZip({ "a.txt": bytes("first"), "b/c.txt": bytes("second"), empty: bytes("") });

  it("gives the entries by name", async () => {
    const entries = await readZip(zip);
    expect([...entries.keys()]).toEqual(["a.txt", "b/c.txt", "empty"]);
    expect(new TextDecoder().decode(entries.get("b/c.txt"))).toBe("second");
    expect(entries.get("empty")).toHaveLength(0);
  });

  it("finds an archive's end before a comment and inside a larger buffer", async () => {
    const commented = new Uint8Array([...zip, ...bytes("a comment")]);
    new DataView(commented.buffer).setUint16(zip.length - 2, 9, true);
    expect((await readZip(commented)).size).toBe(3);
    const inside = new Uint8Array(zip.length + 20);
    inside.set(zip, 10);
    expect((await readZip(inside.subarray(10, 10 + zip.length))).size).toBe(3);
  });

  it.skipIf(!hasDeflateRaw)("unpacks deflated entries and no more of them than they say", async () => {
    const text = bytes("again and again ".repeat(50));
    const packed = new Uint8Array(deflateRawSync(text));
    const archive = makeZip({ x: packed });
    const view = new DataView(archive.buffer);
    const central = 30 + 1 + packed.length;
    view.setUint16(central + 10, 8, true);
    view.setUint32(central + 16, crc32(text), true);
    view.setUint32(central + 24, text.length, true);
    expect(await readZip(archive)).toEqual(new Map([["x", text]]));
    view.setUint32(central + 24, 100, true);
    await expect(readZip(archive)).rejects.toThrow(/x is damaged/);
  });

  it("refuses everything shorter", async () => {
    for (let length = 0; length < zip.length; ++length) {
      await expect(readZip(zip.slice(0, length)), `${length} bytes`).rejects.toThrow(CaseError);
    }
  });

  it("refuses or survives every flipped byte", async () => {
    for (let at = 0; at < zip.length; ++at) {
      const broken = zip.slice();
      broken[at]! ^= 0xff;
      try {
        const entries = await readZip(broken);
        for (const [name, data] of entries) {
          // What is returned is what was stored, under whatever name.
          expect(["first", "second", ""], name).toContain(new TextDecoder().decode(data));
        }
      } catch (error) {
        expect(error, `byte ${at}`).toBeInstanceOf(CaseError);
      }
    }
  });

  it("refuses more entries than a case has, and a name that is there twice", async () => {
    const many = (count: number) =>
      makeZip(Object.fromEntries(Array.from({ length: count }, (_, i) => [`file ${i}`, bytes("")])));
    expect((await readZip(many(256))).size).toBe(256);
    await expect(readZip(many(257))).rejects.toThrow(/more than 256 files/);
    const doubled = makeZip({ a: bytes("first"), b: bytes("first") });
    doubled[doubled.lastIndexOf("b".charCodeAt(0))] = "a".charCodeAt(0);
    await expect(readZip(doubled)).rejects.toThrow(/holds "a" twice/);
  });

  it("refuses more bytes than a case has, whatever their entries say together", async () => {
    const archive = makeZip({ a: bytes("first"), b: bytes("second") });
    const directory = new DataView(archive.buffer).getUint32(archive.length - 6, true);
    new DataView(archive.buffer).setUint32(directory + 46 + 1 + 24, 2 ** 30, true);
    await expect(readZip(archive)).rejects.toThrow(/more than 1024 MiB/);
  });

  it("says what is wrong", async () => {
    await expect(readZip(bytes("<html>"))).rejects.toThrow(/not a SOG file/);
    await expect(readZip(zip.slice(0, 60))).rejects.toThrow(/ends too early/);
    const damaged = zip.slice();
    damaged[36]! ^= 1; // inside "first"
    await expect(readZip(damaged)).rejects.toThrow(/a\.txt is damaged/);
  });
});
