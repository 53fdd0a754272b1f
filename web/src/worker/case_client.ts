import { type Section, SectionError } from "../sog/section";
import { CaseError } from "../sog/zip";
import type { Cover } from "./arriving";
import { LightClient } from "./light_client";
import {
  type CaseSource,
  type CodedSection,
  kSuperseded,
  type LoadedCase,
  type Reply,
  type Request,
  type SectionReply,
  type SectionRequest,
} from "./protocol";
import { startCaseWorker, startSectionWorker } from "./start_workers";

const kStopped = "the viewer's worker stopped; open the case again";
const kGone = "the viewer is gone";

export interface Sorted {
  order: Uint32Array;
  /** −1: the scene is no longer the worker's. */
  count: number;
  milliseconds: number;
}

/** A section, what lights the openings of its cuts, and what decoding took once it was asked for. */
export interface DecodedSection {
  section: Section;
  light: LightClient;
  milliseconds: number;
}

type Decoded = Pick<DecodedSection, "section" | "light">;

/** Who waits for a case hears how it comes. */
export interface LoadListener {
  /** Bytes that are there, of how many; 0: nobody knows. */
  progress(loaded: number, total: number): void;
  /** Before the case itself, if its file begins with it. */
  cover?(cover: Cover): void;
}

/** One end of a promise. */
interface Waiting<T> {
  resolve: (value: T) => void;
  reject: (error: CaseError) => void;
}

/** A load that nobody has asked for yet. */
interface Expected {
  source: CaseSource;
  loaded: Promise<LoadedCase>;
}

/** What is still to come of a case, or to be decoded, by a worker of its own. */
interface Rest {
  ticket: number;
  decoded: Promise<Decoded | null>;
}

/** The main thread's end of case_worker.ts and section_worker.ts. */
export class CaseClient {
  #worker: Worker | null; // null after it failed: the next case to be loaded has another one
  readonly #loads = new Map<number, Waiting<LoadedCase>>();
  #listener: LoadListener | null = null; // to the load that was begun last
  #rest: Rest | null = null; // of the case that was loaded last
  #coming: (Waiting<Decoded | null> & { ticket: number }) | null = null; // who waits for that to be there
  #stopDecoding: (message: string) => void = () => {};
  #sorted: Waiting<Sorted> | null = null;
  #sorting: Promise<void> | null = null;
  #tickets = 0;
  #expected: Expected | null = null;
  #disposed = false;

  constructor() {
    this.#worker = this.#startWorker();
  }

  /** Begins to load what the first load() will ask for. */
  expect(url: string, listener: LoadListener): void {
    const expected: Expected = { source: url, loaded: this.#load(url, listener, true) };
    this.#expected = expected;
    // Who asks for it after it failed has it tried anew: a case may be made meanwhile.
    expected.loaded.catch(() => this.#expected === expected && (this.#expected = null));
  }

  /**
   * Fetches and decodes, as is told to `listener`. `early`: what is seen first is given as soon as it is there, whether
   * the rest comes or not. Rejects with CaseError.
   */
  load(source: CaseSource, listener: LoadListener | null, early: boolean): Promise<LoadedCase> {
    const expected = this.#expected;
    this.#expected = null;
    return expected?.source === source ? expected.loaded : this.#load(source, listener, early);
  }

  /**
   * The section of the case that was loaded last, once, when all of that is there; null: it has none. Rejects with
   * SectionError where it alone is broken, or CaseError.
   */
  async section(ticket: number): Promise<DecodedSection | null> {
    const start = performance.now();
    if (this.#rest?.ticket !== ticket) {
      throw new CaseError(kSuperseded);
    }
    const { decoded } = this.#rest;
    this.#rest = null; // its voxels are the caller's
    const section = await decoded;
    return section && { ...section, milliseconds: performance.now() - start };
  }

  /** Fetches what may be loaded next. */
  prefetch(url: string): void {
    this.#post({ kind: "prefetch", url: new URL(url, location.href).href });
  }

  /** Until what is being sorted is, or cannot be; null: nothing is. */
  get sorting(): Promise<void> | null {
    return this.#sorting;
  }

  /** One at a time. `order` is given away until the answer brings it back. Rejects with CaseError. */
  sort(scene: number, view: Float32Array, clip: number, order: Uint32Array): Promise<Sorted> {
    if (!this.#worker) {
      return Promise.reject(new CaseError(kStopped));
    }
    const sorted = new Promise<Sorted>((resolve, reject) => {
      this.#sorted = { resolve, reject };
      this.#post({ kind: "sort", scene, view, clip, order }, [order.buffer]);
    });
    this.#sorting = sorted.then(
      () => {},
      () => {},
    );
    return sorted;
  }

  dispose(): void {
    this.#disposed = true;
    this.#dropRest(kGone);
    this.#stop(kGone);
  }

  #startWorker(): Worker {
    const worker = startCaseWorker();
    worker.onmessage = (event: MessageEvent<Reply>) => this.#receive(event.data);
    worker.onerror = () => this.#stop(kStopped);
    return worker;
  }

