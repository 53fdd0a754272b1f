import type { ReadonlySignal } from "@preact/signals-core";
import type { Vector3 } from "three";

import type { Actions } from "../../actions";
import type { CaseSummary, LoadingCase } from "../../model/case_list";
import type { Follow } from "../../model/follower";
import type { Look } from "../../model/looks";
import type { Marking } from "../../model/marking";
import type { Study } from "../../study/study";
import type { TourPlayer } from "../../tour_player";
import type { Message } from "../../ui/message";
import type { Viewer } from "../../viewer";
import type { Governor } from "../governor";
import type { HeldLamp } from "../held_lamp";
import type { Stage } from "../stage";
import type { PalmHand } from "./palm_menu";

/** What is done for the panel by what is around it. */
export interface PanelHost {
  cases(): Promise<CaseSummary[]>;
  /** Of the volume that is shown; none where it has one alone. */
  looks(): readonly Look[];
  /** What the case is where it is not finished, and when there will be a better one. */
  news(): string;
  open(name: string): Promise<void>;
  /** What went wrong. */
  readonly message: Message;
  /** The case that is on its way. */
  readonly loading: ReadonlySignal<LoadingCase | null>;
  leave(): void;
  /** Of the views that are saved. */
  readonly tour: TourPlayer;
  /** Puts case and panel before the eyes, the case in life size. */
  place(): void;
  /** Turns the case so that a side of the patient (RAS) is looked at. */
  turnTo(side: Vector3): void;
  /** That is led through, if one is: the panel is its alone then. */
  readonly study: Study | null;
  readonly stage: Stage;
  readonly governor: Governor;
  readonly lamp: HeldLamp;
  readonly hands: readonly PalmHand[];
  /** Puts the panel before the eyes. */
  summon(): void;
}

/** What the panel's tabs show, and what they do things with. */
export interface PanelContext {
  readonly viewer: Viewer;
  readonly actions: Actions;
  readonly marking: Marking;
  readonly host: PanelHost;
  readonly live: Follow;
  /** Changes what the viewer does not tell of. */
  set(change: () => void): void;
  /** Has the letters of texts drawn that are not the viewer's own. */
  spell(texts: readonly string[]): void;
}

/** Whether cut faces are drawn from the volume, where they are shown. */
export function isByVolume({ noSection, state }: Viewer): boolean {
  return !noSection && state.section === "volume";
}
