import { computed, type ReadonlySignal, signal } from "@preact/signals-core";

import { crossing, flight } from "./model/flight";
import type { Window } from "./model/grey";
import { type Link, parseLink } from "./model/link";
import { linkedState } from "./model/linked_state";
import type { Stop } from "./model/tour";
import { isSamePicture, type ViewerState, type ViewerStore } from "./model/viewer_state";
import { inOwnWords, texts } from "./text/text";

/** What a tour is played in. */
export interface TourStage {
  readonly store: ViewerStore;
  /** Of grey values, in use. */
  readonly window: Window | null;
  /** The case that is shown, by its name. */
  readonly caseName: string | null;
  /** Shows another look of the volume, by its name. Rejects with a line that says why it cannot be had. */
  openLook(name: string): Promise<void>;
  /** Another look may be wanted soon. */
  expectLook(name: string): void;
  /** Whether the picture of the look before is still seen over the one that was opened. */
  readonly isVeiled: boolean;
  /** How much of it is left, from 1 to 0. */
  veil(share: number): void;
  /** Whether nothing is to move by itself: flights are jumps. */
  isStill(): boolean;
  /** What changes from now on is one step of the history, … */
  takeHold(holder: unknown): void;
  /** … until now. */
  letGo(holder: unknown): void;
  /** A frame is drawn soon: then tick() is called. */
  wake(): void;
}

/** On the way to a stop. */
interface Leg {
  from: ViewerState;
  to: ViewerState;
  slices: Link["slices"]; // that are shown there
  ms: number;
  crosses: boolean; // from one look to another
  began: number | null; // with the first frame
  share: number; // of the way that is behind
}

/**
 * Flies from stop to stop of the tour that the store holds. Whoever else changes what is seen stops it, by whatever
 * means; what was made of it stays.
 */
export class TourPlayer {
  readonly #stage: TourStage;
  readonly #at = signal<string | null>(null); // id of the stop that is flown to, or shown
  readonly #playing = signal(false);
  readonly #trouble = signal("");
  /** The stop that is flown to, or shown; null: none is. */
  readonly stop: ReadonlySignal<Stop | null>;
  #leg: Leg | null = null;
  #until = 0; // ms, the end of the stay
  #applied: ViewerState | null = null; // as this left it; null: it may change
  #going = 0;
  #arrived = false; // at the stop