  /** Ends the worker, and whatever waits for it. */
  #stop(message: string): void {
    this.#worker?.terminate();
    this.#worker = null;
    const error = new CaseError(message);
    this.#loads.forEach(({ reject }) => reject(error));
    this.#loads.clear();
    this.#coming?.reject(error);
    this.#endSorting()?.reject(error);
  }

  /** Who waits for what was being sorted. */
  #endSorting(): Waiting<Sorted> | null {
    const waiting = this.#sorted;
    this.#sorted = null;
    this.#sorting = null;
    return waiting;
  }

  #load(source: CaseSource, listener: LoadListener | null, early: boolean): Promise<LoadedCase> {
    if (this.#disposed) {
      return Promise.reject(new CaseError(kGone));
    }
    const ticket = this.#tickets++;
    this.#listener = listener;
    this.#worker ??= this.#startWorker();
    return new Promise((resolve, reject) => {
      this.#loads.set(ticket, { resolve, reject });
      const whole = typeof source === "string" ? new URL(source, location.href).href : source;
      this.#post({ kind: "load", ticket, source: whole, early });
    });
  }

  #post(message: Request, transfer: Transferable[] = []): void {
    this.#worker?.postMessage(message, transfer);
  }

  /** From now on the rest of a case is waited for. */
  #awaitRest(ticket: number): void {
    const decoded = new Promise<Decoded | null>((resolve, reject) => {
      this.#coming = { ticket, resolve, reject };
    });
    decoded.catch(() => {}); // said when it is asked for
    this.#rest = { ticket, decoded };
  }

  /** Begins to decode a section. Its worker goes on as that of its light, or ends. */
  #decode(coded: CodedSection, { resolve, reject }: Waiting<Decoded>): void {
    const worker = startSectionWorker();
    const forget = (): void => {
      if (this.#stopDecoding === stop) {
        this.#stopDecoding = () => {}; // it would hold what was decoded
      }
    };
    const end = (error: CaseError): void => {
      worker.terminate();
      reject(error);
      forget();
    };
    const stop = (message: string): void => end(new CaseError(message));
    const fail = (message: string): void => end(new SectionError(message));
    this.#stopDecoding = stop;
    worker.onerror = () => fail(`${coded.info.file} cannot be decoded: its worker stopped; reload the page`);
    worker.onmessage = ({ data }: MessageEvent<SectionReply>) => {
      if (data.kind === "section") {
        resolve({ section: data.section, light: new LightClient(worker) });
        forget();
      } else if (data.kind === "failed") {
        fail(data.message);
      }
    };
    worker.postMessage({ kind: "decode", coded } satisfies SectionRequest, [coded.coded.buffer]);
  }

  /** Ends the worker of a section that nobody has asked for. */
  #dropRest(message: string): void {
    this.#coming?.reject(new CaseError(message));
    this.#coming = null;
    this.#stopDecoding(message);
    this.#rest?.decoded.then(
      (section) => section?.light.dispose(),
      () => {},
    );
    this.#rest = null;
  }

  #receive(reply: Reply): void {
    switch (reply.kind) {
      case "sorted":
        this.#endSorting()?.resolve(reply);
        break;
      case "progress":
        if (this.#isNewest(reply.ticket)) {
          this.#listener?.progress(reply.loaded, reply.total);
        }
        break;
      case "cover":
        if (this.#isNewest(reply.ticket)) {
          this.#listener?.cover?.(reply);
        }
        break;
      case "loaded":
        this.#dropRest(kSuperseded);
        this.#awaitRest(reply.ticket);
        this.#endLoad(reply.ticket)?.resolve(reply);
        break;
      case "rest":
        this.#takeRest(reply);
        break;
      case "failed": {
        const error = new CaseError(reply.message);
        this.#endLoad(reply.ticket)?.reject(error);
        this.#endComing(reply.ticket)?.reject(error);
      }
    }
  }

  #isNewest(ticket: number): boolean {
    return ticket === this.#tickets - 1;
  }

  #takeRest({ ticket, section, sectionProblem }: Extract<Reply, { kind: "rest" }>): void {
    const coming = this.#endComing(ticket);
    if (!coming) {
      return; // of a case before
    }
    if (section) {
      this.#decode(section, coming);
    } else if (sectionProblem) {
      coming.reject(new SectionError(sectionProblem));
    } else {
      coming.resolve(null);
    }
  }

  /** Who waits for a load. */
  #endLoad(ticket: number): Waiting<LoadedCase> | undefined {
    const waiting = this.#loads.get(ticket);
    this.#loads.delete(ticket);
    return waiting;
  }

  /** Who waits for the rest of a case. */
  #endComing(ticket: number): Waiting<Decoded | null> | null {
    const coming = this.#coming?.ticket === ticket ? this.#coming : null;
    this.#coming = coming ? null : this.#coming;
    return coming;
  }
}
