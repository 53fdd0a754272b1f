import { type ChildProcess, spawn } from "node:child_process";
import { mkdirSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";

import { kProgram } from "./program";

/** A folder of cases that `clipgs serve` serves. */
export class Server {
  readonly folder = mkdtempSync(join(tmpdir(), "clipgs-browser-"));
  readonly cases = join(this.folder, "cases");
  url = "";
  #server!: ChildProcess;
  #options: string[] = [];

  /** Serves what `makeCases` puts into the folder of cases, with more options of `clipgs serve`. */
  async start(makeCases: (cases: string) => Promise<void> | void, ...options: string[]): Promise<void> {
    mkdirSync(this.cases, { recursive: true });
    await makeCases(this.cases);
    this.#options = options;
    await this.#serve("0");
  }

  /** Of the program that serves. */
  get pid(): number {
    return this.#server.pid!;
  }

  /** As a power cut does. */
  async cutPower(): Promise<void> {
    const gone = new Promise((done) => this.#server.once("exit", done));
    this.#server.kill("SIGKILL");
    await gone;
  }

  /** The same again, at the same address. */
  async serveAgain(): Promise<void> {
    await this.#serve(new URL(this.url).port);
  }

  async #serve(port: string): Promise<void> {
    this.#server = spawn(kProgram, ["serve", this.cases, "--port", port, "--json", ...this.#options], {
      stdio: ["ignore", "pipe", "inherit"],
      env: { ...process.env, XDG_STATE_HOME: this.folder },
    });
    const line = await new Promise<string>((done, fail) => {
      createInterface(this.#server.stdout!).once("line", done);
      this.#server.once("exit", () => fail(new Error("clipgs serve ended before it served")));
    });
    this.url = (JSON.parse(line) as { url: string }).url;
  }

  /** How it ends when it is asked to. */
  async stop(): Promise<number | null> {
    if (this.#server?.exitCode === null) {
      const ended = new Promise((done) => this.#server.once("exit", done));
      this.#server.kill("SIGTERM");
      await ended;
    }
    const status = this.#server?.exitCode ?? null;
    rmSync(this.folder, { recursive: true, force: true });
    return status;
  }
}
