import { Vector3 } from "three";

import { decimal, type Reading } from "./values";

/** Of one case. */
const kMaxPins = 20;

/** A marked point with its value; `joined`: how far it is from the pin before it is measured. */
export interface Pin extends Reading {
  joined: boolean;
}

/** What is measured between two pins, RAS mm. */
export interface Length {
  from: Vector3;
  to: Vector3;
  mm: number;
}

/** With one more, the newest last; the oldest goes where there are too many. The first is never joined. */
export function withPin(pins: readonly Pin[], pin: Pin): Pin[] {
  return freed([...pins, pin].slice(-kMaxPins), 0);
}

/** Without the one at `index`: what was measured from it is gone, too. */
export function withoutPin(pins: readonly Pin[], index: number): Pin[] {
  return freed(
    pins.filter((_, i) => i !== index),
    index,
  );
}

export function lengthsOf(pins: readonly Pin[]): Length[] {
  return pins.flatMap((pin, i) => {
    const from = pin.joined ? pins[i - 1] : undefined;
    return from ? [{ from: from.point, to: pin.point, mm: from.point.distanceTo(pin.point) }] : [];
  });
}

/** "31.4 mm" */
export function lengthText({ mm }: Length): string {
  return `${decimal(mm, 1)} mm`;
}

function freed(pins: Pin[], index: number): Pin[] {
  return pins.map((pin, i) => (i === index && pin.joined ? { ...pin, joined: false } : pin));
}

/** What is being marked: a point, or both ends of a length, one after the other. */
export type Mark = "pin" | "length";

/** Puts pins where they are wanted: one, or two whose distance is measured. */
export class Marking {
  changed: () => void = () => {};
  readonly #addPin: (point: Vector3, joined: boolean) => boolean;
  #mark: Mark | null = null;
  #begun = false; // a length has its first end

  /** `addPin` returns whether there is something to mark. */
  constructor(addPin: (point: Vector3, joined: boolean) => boolean) {
    this.#addPin = addPin;
  }

  /** What the next point is for; null: nothing. */
  get mark(): Mark | null {
    return this.#mark;
  }

  /** What is wanted for the next point; the same once more, or null: nothing. */
  toggle(mark: Mark | null): void {
    this.#set(mark === this.#mark ? null : mark);
  }

  /** Marks a point as what is wanted, or else as `otherwise`. Returns whether there was something to mark. */
  put(point: Vector3, otherwise: Mark = "pin"): boolean {
    const mark = this.#mark ?? otherwise;
    if (!this.#addPin(point, mark === "length" && this.#begun)) {
      return false;
    }
    if (mark === "length" && !this.#begun) {
      this.#set(mark);
      this.#begun = true;
    } else {
      this.#set(null);
    }
    return true;
  }

  #set(mark: Mark | null): void {
    this.#mark = mark;
    this.#begun = false;
    this.changed();
  }
}
