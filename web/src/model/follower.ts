import { computed, type ReadonlySignal, signal } from "@preact/signals-core";

/** What is read again whenever something of what is shown is another. */
export type Follow = <T>(read: () => T) => ReadonlySignal<T>;

/** Lets panels follow what is shown as often as they are told to. */
export class Follower {
  readonly #version = signal(0);

  /** Something is another. */
  refresh(): void {
    this.#version.value = this.#version.peek() + 1;
  }

  readonly live: Follow = (read) =>
    computed(() => {
      void this.#version.value;
      return read();
    });
}
