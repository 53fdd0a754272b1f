import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

import { readZip } from "../../src/sog/zip";
import { makeZip } from "../unit/sog_fixture";

const kMeta = "meta.json";
const kRegions = ["head", "chest", "abdomen", "pelvis", "knee", "heart", "whole body"];

/** Copies of a case, each as of a volume, a title, a region and a day of its own: `copy-0000.sog` and so on. */
export async function makeManyCases(file: string, count: number, folder: string): Promise<void> {
  const entries = Object.fromEntries(await readZip(readFileSync(file)));
  const meta = JSON.parse(new TextDecoder().decode(entries[kMeta])) as { clipgs: Record<string, unknown> };
  for (let i = 0; i < count; ++i) {
    const number = String(i).padStart(4, "0");
    const region = kRegions[i % kRegions.length]!;
    const look = {
      ...(meta.clipgs["look"] as object),
      volume: number.padStart(16, "0"),
      title: "Skin and bone",
      region,
    };
    const created = new Date(Date.UTC(2024, 0, 1 + i)).toISOString().slice(0, 10);
    const clipgs = { ...meta.clipgs, title: `Case ${i}, ${region}`, created, look };
    const text = new TextEncoder().encode(JSON.stringify({ ...meta, clipgs }));
    writeFileSync(join(folder, `copy-${number}.sog`), makeZip({ ...entries, [kMeta]: text }));
  }
}
