/** What was, to go back to and forth: a list of states with a place in it. */
export class History<T> {
  readonly #states: T[];
  readonly #most: number;
  #at = 0;

  /** Remembers `most` states at most; the oldest goes first. */
  constructor(first: T, most = 100) {
    this.#states = [first];
    this.#most = most;
  }

  get current(): T {
    return this.#states[this.#at]!;
  }

  get canUndo(): boolean {
    return this.#at > 0;
  }

  get canRedo(): boolean {
    return this.#at < this.#states.length - 1;
  }

  /** A new state, after the current one; what was undone is gone. */
  record(state: T): void {
    this.#states.splice(++this.#at, Infinity, state);
    if (this.#states.length > this.#most) {
      this.#states.shift();
      --this.#at;
    }
  }

  /** The state before, the current one where there is none. */
  undo(): T {
    this.#at = Math.max(0, this.#at - 1);
    return this.current;
  }

  redo(): T {
    this.#at = Math.min(this.#states.length - 1, this.#at + 1);
    return this.current;
  }
}
