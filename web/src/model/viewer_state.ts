import { batch, signal } from "@preact/signals-core";
import { Vector3 } from "three";

import type { ClipOperator } from "../worker/protocol";
import { kBackdrops } from "./backdrop";
import { type CaseInfo, isSameVolume } from "./case_info";
import { canDraw, type Cut } from "./cut";
import type { GreyOpenings } from "./face_style";
import type { FaceSource } from "./faces";
import { type Plane, projectOnto, signedDistance, type Triple } from "./geometry";
import type { Window } from "./grey";
import { kAllLayers, type Layers } from "./layers";
import { type Mark, withMark, withoutMark, withWords } from "./marks";
import { kRigs, type Lighting } from "./rigs";
import type { SliceChoice, Slices } from "./slice";
import { type Mode, nearestState, type PlaneStates, stateCut } from "./states";
import type { Stop } from "./tour";
import { reframed, type View, viewFrom } from "./view";

/** How a case is cut, and how its faces look. */
export interface Style extends Lighting {
  cuts: readonly Cut[];
  clip: ClipOperator;
  section: FaceSource;
  grey: number; // 0 cinematic … 1 grey
  openings: GreyOpenings; // in grey faces
  layers: Layers;
  depthCue: number; // how much what is far away fades, 0 … 1
}

/** All that is chosen of what is shown. */
export interface ViewerState extends Style {
  view: View;
  mode: Mode; // uniaxial: no more than one plane, which is that of a state
  active: number; // the cut that is moved, by its index
  window: Window | null; // of grey values; null: the case's own
  handle: boolean; // whether the plane is drawn
  marks: readonly Mark[]; // the oldest first
  tourMarks: readonly Mark[] | null; // that are shown in place of these: those of a tour's stop
  stops: readonly Stop[]; // of the tour: the views that were saved
  backdrop: string | null; // what lies behind the case, one of kBackdrops; null: as the page is
  slices: Slices | null; // beside the picture; null: none
}

/** Of a style, what is chosen of faces, splats and lights. */
export const kChosenLook = [
  "clip",
  "section",
  "grey",
  "openings",
  "rig",
  "turn",
  "lamp",
] as const satisfies readonly (keyof Style)[];

/** A crosshair that is nearer to the cut lies in it, mm. */
const kInCut = 1e-6;

export const kFirst: ViewerState = {
  view: viewFrom(0, 0),
  mode: "arbitrary",
  cuts: [],
  active: 0,
  clip: "exact",
  section: "volume",
  grey: 0,
  openings: "cinematic",
  rig: null,
  turn: 0,
  lamp: null,
  window: null,
  handle: true,
  layers: kAllLayers,
  depthCue: 0,
  marks: [],
  tourMarks: null,
  stops: [],
  backdrop: null,
  slices: null,
};

/** The cut that is moved; null: nothing is cut. */
export function activeCut({ cuts, active }: Pick<ViewerState, "cuts" | "active">): Cut | null {
  return cuts[active] ?? null;
}

/** The marks that are seen. */
export function shownMarks({ marks, tourMarks }: ViewerState): readonly Mark[] {
  return tourMarks ?? marks;
}

/** Beside, or over, the picture. */
const kNotPictured: readonly (keyof ViewerState)[] = ["marks", "tourMarks", "stops", "slices"];

/** Whether what differs lies over the picture, which stays as it is. */
export function isSamePicture(a: ViewerState, b: ViewerState): boolean {
  const keys = Object.keys(a) as (keyof ViewerState)[];
  return keys.every((key) => kNotPictured.includes(key) || a[key] === b[key]);
}

/**
 * What is shown, and of which case: the one place that says so. Pictures and panels follow it: what is read of it within
 * an effect or a computed signal is read again when it changes. Patient space (RAS mm) throughout.
 */
export class ViewerStore {
  readonly #state = signal(kFirst);
  readonly #info = signal<CaseInfo | null>(null);

