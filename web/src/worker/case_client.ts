import type { Section } from "../sog/section";
import { CaseError } from "../sog/zip";
import { LightClient } from "./light_client";
import {
  type CodedSection,
  kSuperseded,
  type LoadedCase,
  type Reply,
  type Request,
  type SectionReply,
  type SectionRequest,
} from "./protocol";

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

/** A section that is being decoded, by a worker of its own. */
interface Decoding {
  ticket: number;
  decoded: Promise<Decoded>;
}

/** The main thread's end of case_worker.ts and section_worker.ts. */
export class CaseClient {
  #worker: Worker | null; // null after it failed: the next case to be loaded has another one
  readonly #loads = new Map<number, Waiting<LoadedCase> & { progress: (share: number) => void }>();
  #decoding: Decoding | null = null; // of the case that was loaded last
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
  expect(url: string): void {
    const expected: Expected = {
      url,
      progress: () => {},
      loaded: this.#load(url, (share) => expected.progress(share)),
    };
    this.#expected = expected;
    // Who asks for it after it failed has it tried anew: a case may be made meanwhile.
    expected.loaded.catch(() => this.#expected === expected && (this.#expected = null));
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

  /** The section of the case that was loaded last and has one, once. Rejects with CaseError. */
  async section(ticket: number): Promise<DecodedSection> {
    const start = performance.now();
    if (this.#decoding?.ticket !== ticket) {
      throw new CaseError(kSuperseded);
    }
    const { decoded } = this.#decoding;
    this.#decoding = null; // its voxels are the caller's
    return { ...(await decoded), milliseconds: performance.now() - start };
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
    this.#dropDecoding(kGone);
    this.#stop(kGone);
  }

  #startWorker(): Worker {
    const worker = new Worker(new URL("./case_worker.ts", import.meta.url), { type: "module" });
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
    this.#endSorting()?.reject(error);
  }

  /** Who waits for what was being sorted. */
  #endSorting(): Waiting<Sorted> | null {
    const waiting = this.#sorted;
    this.#sorted = null;
    this.#sorting = null;
    return waiting;
  }

  #load(url: string, progress: (share: number) => void): Promise<LoadedCase> {
    if (this.#disposed) {
      return Promise.reject(new CaseError(kGone));
    }
    const ticket = this.#tickets++;
    this.#worker ??= this.#startWorker();
    return new Promise((resolve, reject) => {
      this.#loads.set(ticket, { resolve, reject, progress });
      this.#post({ kind: "load", ticket, url: new URL(url, location.href).href });
    });
  }

  #post(message: Request, transfer: Transferable[] = []): void {
    this.#worker?.postMessage(message, transfer);
  }

  /** Begins to decode a section. Its worker goes on as that of its light, or ends. */
  #decode(ticket: number, coded: CodedSection): void {
    const worker = new Worker(new URL("./section_worker.ts", import.meta.url), { type: "module" });
    const decoded = new Promise<Decoded>((resolve, reject) => {
      const forget = (): void => {
        if (this.#stopDecoding === end) {
          this.#stopDecoding = () => {}; // it would hold what was decoded
        }
      };
      const end = (message: string): void => {
        worker.terminate();
        reject(new CaseError(message));
        forget();
      };
      this.#stopDecoding = end;
      worker.onerror = () => end(`${coded.info.file} cannot be decoded: its worker stopped; reload the page`);
      worker.onmessage = ({ data }: MessageEvent<SectionReply>) => {
        if (data.kind === "section") {
          resolve({ section: data.section, light: new LightClient(worker) });
          forget();
        } else if (data.kind === "failed") {
          end(data.message);
        }
      };
    });
    decoded.catch(() => {}); // said when it is asked for
    this.#decoding = { ticket, decoded };
    worker.postMessage({ kind: "decode", coded } satisfies SectionRequest, [coded.webp.buffer]);
  }

  /** Ends the worker of a section that nobody has asked for. */
  #dropDecoding(message: string): void {
    this.#stopDecoding(message);
    this.#decoding?.decoded.then(
      ({ light }) => light.dispose(),
      () => {},
    );
    this.#decoding = null;
  }

  #receive(reply: Reply): void {
    if (reply.kind === "sorted") {
      this.#endSorting()?.resolve(reply);
      return;
    }
    const { ticket } = reply;
    const load = this.#loads.get(ticket);
    if (reply.kind === "progress") {
      load?.progress(reply.total > 0 ? reply.loaded / reply.total : 0);
    } else if (reply.kind === "loaded") {
      this.#loads.delete(ticket);
      this.#dropDecoding(kSuperseded);
      if (reply.section) {
        this.#decode(ticket, reply.section);
      }
      load?.resolve(reply);
    } else {
      this.#loads.delete(ticket);
      load?.reject(new CaseError(reply.message));
    }
  }
}
