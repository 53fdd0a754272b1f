import { afterAll, beforeEach, describe, expect, it, vi } from "vitest";

import { SectionError } from "../../src/sog/section";
import { CaseClient } from "../../src/worker/case_client";
import { kSuperseded } from "../../src/worker/protocol";

/** A worker that answers what a test says. */
class FakeWorker {
  static made: FakeWorker[] = [];
  readonly asked: { kind?: string; ticket: number }[] = [];
  ended = false;
  onmessage: (event: { data: unknown }) => void = () => {};
  onerror: () => void = () => {};

  constructor() {
    FakeWorker.made.push(this);
  }

  postMessage(message: { kind?: string; ticket: number }): void {
    this.asked.push(message);
  }

  terminate(): void {
    this.ended = true;
  }

  /** Answers the newest request, with all of a case. */
  load(section: object | null): void {
    this.begin(section !== null);
    this.end(section);
  }

  begin(hasSection: boolean): void {
    this.#answer({ kind: "loaded", hasSection });
  }

  end(section: object | null, sectionProblem: string | null = null): void {
    this.#answer({ kind: "rest", section, sectionProblem });
  }

  fail(message: string): void {
    this.#answer({ kind: "failed", message });
  }

  #answer(data: object): void {
    this.onmessage({ data: { ticket: this.asked.at(-1)!.ticket, ...data } });
  }
}

describe("the client of the case worker", () => {
  vi.stubGlobal("Worker", FakeWorker);
  vi.stubGlobal("location", { href: "http://127.0.0.1/" });
  let client: CaseClient;
  let worker: FakeWorker;

  beforeEach(() => {
    FakeWorker.made = [];
    client = new CaseClient();
    worker = FakeWorker.made[0]!;
  });

  afterAll(() => void vi.unstubAllGlobals());

  const sort = () => client.sort(0, new Float32Array(1), 0, new Uint32Array(1));
  const load = () => client.load("a.sog", null, true);
  const section = () => ({ info: { file: "section.webp" }, coded: new Uint8Array(1) });

  it("ends what waits for a worker that fails, and has another one for the next case", async () => {
    const [sorted, loaded, sorting] = [sort(), load(), client.sorting];
    worker.onerror();
    await expect(sorted).rejects.toThrow(/worker stopped/);
    await expect(loaded).rejects.toThrow(/worker stopped/);
    await sorting; // whoever waits for its end alone hears of none
    expect(client.sorting).toBe(null);
    expect(worker.ended).toBe(true);
    await expect(sort()).rejects.toThrow(/worker stopped/);
    expect(client.sorting).toBe(null);

    const again = load();
    expect(FakeWorker.made).toHaveLength(2);
    FakeWorker.made[1]!.load(null);
    expect(await again).toMatchObject({ hasSection: false });
  });

  it("ends what waits when it is disposed of, and begins nothing then", async () => {
    const [sorted, loaded] = [sort(), load()];
    client.dispose();
    await expect(sorted).rejects.toThrow("the viewer is gone");
    await expect(loaded).rejects.toThrow("the viewer is gone");
    await expect(load()).rejects.toThrow("the viewer is gone");
    expect(FakeWorker.made).toHaveLength(1);
  });

  it("gives a section away once", async () => {
    const loaded = load();
    worker.load(section());
    const { ticket } = await loaded;
    const decoded = client.section(ticket);
    const decoder = FakeWorker.made[1]!;
    decoder.onmessage({ data: { kind: "section", section: { voxels: "those" } } });
    const { section: got, light } = (await decoded)!;
    expect(got).toEqual({ voxels: "those" });
    await expect(client.section(ticket)).rejects.toThrow(kSuperseded);
    // Its decoder is from now on that of the light in what cuts open.
    expect(decoder.ended).toBe(false);
    decoder.onmessage({ data: { kind: "openings", openings: null } });
    expect(await light.openings).toBe(null);
    const lit = light.solve(new Float32Array([0, 0, 1, 5]), false);
    expect(decoder.asked.at(-1)).toEqual({
      kind: "light",
      planes: new Float32Array([0, 0, 1, 5]),
      quick: false,
    });
    decoder.onmessage({ data: { kind: "lit", light: { texels: new Uint8Array([7]), scale: 2 } } });
    expect(await lit).toEqual({ texels: new Uint8Array([7]), scale: 2 });
    const never = light.solve(new Float32Array(4), true);
    light.dispose();
    expect(await never).toBe(null);
    expect(decoder.ended).toBe(true);
  });

  it("gives what is seen first before the rest, and says what is wrong with that", async () => {
    const first = load();
    worker.begin(true);
    const { ticket, hasSection } = await first;
    expect(hasSection).toBe(true);
    const missing = client.section(ticket);
    worker.end(null, "section.webp is missing");
    await expect(missing).rejects.toThrow(SectionError);
    await expect(missing).rejects.toThrow("section.webp is missing");

    const second = load();
    worker.begin(true);
    const broken = client.section((await second).ticket);
    worker.fail("the file ends too early");
    await expect(broken).rejects.toThrow("the file ends too early");
    await expect(broken).rejects.not.toThrow(SectionError);

    const third = load();
    worker.begin(false);
    const none = client.section((await third).ticket);
    worker.end(null);
    expect(await none).toBe(null);
  });

  it("tells of the newest load alone how it comes", async () => {
    const heard: unknown[] = [];
    const listener = (name: string) => ({
      progress: (...how: number[]) => heard.push([name, ...how]),
      cover: ({ title }: { title: string }) => heard.push([name, title]),
    });
    const tell = (ticket: number, data: object) => worker.onmessage({ data: { ticket, ...data } });
    client.expect("a.sog", listener("a"));
    const first = worker.asked.at(-1)!.ticket;
    tell(first, { kind: "progress", loaded: 1, total: 3 });
    const loaded = client.load("a.sog", listener("again"), true);
    expect(worker.asked).toHaveLength(1);
    tell(first, { kind: "cover", title: "A" });
    worker.load(null);
    await loaded;
    void client.load("b.sog", listener("b"), true).catch(() => {});
    tell(first, { kind: "progress", loaded: 2, total: 3 });
    tell(worker.asked.at(-1)!.ticket, { kind: "progress", loaded: 5, total: 6 });
    expect(heard).toEqual([
      ["a", 1, 3],
      ["a", "A"],
      ["b", 5, 6],
    ]);
  });

  it("ends the worker of a section that was decoded for nobody", async () => {
    const first = load();
    worker.load(section());
    await first;
    const decoder = FakeWorker.made[1]!;
    decoder.onmessage({ data: { kind: "section", section: { voxels: "those" } } });
    const next = load();
    worker.load(null);
    await next;
    await Promise.resolve();
    expect(decoder.ended).toBe(true);
  });

  it("forgets a section that nobody asked for when another case is there", async () => {
    const first = load();
    worker.load(section());
    const { ticket } = await first;
    const next = load();
    worker.load(null);
    await next;
    await expect(client.section(ticket)).rejects.toThrow(kSuperseded);
  });
});
