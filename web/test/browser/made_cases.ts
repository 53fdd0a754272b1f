import { cpSync } from "node:fs";
import { inject } from "vitest";

import type { Session } from "./session";

/** Copies the cases that all tests have (cases.ts), and what they are made of, to where a session serves them. */
export function copyMadeCases(session: Session): void {
  cpSync(inject("made"), session.folder, { recursive: true });
}
