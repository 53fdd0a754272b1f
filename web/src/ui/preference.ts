import { type ReadonlySignal, signal } from "@preact/signals-core";

/** What this browser's user chose once, for all viewers of a page; remembered where the browser lets it be. */
export class Preference<T extends string> {
  readonly #key: string;
  readonly #value;

  /** `known` are the values that it may have, the first of them where nothing was chosen. */
  constructor(key: string, known: readonly T[]) {
    this.#key = key;
    this.#value = signal(known.find((one) => one === stored(key)) ?? known[0]!);
  }

  get signal(): ReadonlySignal<T> {
    return this.#value;
  }

  get value(): T {
    return this.#value.value;
  }

  set value(value: T) {
    this.#value.value = value;
    try {
      localStorage.setItem(this.#key, value);
    } catch {
      // Storage is barred: the choice holds for this page.
    }
  }
}

function stored(key: string): string | null {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}
