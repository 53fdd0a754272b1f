import { describe, expect, it } from "vitest";

import { CaseError } from "../../src/sog/zip";
import { ZipBeginning } from "../../src/sog/zip_beginning";
import { arrive, type Cover } from "../../src/worker/arriving";
import type { Progress } from "../../src/worker/file_cache";
import { makeArchive, makeMeta, makeZip } from "./sog_fixture";

const bytes = (text: string) => new TextEncoder().encode(text);

/** A case with a picture, its files in the order in which clipgs writes them, then `more`. */
function makeFiles(
  more: Record<string, Uint8Array> = { "section.webp": new Uint8Array(500) },
): Record<string, Uint8Array> {
  const meta = makeMeta(20);
  Object.assign(meta["clipgs"] as object, { title: "A head", thumbnail: "thumbnail.webp" });
  const { "meta.json": json, ...images } = Object.fromEntries(makeArchive(meta));
  return { "thumbnail.webp": bytes("picture"), "meta.json": json!, ...images, ...more };
}

/** What comes of a file whose bytes come `step` by `step`, and how many were there when its splats were. */
async function arrival(zip: Uint8Array, early: boolean, step = 250) {
  const covers: Cover[] = [];
  let there = 0;
  const fetchFile = async (progress: Progress) => {
    while (there < zip.length) {
      there = Math.min(zip.length, there + step);
      progress(there, zip.length, zip.subarray(0, there));
      await new Promise((resume) => setTimeout(resume)); // who waits has the turn
    }
    return zip;
  };
  const { splats, whole } = arrive(fetchFile, early, (cover) => covers.push(cover));
  const first = await splats.then(
    () => there,
    () => null,
  );
  return { first, whole, covers };
}

describe("a case that arrives", () => {
  it("has its cover and its splats before the rest", async () => {
    const zip = makeZip(makeFiles());
    const { first, whole, covers } = await arrival(zip, true);
    expect(first).toBeLessThan(zip.length - 500);
    expect((await whole).get("section.webp")).toHaveLength(500);
    expect(covers.map(({ title, thumbnail }) => [title, new TextDecoder().decode(thumbnail)])).toEqual([
      ["A head", "picture"],
    ]);
  });

  it("is whole at once for those who want it so, and where meta.json comes last", async () => {
    const files = makeFiles();
    const zip = makeZip(files);
    expect((await arrival(zip, false)).first).toBe(zip.length);
    const { "meta.json": meta, ...others } = files;
    const older = makeZip({ ...others, "meta.json": meta! });
    const directory = new DataView(older.buffer).getUint32(older.length - 6, true);
    expect((await arrival(older, true)).first).toBeGreaterThanOrEqual(directory);
  });

  it("is refused for what is wrong with its end", async () => {
    const zip = makeZip(makeFiles());
    const { first, whole } = await arrival(zip.slice(0, zip.length - 30), true);
    expect(first).toBeLessThan(zip.length - 500);
    await expect(whole).rejects.toThrow(/too early/);
    const damaged = zip.slice();
    const directory = new DataView(zip.buffer).getUint32(zip.length - 6, true);
    damaged[directory - 1]! ^= 1; // in the section
    await expect((await arrival(damaged, true)).whole).rejects.toThrow(CaseError);
  });

  it("is refused where its directory names other files than its beginning", async () => {
    const zip = makeZip(makeFiles());
    const other = makeZip(makeFiles({ "section.webp": new Uint8Array(400) }));
    // All of one case, and after it another whose directory is the archive's.
    const both = new Uint8Array(zip.length + other.length);
    both.set(zip);
    both.set(other, zip.length);
    const view = new DataView(both.buffer, zip.length);
    const directory = view.getUint32(other.length - 6, true);
    view.setUint32(other.length - 6, directory + zip.length, true);
    for (let at = directory; at < other.length - 22; at += 46 + view.getUint16(at + 28, true)) {
      view.setUint32(at + 42, view.getUint32(at + 42, true) + zip.length, true);
    }
    await expect((await arrival(both, true)).whole).rejects.toThrow(/directory is damaged/);
  });
});

describe("the beginning of a ZIP", () => {
  const zip = makeZip({ a: bytes("first"), b: bytes("second"), c: bytes("third") });
  const names = (archive: Uint8Array): string => {
    const beginning = new ZipBeginning();
    beginning.read(archive);
    return [...beginning.entries.keys()].join("");
  };

  it("has what is whole of it, however little comes at once", () => {
    const beginning = new ZipBeginning();
    const grown: number[] = [];
    for (let length = 0; length <= zip.length; ++length) {
      if (beginning.read(zip.subarray(0, length))) {
        grown.push(length);
      }
    }
    expect(grown).toEqual([36, 73, 109]);
    expect(new TextDecoder().decode(beginning.entries.get("b"))).toBe("second");
    expect(beginning.archive.has("later")).toBe(true);
    expect(beginning.archive.get("later")).toBe(undefined);
  });

  it("ends before what is packed, damaged, there twice, or of a size that comes later", () => {
    const changed = (at: number, value: number): string => {
      const archive = zip.slice();
      archive[36 + at] = value;
      return names(archive);
    };
    expect(names(zip)).toBe("abc");
    expect(changed(8, 8)).toBe("a"); // deflated
    expect(changed(6, 8)).toBe("a"); // sizes follow
    expect(changed(18, 7)).toBe("a"); // two sizes
    expect(changed(31, 0)).toBe("a"); // content
    expect(changed(30, "a".charCodeAt(0))).toBe("a");
    expect(changed(0, 0)).toBe("a"); // no header
  });
});
