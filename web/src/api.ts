import { Vector3 } from "three";

import type { App } from "./app";
import { type Cut, makeCut } from "./model/cut";
import type { FaceSource } from "./model/faces";
import type { Plane, Triple } from "./model/geometry";
import type { Window } from "./model/grey";
import type { Layers } from "./model/layers";
import { lengthsOf } from "./model/pins";
import type { Mode, PlaneStates } from "./model/states";
import { valueText } from "./model/values";
import type { Picture } from "./render/splat_layer";
import type { ViewerStats } from "./viewer";
import type { ClipOperator } from "./worker/protocol";
import type { Effort } from "./xr/governor";
import type { EyePicture, Surroundings } from "./xr/headset";

/** Keeps dot(normal, x) >= offset, and of a slab no more than `thickness` mm beyond it. */
export interface ApiCut {
  normal: Triple;
  offset: number;
  thickness?: number;
}

/** `window.clipgs`: the viewer for scripts of the page that holds it. Patient space (RAS mm) throughout. */
export interface ClipgsApi {
  /** Resolves when the case that the address names has been drawn; rejects with a line for a person. */
  readonly ready: Promise<void>;
  /** Shows another case of the server, by name. */
  open(name: string): Promise<void>;
  setView(view: { azimuth: number; elevation: number; zoom?: number }): void;
  /** Cuts with one plane that keeps dot(normal, x) >= offset; null: nothing is cut. */
  setPlane(plane: { normal: Triple; offset: number } | null): void;
  /** What all cuts keep is shown; `active` is the one that the page moves. False, and nothing changes, for more than
   * six planes, of which a slab has two. */
  setCuts(cuts: readonly ApiCut[], active?: number): boolean;
  /** How the plane moves. In the uniaxial mode one plane is left, at the state nearest to it, and so is every plane
   * that is set then. */
  setMode(mode: Mode): void;
  /** Shows a state, from 0, in the uniaxial mode; false, and nothing changes, where the case has no such state. */
  setState(state: number): boolean;
  /** Of the case: state k's plane is dot(axis, x) = first + k · spacing and keeps one side of it. */
  readonly states: (Omit<PlaneStates, "axis"> & { axis: Triple }) | null;
  setClip(clip: ClipOperator): void;
  /** What cut faces are drawn from; a case without a section volume draws them by its splats. */
  setSection(section: FaceSource): void;
  /** How faces drawn from the volume look: 0 cinematic … 1 grey values through the window. */
  setGrey(grey: number): void;
  /** Values from center − width/2 (black) to center + width/2 (white); null: the case's own. */
  setWindow(window: Window | null): void;
  /** What of the case is shown. The body is left out only where faces of a cut are drawn from the volume. */
  setLayers(layers: Partial<Layers>): void;
  /** Marks a point with its value, 20 of them at most, and measures from the pin before it where it is `joined`; false
   * where there is no value: outside and in air. */
  addPin(point: Triple, joined?: boolean): boolean;
  /** By its index in `pins`. */
  removePin(index: number): void;
  /** What is marked, the oldest first, with `text` as the page shows it. */
  readonly pins: { point: Triple; value: number; error: number; text: string; joined: boolean }[];
  /** What is measured between pins, mm. */
  readonly lengths: { from: Triple; to: Triple; mm: number }[];
  /** Of the case, RAS mm. */
  readonly bounds: { min: Triple; max: Triple } | null;
  /** What is shown. */
  readonly state: {
    case: string | null;
    view: { azimuth: number; elevation: number; zoom: number };
    /** The active one of `cuts`. */
    plane: { normal: Triple; offset: number } | null;
    cuts: ApiCut[];
    mode: Mode;
    /** Null in the arbitrary mode and where nothing is cut. */
    state: number | null;
    clip: ClipOperator;
    section: FaceSource;
    grey: number;
    window: Window | null;
    layers: Layers;
  };
  readonly stats: Readonly<ViewerStats>;
  /** Whether resolution is given up where frames would come late, while something moves. */
  steady: boolean;
  /** The picture alone, as `clipgs render` writes it; `moving`: as it is drawn while something moves. */
  renderToPixels(width: number, height: number, moving?: boolean): Promise<Picture>;
  /** The case in a headset. Entering rejects with a line for a person, and needs a click of the user's. */
  readonly headset: {
    readonly worn: boolean;
    enter(surroundings?: Surroundings): Promise<void>;
    leave(): Promise<void>;
    /** Of the case, 1: life size. */
    readonly scale: number;
    /** What the eyes see of the case in the next frame. */
    capture(): Promise<EyePicture[]>;
    /** Whether less is drawn where frames would come late. */
    steady: boolean;
    /** What is drawn of the case now: all is {scale: 1, extent: Infinity, leastPixels: 0}. */
    readonly effort: Effort;
    /** What its panel says of a case that could not be opened, or nothing. */
    readonly message: string;
    /** Where a text of its panel is in the room, m; null: it is not shown. */
    find(text: string): Triple | null;
  };
  /** Where a point appears on the page, CSS px; null behind the camera. */
  project(point: Triple): { x: number; y: number } | null;
}