  /** Never changed, but replaced. */
  get state(): ViewerState {
    return this.#state.value;
  }

  /** Of the case that is shown. */
  get info(): CaseInfo | null {
    return this.#info.value;
  }

  /**
   * Of another case, or none. The view and plane stay, and of another look of the same volume the camera itself, the
   * window and the marks, too.
   */
  setCase(info: CaseInfo | null): void {
    batch(() => {
      const before = this.#info.peek();
      this.#info.value = info;
      if (info && before && isSameVolume(before, info)) {
        this.#set({ view: reframed(this.#state.peek().view, before.sphere, info.sphere) });
      } else if (info) {
        this.#set({ window: null, marks: [], tourMarks: null, stops: [] });
        this.showSlices(this.#state.peek().slices?.shown ?? null, { at: boxMiddle(info) });
      }
      this.#keepToStates();
    });
  }

  setView(view: Partial<View>): void {
    this.#set({ view: { ...this.#state.peek().view, ...view } });
  }

  /** The cut that is moved; null: nothing is cut. */
  get cut(): Cut | null {
    return activeCut(this.state);
  }

  /** The states of the uniaxial mode. */
  get states(): PlaneStates | null {
    return this.info?.states ?? null;
  }

  /** The state that is shown; null in the arbitrary mode and where nothing is cut. */
  get planeState(): number | null {
    const { info, cut } = this;
    const isState = this.state.mode === "uniaxial" && info && cut;
    return isState ? nearestState(info.states, cut, info.sphere.center) : null;
  }

  setMode(mode: Mode): void {
    batch(() => {
      this.#set({ mode });
      this.#keepToStates();
    });
  }

  /** Shows a state in the uniaxial mode; returns whether the case has it, nothing changes otherwise. */
  setPlaneState(state: number): boolean {
    const { states } = this;
    const possible = states !== null && Number.isInteger(state) && state >= 0 && state < states.count;
    if (possible) {
      this.#set({ mode: "uniaxial", cuts: [stateCut(states, state)], active: 0 });
    }
    return possible;
  }

  /** Returns whether there are no more planes than can be drawn; nothing changes otherwise. */
  setCuts(cuts: readonly Cut[], active = 0): boolean {
    const possible = canDraw(cuts);
    if (possible) {
      batch(() => {
        this.#set({ cuts, active: Math.max(0, Math.min(active, cuts.length - 1)) });
        this.#keepToStates();
      });
    }
    return possible;
  }

  /** Moves the active cut; a slab keeps its thickness. */
  movePlane({ normal, offset }: Plane): void {
    const { cuts, active } = this.#state.peek();
    this.setCuts(
      cuts.map((cut, i) => (i === active ? { ...cut, normal, offset } : cut)),
      active,
    );
  }

  setClip(clip: ClipOperator): void {
    this.#set({ clip });
  }

  setSection(section: FaceSource): void {
    this.#set({ section });
  }

  setGrey(grey: number): void {
    this.#set({ grey });
  }

  /** What grey shows in gaps of a face that the window has black. */
  setOpenings(openings: GreyOpenings): void {
    this.#set({ openings });
  }

  /** Lights by one of kRigs; null: by those that the case was made in. Returns whether there is such a rig. */
  setRig(rig: string | null): boolean {
    const possible = rig === null || kRigs.has(rig);
    if (possible) {
      this.#set({ rig });
    }
    return possible;
  }

  /** Turns the lights about the patient's long axis by degrees, counterclockwise seen from the head. */
  setTurn(turn: number): void {
    this.#set({ turn });
  }

  /** A lamp instead of the rig's, that shines from a direction (RAS); null: none. */
  setLamp(from: Triple | null): void {
    this.#set({ lamp: from && new Vector3(...from).normalize().toArray() });
  }

  /** null: the window that the case's values suggest. */
  setWindow(window: Window | null): void {
    this.#set({ window });
  }

  setHandle(handle: boolean): void {
    this.#set({ handle });
  }

  setLayers(layers: Partial<Layers>): void {
    this.#set({ layers: { ...this.#state.peek().layers, ...layers } });
  }

  setMarks(marks: readonly Mark[]): void {
    this.#setMarks(marks);
  }

  setStops(stops: readonly Stop[]): void {
    this.#set({ stops });
  }

  /** Marks that were hidden are shown again. Returns whether it is one more: not where there are too many. */
  addMark(mark: Mark): boolean {
    const { marks, layers } = this.#state.peek();
    const more = withMark(marks, mark);
    if (more) {
      this.#set({ marks: more, tourMarks: null, layers: { ...layers, marks: true } });
    }
    return more !== null;
  }

  removeMark(id: string): void {
    this.#setMarks(withoutMark(this.#state.peek().marks, id));
  }

  /** What is said of a mark. */
  setWords(id: string, words: Partial<Pick<Mark, "name" | "note">>): void {
    this.#setMarks(withWords(this.#state.peek().marks, id, words));
  }

  /** What lies behind the case: one of kBackdrops; null: as the page is. Returns whether there is such a one. */
  setBackdrop(backdrop: string | null): boolean {
    const possible = backdrop === null || kBackdrops.has(backdrop);
    if (possible) {
      this.#set({ backdrop });
    }
    return possible;
  }

  /** How much what is far away fades towards what lies behind the case, 0 … 1. */
  setDepthCue(strength: number): void {
    this.#set({ depthCue: Math.min(1, Math.max(0, strength)) });
  }

  /** Shows slices beside the picture; null: none. The crosshair and its link stay unless it is said what they are. */
  showSlices(shown: SliceChoice | null, { at, linked }: Partial<Omit<Slices, "shown">> = {}): void {
    const { slices } = this.#state.peek();
    const info = this.#info.peek();
    const point = at ?? slices?.at ?? (info ? boxMiddle(info) : new Vector3());
    this.#set({ slices: shown && { shown, at: point, linked: linked ?? slices?.linked ?? true } });
  }

  /** Moves the crosshair of the slices, and with it the active cut where that is linked. */
  setCrosshair(at: Vector3): void {
    const { slices } = this.#state.peek();
    const { cut } = this;
    if (!slices) {
      return;
    }
    batch(() => {
      this.#set({ slices: { ...slices, at, linked: false } });
      if (slices.linked && cut) {
        this.movePlane({ normal: cut.normal, offset: cut.normal.dot(at) });
      }
      this.linkSlices(slices.linked);
    });
  }

  /** Whether the active cut goes through the crosshair of the slices, whatever moves either. */
  linkSlices(linked: boolean): void {
    const { slices } = this.#state.peek();
    this.#set({ slices: slices && { ...slices, linked } });
  }

  /** As it was, or is to be. */
  restore(part: Partial<ViewerState>): void {
    this.#set(part);
  }

  /** Whoever changes marks sees them. */
  #setMarks(marks: readonly Mark[]): void {
    this.#set({ marks, tourMarks: null });
  }

  #set(part: Partial<ViewerState>): void {
    this.#state.value = withCrosshair({ ...this.#state.peek(), ...part });
  }

  /** Of what is cut, the uniaxial mode keeps the active plane, at the nearest state. */
  #keepToStates(): void {
    const { planeState, states } = this;
    if (states && planeState !== null) {
      this.#set({ cuts: [stateCut(states, planeState)], active: 0 });
    }
  }
}

function boxMiddle({ bounds: { min, max } }: CaseInfo): Vector3 {
  return new Vector3().addVectors(min, max).multiplyScalar(0.5);
}

/** The crosshair of linked slices follows the active cut. */
function withCrosshair(state: ViewerState): ViewerState {
  const { slices } = state;
  const cut = activeCut(state);
  const follows = slices?.linked && cut && Math.abs(signedDistance(cut, slices.at)) > kInCut;
  return follows ? { ...state, slices: { ...slices, at: projectOnto(cut, slices.at) } } : state;
}
