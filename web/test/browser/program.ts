import { execFile } from "node:child_process";
import { existsSync } from "node:fs";
import { resolve } from "node:path";
import { promisify } from "node:util";

/** The program that serves and renders; the build of the C++ side names it. */
export const kProgram = resolve(process.env["CLIPGS"] ?? "../build/release/src/cli/clipgs");
export const kChromium = process.env["CHROMIUM"] ?? "/usr/bin/chromium";

/** Why these tests cannot run here, or nothing. Where the program is named, it must be there. */
export const missing = process.env["CLIPGS"]
  ? undefined
  : [kProgram, kChromium].find((path) => !existsSync(path));

/** Runs the program and returns what it prints. Not synchronously: the test runner expects to be answered meanwhile. */
export async function clipgs(...args: string[]): Promise<string> {
  const { stdout } = await promisify(execFile)(kProgram, ["--quiet", ...args]);
  return stdout;
}