declare global {
  interface Window {
    clipgs: ClipgsApi;
  }
}

function unitCut({ normal, offset, thickness }: ApiCut): Cut {
  return makeCut(new Vector3(...normal), offset, thickness ?? null);
}

function apiPlane({ normal, offset }: Plane): { normal: Triple; offset: number } {
  return { normal: normal.toArray(), offset };
}

export function makeApi(app: App, ready: Promise<void>): ClipgsApi {
  const { viewer, headset } = app;
  return {
    ready,
    stats: viewer.stats,
    get steady() {
      return viewer.steady;
    },
    set steady(steady) {
      viewer.steady = steady;
    },
    open: (name) => app.open(name),
    setView: ({ azimuth, elevation, zoom = 1 }) =>
      viewer.setView({ azimuth, elevation, zoom, pan: new Vector3() }),
    setPlane: (plane) => {
      viewer.setCuts(plane ? [unitCut(plane)] : []);
    },
    setCuts: (cuts, active) => viewer.setCuts(cuts.map(unitCut), active),
    setMode: (mode) => viewer.setMode(mode),
    setState: (state) => viewer.setPlaneState(state),
    get states() {
      const { states } = viewer;
      return states && { ...states, axis: states.axis.toArray() };
    },
    setClip: (clip) => viewer.setClip(clip),
    setSection: (section) => viewer.setSection(section),
    setGrey: (grey) => viewer.setGrey(Math.min(1, Math.max(0, grey))),
    setWindow: (window) => viewer.setWindow(window && { ...window }),
    setLayers: (layers) => viewer.setLayers(layers),
    addPin: (point, joined) => viewer.addPin(new Vector3(...point), joined),
    removePin: (index) => viewer.removePin(index),
    get bounds() {
      const bounds = viewer.info?.bounds;
      return bounds ? { min: bounds.min.toArray(), max: bounds.max.toArray() } : null;
    },
    get pins() {
      return viewer.state.pins.map((pin) => ({
        point: pin.point.toArray(),
        value: pin.value,
        error: pin.error,
        text: valueText(viewer.section!, pin),
        joined: pin.joined,
      }));
    },
    get lengths() {
      return lengthsOf(viewer.state.pins).map(({ from, to, mm }) => ({
        from: from.toArray(),
        to: to.toArray(),
        mm,
      }));
    },
    get state() {
      const { view, mode, cuts, clip, section, grey, layers } = viewer.state;
      return {
        case: viewer.caseName,
        view: { azimuth: view.azimuth, elevation: view.elevation, zoom: view.zoom },
        plane: viewer.cut && apiPlane(viewer.cut),
        cuts: cuts.map((cut) => ({
          ...apiPlane(cut),
          ...(cut.thickness === null ? {} : { thickness: cut.thickness }),
        })),
        mode,
        state: viewer.planeState,
        clip,
        section,
        grey,
        window: viewer.window,
        layers: { ...layers },
      };
    },
    renderToPixels: (width, height, moving) => viewer.renderToPixels(width, height, moving),
    headset: {
      get worn() {
        return headset.worn;
      },
      enter: (surroundings = "immersive-vr") => headset.enter(surroundings),
      leave: () => headset.leave(),
      get scale() {
        return headset.stage.scale;
      },
      capture: () => headset.capture(),
      get steady() {
        return headset.governor.enabled;
      },
      set steady(steady) {
        headset.governor.enabled = steady;
      },
      get effort() {
        return headset.governor.effort;
      },
      get message() {
        return headset.panel?.message ?? "";
      },
      find: (text) => headset.panel?.find(text)?.toArray() ?? null,
    },
    project: (point) => {
      const at = viewer.project(new Vector3(...point));
      const box = viewer.canvas.getBoundingClientRect();
      return at && { x: at.x + box.left, y: at.y + box.top };
    },
  };
}
