import { CaseError } from "../sog/zip";

/** Of files that are kept, together: a dozen cases. */
const kMostBytes = 64e6;

type Progress = (loaded: number, total: number) => void;

interface Kept {
  etag: string;
  bytes: Uint8Array;
}

/** Whole files of the server: the newest are kept, and only asked for again whether they changed. */
export class FileCache {
  readonly #kept = new Map<string, Kept>(); // the one used last at the end
  readonly #running = new Map<string, Promise<Uint8Array>>();

  /** Throws CaseError. */
  async get(url: string, progress: Progress): Promise<Uint8Array> {
    const running = this.#running.get(url);
    if (running) {
      return running;
    }
    const download = this.#download(url, progress).finally(() => this.#running.delete(url));
    this.#running.set(url, download);
    return download;
  }

  /** Fetches a file that may be wanted next; that it cannot is said when it is. */
  async prefetch(url: string): Promise<void> {
    if (!this.#kept.has(url)) {
      await this.get(url, () => {}).catch(() => {});
    }
  }

  async #download(url: string, progress: Progress): Promise<Uint8Array> {
    const kept = this.#kept.get(url);
    let response: Response;
    try {
      response = await fetch(url, kept ? { headers: { "If-None-Match": kept.etag } } : {});
    } catch {
      throw new CaseError("the server does not answer; is it still running?");
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
    const bytes = await readBody(response, response.body, progress);
    const etag = response.headers.get("etag");
    if (etag) {
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
      progress(loaded, total);
    }
  } catch {
    throw new CaseError("the connection broke while the case was loading; try again");
  }
  return bytes.subarray(0, loaded);
}