  constructor(stage: TourStage) {
    this.#stage = stage;
    this.stop = computed(() => this.stops.find(({ id }) => id === this.#at.value) ?? null);
  }

  get stops(): readonly Stop[] {
    return this.#stage.store.state.stops;
  }

  /** Whether it goes on by itself. */
  get playing(): boolean {
    return this.#playing.value;
  }

  /** Why a stop is not shown as it was saved; "": it is. */
  get trouble(): string {
    return this.#trouble.value;
  }

  /** Of the way to the stop, what is behind; null: nothing flies. */
  get share(): number | null {
    return this.#leg?.share ?? null;
  }

  /** From 0; −1: none is shown. */
  get index(): number {
    return this.stops.findIndex(({ id }) => id === this.#at.value);
  }

  /** From where it is, or else the first stop; from the last one, anew. Resolves when it is on its way. */
  async play(): Promise<void> {
    if (this.stops.length > 0) {
      this.#playing.value = true;
      const next = this.index + (this.#arrived || this.index < 0 ? 1 : 0);
      await this.#go(next % this.stops.length);
    }
  }

  pause(): void {
    this.#playing.value = false;
    this.#endLeg();
  }

  async toggle(): Promise<void> {
    if (this.playing) {
      this.pause();
    } else {
      await this.play();
    }
  }

  /** To the stop after this one, or before it; from none to the first or the last. */
  async step(by: -1 | 1): Promise<void> {
    const { index, stops } = this;
    const to = index < 0 && by < 0 ? stops.length - 1 : index + by;
    await this.#go(to);
  }

  /** To a stop, and stays there. */
  async show(id: string): Promise<void> {
    this.pause();
    await this.#go(this.stops.findIndex((stop) => stop.id === id));
  }

  /** No stop is shown any more; the case stays as it is seen. */
  leave(): void {
    ++this.#going;
    this.pause();
    this.#stage.veil(0);
    this.#at.value = null;
    this.#trouble.value = "";
    this.#applied = null;
    if (this.#stage.store.state.tourMarks) {
      this.#stage.store.restore({ tourMarks: null });
    }
  }

  /** Before a frame at `now`, ms. Returns what is behind then of the way that it flew; null: nothing flew. */
  tick(now: number): number | null {
    const { store } = this.#stage;
    if (this.#applied && !isSamePicture(store.state, this.#applied)) {
      this.pause();
      this.#applied = null;
      return null;
    }
    const leg = this.#leg;
    if (leg) {
      this.#fly(leg, now);
    } else if (this.playing && this.#applied && now >= this.#until) {
      if (this.index + 1 < this.stops.length) {
        void this.#go(this.index + 1);
      } else {
        this.pause();
      }
    }
    if (this.#leg || (this.playing && this.#applied)) {
      this.#stage.wake();
    }
    return leg?.share ?? null;
  }

  async #go(index: number): Promise<void> {
    const stop = this.stops[index];
    if (!stop) {
      return;
    }
    const going = ++this.#going;
    this.#endLeg();
    this.#arrived = false;
    this.#applied = null;
    this.#at.value = stop.id;
    this.#trouble.value = "";
    const link = parseLink(stop.show);
    if (link.case && link.case !== this.#stage.caseName) {
      try {
        await this.#stage.openLook(link.case);
      } catch (error) {
        if (going === this.#going) {
          this.#stage.veil(0);
          this.#playing.value = false;
          this.#trouble.value = texts().views.missing(index + 1, inOwnWords((error as Error).message));
        }
        return;
      }
    }
    if (going !== this.#going) {
      return;
    }
    const { store, window, isVeiled } = this.#stage;
    const from = { ...store.state, window };
    const to = { ...linkedState(link, store.state, store.states), tourMarks: link.marks ?? [] };
    this.#stage.takeHold(this);
    this.#leg = {
      from,
      to,
      slices: link.slices,
      ms: this.#stage.isStill() ? 0 : 1000 * stop.fly,
      crosses: isVeiled,
      began: null,
      share: 0,
    };
    this.#stage.wake();
  }

  #fly(leg: Leg, now: number): void {
    const { store } = this.#stage;
    leg.began ??= now;
    leg.share = leg.ms > 0 ? Math.min(1, (now - leg.began) / leg.ms) : 1;
    const { info } = store;
    if (leg.share >= 1 || !info) {
      this.#set(leg.to);
      store.showSlices(leg.slices?.shown ?? null, leg.slices);
      this.#endLeg();
      this.#arrived = true;
      this.#until = now + 1000 * (this.stop.peek()?.stay ?? 0);
      this.#expectNext();
    } else {
      const { before, flown } = leg.crosses ? crossing(leg.share) : { before: 0, flown: leg.share };
      this.#stage.veil(before);
      const shown = flight(leg.from, leg.to, flown, info.sphere);
      this.#set({ ...leg.to, ...shown, mode: "arbitrary", active: 0 });
    }
    this.#applied = store.state;
  }

  /** The look of the stop after this one is fetched while this one is seen. */
  #expectNext(): void {
    const next = this.stops[this.index + 1];
    const look = next && parseLink(next.show).case;
    if (look && look !== this.#stage.caseName) {
      this.#stage.expectLook(look);
    }
  }

  /** What others make of the tour meanwhile stays, and so do the person's own marks. */
  #set(shown: ViewerState): void {
    const { store } = this.#stage;
    const { marks, stops } = store.state;
    store.restore({ ...shown, marks, stops });
  }

  #endLeg(): void {
    if (this.#leg) {
      this.#leg = null;
      this.#stage.veil(0);
      this.#stage.letGo(this);
    }
  }
}
