import { type ReadonlySignal, signal } from "@preact/signals-core";

import { CaseError } from "../sog/zip";
import { inOwnWords } from "../text/text";
import { caseFile } from "./case_list";

/** What is kept of a case, each with an id that tells it from the others. */
export interface Kept {
  id: string;
}

/** A kind of such things, and the file that holds those of a case (docs/format.md). */
export interface KeptKind<T extends Kept> {
  /** What it is called in addresses and in this browser: of `NAME.marks.json`, "marks". */
  name: string;
  most: number;
  /** Whether a person puts them in an order, or they are in that in which they were made. */
  ordered: boolean;
  /** `volume`: "" where it is not known. */
  format(items: readonly T[], volume: string): string;
  /** `name` is what errors call the file. Throws CaseError where it is not one of that volume. */
  parse(text: string, name: string, volume: string): T[];
}

/** What a person did since what there is was kept last. */
export interface Change<T extends Kept> {
  put: readonly T[]; // made or changed
  gone: ReadonlySet<string>; // ids
  order?: readonly string[]; // of kinds that have one: the ids of all
}

/** Where the things of one kind of one volume are kept between visits. */
export interface Place<T extends Kept> {
  load(): Promise<readonly T[]>;
  /** Rejects with an Error where they cannot be kept. */
  change(change: Change<T>): Promise<void>;
}

/** Whose things are kept: those of a volume or, where that is not known, of the case that a viewer shows. */
export function volumeOf({
  info,
  caseName,
}: {
  info: { volume: string } | null;
  caseName: string | null;
}): string {
  return info?.volume || `/${caseName}`;
}

export function changeBetween<T extends Kept>(
  before: readonly T[],
  after: readonly T[],
  ordered = false,
): Change<T> {
  const known = new Set(before);
  const left = new Set(after.map(({ id }) => id));
  return {
    put: after.filter((item) => !known.has(item)),
    gone: new Set(before.map(({ id }) => id).filter((id) => !left.has(id))),
    ...(ordered ? { order: [...left] } : {}),
  };
}

/** What is kept after a change, in its order, or else in that in which it was made; at most `most`, the latest. */
export function changed<T extends Kept>(
  items: readonly T[],
  { put, gone, order }: Change<T>,
  most = Infinity,
): T[] {
  const kept = items.filter(({ id }) => !gone.has(id));
  const all = [...new Map([...kept, ...put].map((item) => [item.id, item])).values()];
  if (order) {
    const place = new Map(order.map((id, i) => [id, i]));
    all.sort((a, b) => (place.get(a.id) ?? Infinity) - (place.get(b.id) ?? Infinity) || 0);
  }
  return all.slice(-most);
}

/** In this browser, over those that are shown to everybody, if there are some. What another tab kept meanwhile stays. */
export class BrowserPlace<T extends Kept> implements Place<T> {
  readonly #kind: KeptKind<T>;
  readonly #key: string;
  readonly #volume: string;
  readonly #beneath: readonly T[];

  /** `name` is of the case, where nothing is known of its volume. */
  constructor(kind: KeptKind<T>, volume: string, name: string, beneath: readonly T[] = []) {
    this.#kind = kind;
    this.#volume = volume;
    this.#key = `clipgs.${kind.name}.${volume || `${location.pathname}#${name}`}`;
    this.#beneath = beneath;
  }

