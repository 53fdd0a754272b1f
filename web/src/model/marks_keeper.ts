import { type ReadonlySignal, signal } from "@preact/signals-core";

import { CaseError } from "../sog/zip";
import { kMostMarks, type Mark } from "./marks";
import { formatMarks, parseMarks } from "./marks_file";

/** What a person did to marks since they were kept last. */
export interface MarksChange {
  /** New ones, and those of which something else is said now. */
  put: readonly Mark[];
  /** By their ids. */
  gone: ReadonlySet<string>;
}

/** Where the marks of one volume are kept between visits. */
export interface MarksPlace {
  load(): Promise<readonly Mark[]>;
  /** Rejects with an Error where they cannot be kept. */
  change(change: MarksChange): Promise<void>;
}

export function changeBetween(before: readonly Mark[], after: readonly Mark[]): MarksChange {
  const known = new Set(before);
  const left = new Set(after.map(({ id }) => id));
  return {
    put: after.filter((mark) => !known.has(mark)),
    gone: new Set(before.map(({ id }) => id).filter((id) => !left.has(id))),
  };
}

/** What is kept after a change, in the order in which it was marked. */
export function changed(marks: readonly Mark[], { put, gone }: MarksChange): Mark[] {
  const kept = marks.filter(({ id }) => !gone.has(id));
  const all = new Map([...kept, ...put].map((mark) => [mark.id, mark]));
  return [...all.values()].slice(-kMostMarks);
}

/** In this browser, over those that are shown to everybody, if there are some. What another tab kept meanwhile stays. */
export class BrowserMarks implements MarksPlace {
  readonly #key: string;
  readonly #volume: string;
  readonly #beneath: readonly Mark[];

  /** `name` is of the case, where nothing is known of its volume. */
  constructor(volume: string, name: string, beneath: readonly Mark[] = []) {
    this.#volume = volume;
    this.#key = `clipgs.marks.${volume || `${location.pathname}#${name}`}`;
    this.#beneath = beneath;
  }

  load(): Promise<readonly Mark[]> {
    return Promise.resolve(changed(this.#beneath, this.#kept));
  }

  async change(change: MarksChange): Promise<void> {
    const { put, gone } = this.#kept;
    const marks = changed(put, change);
    const isPut = new Set(marks.map(({ id }) => id));
    const hidden = this.#beneath.filter(({ id }) => !isPut.has(id) && (change.gone.has(id) || gone.has(id)));
    if (marks.length + hidden.length > 0) {
      const ids = hidden.map(({ id }) => id);
      localStorage.setItem(this.#key, `${JSON.stringify(ids)}\n${formatMarks(marks, this.#volume)}`);
    } else {
      localStorage.removeItem(this.#key);
    }
  }

  /** What was put, and what of those beneath is not to be seen. What cannot be read is as if it were not there. */
  get #kept(): MarksChange {
    try {
      const [ids = "", text = ""] = localStorage.getItem(this.#key)!.split("\n", 2);
      return {
        put: parseMarks(text, "this browser's marks", this.#volume),
        gone: new Set(JSON.parse(ids) as string[]),
      };
    } catch {
      return { put: [], gone: new Set() };
    }
  }
}

/** So often what somebody else put meanwhile is read again. */
const kTries = 5;

/** Beside the case on its server, for everybody who opens it there. */
export class ServerMarks implements MarksPlace {
  readonly #url: string;
  readonly #file: string;
  readonly #volume: string;

  constructor(name: string, volume: string) {
    this.#url = `cases/${encodeURIComponent(name)}.marks.json`;
    this.#file = `${name}.marks.json`;
    this.#volume = volume;
  }

  async load(): Promise<readonly Mark[]> {
    return (await this.#read()).marks;
  }

  async change(change: MarksChange): Promise<void> {
    for (let i = 0; i < kTries; ++i) {
      const { marks, etag } = await this.#read();
      const response = await fetch(this.#url, {
        method: "PUT",
        headers: {
          "Content-Type": "application/json",
          ...(etag ? { "If-Match": etag } : { "If-None-Match": "*" }),
        },
        body: formatMarks(changed(marks, change), this.#volume),
        keepalive: true,
      });
      if (response.ok) {
        return;
      }
      if (response.status !== 412) {
        throw new CaseError((await response.text()).trim());
      }
    }
    throw new CaseError("others change them all the time; try again");
  }

  /** Throws CaseError where they are not marks of this volume. */
  async #read(): Promise<{ marks: readonly Mark[]; etag: string | null }> {
    const response = await fetch(this.#url, { cache: "no-cache" });
    if (response.status === 404) {
      return { marks: [], etag: null }; // a server that knows cases alone
    }
    if (!response.ok) {
      throw new CaseError((await response.text()).trim());
    }
    const text = await response.text();
    return {
      marks: text === "" ? [] : parseMarks(text, this.#file, this.#volume),
      etag: text === "" ? null : response.headers.get("ETag"),
    };
  }
}

/** Where a case's marks are on a server that lets them be changed, or else its own with this browser's over them. */
export async function servedMarks(name: string, volume: string, keeps: boolean): Promise<MarksPlace> {
  const served = new ServerMarks(name, volume);
  return keeps ? served : new BrowserMarks(volume, name, await served.load());
}

const kSaveMs = 300;

/** Keeps what a person marks, wherever the case's marks have their place. */
export class MarksKeeper {
  #place: MarksPlace | null = null;
  #of = ""; // which marks are kept there
  readonly #trouble = signal<string | null>(null);
  #shown: readonly Mark[] = []; // as last adopted or kept
  #due: readonly Mark[] | null = null; // shown now, and not kept yet
  #timer = 0;

  /** Why marks are not kept; null: they are. */
  get trouble(): ReadonlySignal<string | null> {
    return this.#trouble;
  }

  /** What was marked before `of` a volume. From now on its marks, and no others, are kept in that place. */
  async open(place: Promise<MarksPlace>, of: string): Promise<readonly Mark[]> {
    this.flush();
    this.#place = null; // what cannot be read is not written over
    this.#of = of;
    this.#shown = [];
    this.#trouble.value = null;
    try {
      const found = await place;
      const marks = await found.load();
      if (this.#of !== of) {
        return [];
      }
      this.#place = found;
      return marks;
    } catch (error) {
      this.#trouble.value = (error as Error).message;
      return [];
    }
  }

  /** These are shown because they were marked once, not by what a person does now. */
  adopt(marks: readonly Mark[]): void {
    this.flush();
    this.#shown = marks;
  }

  /** These are shown now `of` a volume. */
  observe(marks: readonly Mark[], of: string): void {
    if (marks === this.#shown || of !== this.#of || !this.#place) {
      return;
    }
    clearTimeout(this.#timer);
    this.#timer = window.setTimeout(() => this.#keep(marks), kSaveMs);
    this.#due = marks;
  }

  /** What is to be kept is kept at once. */
  flush(): void {
    clearTimeout(this.#timer);
    if (this.#due) {
      this.#keep(this.#due);
    }
  }

  #keep(marks: readonly Mark[]): void {
    const change = changeBetween(this.#shown, marks);
    this.#shown = marks;
    this.#due = null;
    this.#place?.change(change).then(
      () => (this.#trouble.value = null),
      (error: unknown) => (this.#trouble.value = (error as Error).message),
    );
  }
}
