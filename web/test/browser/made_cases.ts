import { cpSync } from "node:fs";
import { inject } from "vitest";

import type { Server } from "./server";

/** Copies the cases that all tests have (cases.ts), and what they are made of, to where a server serves them. */
export function copyMadeCases(server: Server): void {
  cpSync(inject("made"), server.folder, { recursive: true });
}