  load(): Promise<readonly T[]> {
    return Promise.resolve(changed(this.#beneath, this.#kept, this.#kind.most));
  }

  async change(change: Change<T>): Promise<void> {
    const { format, most, ordered } = this.#kind;
    const kept = this.#kept;
    // An order is that of all of them.
    const items = changed(ordered ? changed(this.#beneath, kept) : kept.put, change, most);
    const isPut = new Set(items.map(({ id }) => id));
    const hidden = this.#beneath.filter(
      ({ id }) => !isPut.has(id) && (change.gone.has(id) || kept.gone.has(id)),
    );
    if (items.length + hidden.length > 0) {
      const ids = hidden.map(({ id }) => id);
      localStorage.setItem(this.#key, `${JSON.stringify(ids)}\n${format(items, this.#volume)}`);
    } else {
      localStorage.removeItem(this.#key);
    }
  }

  /** What was put, and what of those beneath is not to be seen. What cannot be read is as if it were not there. */
  get #kept(): Change<T> {
    const { name, ordered, parse } = this.#kind;
    try {
      const [ids = "", text = ""] = localStorage.getItem(this.#key)!.split("\n", 2);
      const put = parse(text, `this browser's ${name}`, this.#volume);
      const order = ordered ? { order: put.map(({ id }) => id) } : {};
      return { put, gone: new Set(JSON.parse(ids) as string[]), ...order };
    } catch {
      return { put: [], gone: new Set() };
    }
  }
}

/** So often what somebody else put meanwhile is read again. */
const kTries = 5;

/** Beside the case on its server, for everybody who opens it there. */
export class ServerPlace<T extends Kept> implements Place<T> {
  readonly #kind: KeptKind<T>;
  readonly #url: string;
  readonly #file: string;
  readonly #volume: string;

  constructor(kind: KeptKind<T>, name: string, volume: string) {
    this.#kind = kind;
    this.#file = `${name}.${kind.name}.json`;
    this.#url = caseFile(name, `${kind.name}.json`);
    this.#volume = volume;
  }

  async load(): Promise<readonly T[]> {
    return (await this.#read()).items;
  }

  async change(change: Change<T>): Promise<void> {
    for (let i = 0; i < kTries; ++i) {
      const { items, etag } = await this.#read();
      const response = await fetch(this.#url, {
        method: "PUT",
        headers: {
          "Content-Type": "application/json",
          ...(etag ? { "If-Match": etag } : { "If-None-Match": "*" }),
        },
        body: this.#kind.format(changed(items, change, this.#kind.most), this.#volume),
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

  /** Throws CaseError where they are not of this volume. */
  async #read(): Promise<{ items: readonly T[]; etag: string | null }> {
    const response = await fetch(this.#url, { cache: "no-cache" });
    if (response.status === 404) {
      return { items: [], etag: null }; // a server that knows cases alone
    }
    if (!response.ok) {
      throw new CaseError((await response.text()).trim());
    }
    const text = await response.text();
    return {
      items: text === "" ? [] : this.#kind.parse(text, this.#file, this.#volume),
      etag: text === "" ? null : response.headers.get("ETag"),
    };
  }
}

/** Where they are on a server that lets them be changed, or else its own with this browser's over them. */
export async function servedPlace<T extends Kept>(
  kind: KeptKind<T>,
  name: string,
  volume: string,
  keeps: boolean,
): Promise<Place<T>> {
  const served = new ServerPlace(kind, name, volume);
  return keeps ? served : new BrowserPlace(kind, volume, name, await served.load());
}

const kSaveMs = 300;

/** Keeps what a person makes of one kind, wherever that of the case has its place. */
export class Keeper<T extends Kept> {
  readonly #ordered: boolean;
  #place: Place<T> | null = null;
  #of = ""; // whose are kept there
  readonly #trouble = signal<string | null>(null);
  #shown: readonly T[] = []; // as last adopted or kept
  #due: readonly T[] | null = null; // shown now, and not kept yet
  #timer = 0;

  constructor({ ordered }: KeptKind<T>) {
    this.#ordered = ordered;
  }

  /** Why they are not kept; null: they are. */
  get trouble(): ReadonlySignal<string | null> {
    return this.#trouble;
  }

  /** What there was before `of` a volume. From now on its own, and no others, are kept in that place. */
  async open(place: Place<T> | Promise<Place<T>>, of: string): Promise<readonly T[]> {
    this.flush();
    this.#place = null; // what cannot be read is not written over
    this.#of = of;
    this.#shown = [];
    this.#trouble.value = null;
    try {
      const found = await place;
      const items = await found.load();
      if (this.#of !== of) {
        return [];
      }
      this.#place = found;
      return items;
    } catch (error) {
      this.#trouble.value = inOwnWords((error as Error).message);
      return [];
    }
  }

  /** These are shown because they were made once, not by what a person does now. */
  adopt(items: readonly T[]): void {
    this.flush();
    this.#shown = items;
  }

  /** These are shown now `of` a volume. */
  observe(items: readonly T[], of: string): void {
    if (items === this.#shown || of !== this.#of || !this.#place) {
      return;
    }
    clearTimeout(this.#timer);
    this.#timer = window.setTimeout(() => this.#keep(items), kSaveMs);
    this.#due = items;
  }

  /** What is to be kept is kept at once. */
  flush(): void {
    clearTimeout(this.#timer);
    if (this.#due) {
      this.#keep(this.#due);
    }
  }

  #keep(items: readonly T[]): void {
    const change = changeBetween(this.#shown, items, this.#ordered);
    this.#shown = items;
    this.#due = null;
    this.#place?.change(change).then(
      () => (this.#trouble.value = null),
      (error: unknown) => (this.#trouble.value = inOwnWords((error as Error).message)),
    );
  }
}
