import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";

import { type CaseInfo, parseCaseInfo } from "../src/model/case_info";
import { parseSogMeta } from "../src/sog/sog";
import { readZip } from "../src/sog/zip";
import { kProgram } from "../test/browser/program";

/** What a case's file says of itself. Throws CaseError. */
export async function readCaseInfo(file: string): Promise<CaseInfo> {
  return parseCaseInfo(parseSogMeta(await readZip(readFileSync(file))).clipgs);
}

/** Whether its splats have layers. */
export async function caseHasLayers(file: string): Promise<boolean> {
  return parseSogMeta(await readZip(readFileSync(file))).layers !== null;
}

/** Writes a case's Gaussians as other programs read them. */
export function exportSplats(file: string, ply: string): void {
  execFileSync(kProgram, ["--quiet", "export", file, "-o", ply]);
}
