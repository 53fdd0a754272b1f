import { CaseError } from "../sog/zip";
import { kSuperseded } from "./protocol";

/** Of files that are kept, together: a dozen cases. */
const kMostBytes = 64e6;

/** Told how much there is, of how much (0: nobody knows), and what there is. */
export type Progress = (loaded: number, total: number, bytes: Uint8Array) => void;

/** A download, and how many want it: it ends when nobody does. */
interface Running {
  readonly bytes: Promise<Uint8Array>;
  readonly told: Set<Progress>;
  readonly unwanted: AbortController;
  wanted: number;
}

interface Kept {
  etag: string;
  bytes: Uint8Array;
}

/** Whole files of the server: the newest are kept, and only asked for again whether they changed. */
export class FileCache {
  readonly #kept = new Map<string, Kept>(); // the one used last at the end
  readonly #running = new Map<string, Running>();
  #prefetching = new AbortController();

  /**
   * A file, unless `signal` says that it is not wanted any more: it is not downloaded to its end then, unless others
   * want it. What was being prefetched, and is not this, ends, too. Throws CaseError.
   */
  async get(url: string, progress: Progress, signal: AbortSignal): Promise<Uint8Array> {
    const bytes = this.#want(url, progress, signal);
    this.#prefetching.abort();
    return bytes;
  }

  /** Fetches a file that may be wanted next; that it cannot is said when it is. */
  async prefetch(url: string): Promise<void> {
    this.#prefetching.abort();
    this.#prefetching = new AbortController();
    if (!this.#kept.has(url)) {
      await this.#want(url, () => {}, this.#prefetching.signal).catch(() => {});
    }
  }

  #want(url: string, progress: Progress, signal: AbortSignal): Promise<Uint8Array> {
    const running = this.#running.get(url) ?? this.#start(url);
    ++running.wanted;
    running.told.add(progress);
    signal.addEventListener("abort", () => {
      running.told.delete(progress);
      if (--running.wanted === 0) {
        this.#forget(url, running); // who wants it again meanwhile begins anew
        running.unwanted.abort();
      }
    });
    return running.bytes;
  }

  #start(url: string): Running {
    const unwanted = new AbortController();
    const told = new Set<Progress>();
    const tell: Progress = (...how) => told.forEach((progress) => progress(...how));
    const bytes = this.#download(url, tell, unwanted.signal);
    const running = { bytes, told, unwanted, wanted: 0 };
    const end = (): void => this.#forget(url, running);
    bytes.then(end, end);
    this.#running.set(url, running);
    return running;
  }

  #forget(url: string, running: Running): void {
    if (this.#running.get(url) === running) {
      this.#running.delete(url);
    }
  }

  async #download(url: string, progress: Progress, signal: AbortSignal): Promise<Uint8Array> {
    const kept = this.#kept.get(url);
    let response: Response;
    try {
      response = await fetch(url, { signal, headers: kept ? { "If-None-Match": kept.etag } : {} });
    } catch {
      throw new CaseError(signal.aborted ? kSuperseded : "the server does not answer; is it still running?");
    }
    if (kept && response.status === 304) {
      this.#keep(url, kept);
      return kept.bytes;
    }
    this.#kept.delete(url);
    if (!response.ok || !response.body) {
      const text = await response.text();
      throw new CaseError(
        response.headers.get("content-type")?.startsWith("text/plain") && text
          ? text.trim()
          : `the server has no such case (status ${response.status}); choose another`,
      );
    }
    const bytes = await readBody(response, response.body, progress, signal);
    const etag = response.headers.get("etag");
    // Another origin would have to allow the header that asks whether a file changed: the browser's own cache does there.
    if (etag && response.type !== "cors") {
      this.#keep(url, { etag, bytes });
    }
    return bytes;
  }

  #keep(url: string, file: Kept): void {
    this.#kept.delete(url);
    this.#kept.set(url, file);
    let sum = [...this.#kept.values()].reduce((total, { bytes }) => total + bytes.length, 0);
    for (const [oldest, { bytes }] of this.#kept) {
      if (sum <= kMostBytes) {
        break;
      }
      sum -= bytes.length;
      this.#kept.delete(oldest);
    }
  }
}

async function readBody(
  response: Response,
  body: ReadableStream<Uint8Array>,
  progress: Progress,
  signal: AbortSignal,
): Promise<Uint8Array> {
  const total = Number(response.headers.get("content-length") ?? 0);
  let bytes = new Uint8Array(total || 1 << 20);
  let loaded = 0;
  try {
    const reader = body.getReader();
    for (let part = await reader.read(); !part.done; part = await reader.read()) {
      if (loaded + part.value.length > bytes.length) {
        const larger = new Uint8Array(2 * (loaded + part.value.length));
        larger.set(bytes.subarray(0, loaded));
        bytes = larger;
      }
      bytes.set(part.value, loaded);
      loaded += part.value.length;
      progress(loaded, total, bytes.subarray(0, loaded));
    }
  } catch {
    throw new CaseError(
      signal.aborted ? kSuperseded : "the connection broke while the case was loading; try again",
    );
  }
  return bytes.subarray(0, loaded);
}
