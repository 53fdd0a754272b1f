import type { Section } from "../sog/section";
import { CaseError } from "../sog/zip";
import type { LoadedCase, Reply, Request } from "./protocol";

export interface Sorted {
  order: Uint32Array;
  /** −1: the scene is no longer the worker's. */
  count: number;
  milliseconds: number;
}

/** A section, and what it took once it was asked for. */
export interface DecodedSection {
  section: Section;
  milliseconds: number;
}

/** One end of a promise. */
interface Waiting<T> {
  resolve: (value: T) => void;
  reject: (error: CaseError) => void;
}

/** A load that nobody has asked for yet. */
interface Expected {
  url: string;
  loaded: Promise<LoadedCase>;
  progress: (share: number) => void;
}

/** The main thread's end of case_worker.ts. */
export class CaseClient {
  readonly #worker: Worker;
  readonly #loads = new Map<number, Waiting<LoadedCase> & { progress: (share: number) => void }>();
  readonly #sections = new Map<number, Waiting<DecodedSection>>();
  #sorted: ((value: Sorted) => void) | null = null;
  #sorting: Promise<Sorted> | null = null;
  #tickets = 0;
  #expected: Expected | null = null;

  constructor() {
    this.#worker = new Worker(new URL("./case_worker.ts", import.meta.url), { type: "module" });
    this.#worker.onmessage = (event: MessageEvent<Reply>) => this.#receive(event.data);
    this.#worker.onerror = () => this.#fail("the viewer's worker stopped; reload the page");
  }

  /** Begins to load what the first load() will ask for. */
  expect(url: string): void {
    const expected: Expected = {
      url,
      progress: () => {},
      loaded: this.#load(url, (share) => expected.progress(share)),
    };
    expected.loaded.catch(() => {}); // said by load()
    this.#expected = expected;
  }

  /** Fetches and decodes; `progress` is told the share that is there, 0…1. Rejects with CaseError. */
  load(url: string, progress: (share: number) => void): Promise<LoadedCase> {
    const expected = this.#expected;
    this.#expected = null;
    if (expected?.url !== url) {
      return this.#load(url, progress);
    }
    expected.progress = progress;
    return expected.loaded;
  }

  /** The section of a case that was loaded and has one. Once; rejects with CaseError. */
  section(ticket: number): Promise<DecodedSection> {
    return new Promise((resolve, reject) => {
      this.#sections.set(ticket, { resolve, reject });
      this.#post({ kind: "section", ticket });
    });
  }

  /** Fetches what may be loaded next. */
  prefetch(url: string): void {
    this.#post({ kind: "prefetch", url: new URL(url, location.href).href });
  }

  /** What is being sorted; null: nothing. */
  get sorting(): Promise<unknown> | null {
    return this.#sorting;
  }

  /** One at a time. `order` is given away until the answer brings it back. */
  sort(scene: number, view: Float32Array, clip: number, order: Uint32Array): Promise<Sorted> {
    this.#sorting = new Promise((resolve) => {
      this.#sorted = resolve;
      this.#post({ kind: "sort", scene, view, clip, order }, [order.buffer]);
    });
    return this.#sorting;
  }

  dispose(): void {
    this.#worker.terminate();
    this.#fail("the viewer is gone");
  }

  #load(url: string, progress: (share: number) => void): Promise<LoadedCase> {
    const ticket = this.#tickets++;
    return new Promise((resolve, reject) => {
      this.#loads.set(ticket, { resolve, reject, progress });
      this.#post({ kind: "load", ticket, url: new URL(url, location.href).href });
    });
  }

  #post(message: Request, transfer: Transferable[] = []): void {
    this.#worker.postMessage(message, transfer);
  }

  #fail(message: string): void {
    for (const waiting of [this.#loads, this.#sections]) {
      waiting.forEach(({ reject }) => reject(new CaseError(message)));
      waiting.clear();
    }
  }

  #receive(reply: Reply): void {
    if (reply.kind === "sorted") {
      const resolve = this.#sorted;
      this.#sorted = null;
      this.#sorting = null;
      resolve?.(reply);
      return;
    }
    const { ticket } = reply;
    const load = this.#loads.get(ticket);
    const section = this.#sections.get(ticket);
    if (reply.kind === "progress") {
      load?.progress(reply.total > 0 ? reply.loaded / reply.total : 0);
    } else if (reply.kind === "loaded") {
      this.#loads.delete(ticket);
      load?.resolve(reply);
    } else if (reply.kind === "section") {
      this.#sections.delete(ticket);
      section?.resolve(reply);
    } else {
      this.#loads.delete(ticket);
      this.#sections.delete(ticket);
      (load ?? section)?.reject(new CaseError(reply.message));
    }
  }
}
