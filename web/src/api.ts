import { Vector3 } from "three";

import type { App } from "./app";
import type { FaceSource } from "./model/faces";
import type { Triple } from "./model/geometry";
import type { Window } from "./model/grey";
import { valueText } from "./model/values";
import type { Picture } from "./render/splat_layer";
import type { ViewerStats } from "./viewer";
import type { ClipOperator } from "./worker/protocol";

/** `window.clipgs`: the viewer for scripts of the page that holds it. Patient space (RAS mm) throughout. */
export interface ClipgsApi {
  /** Resolves when the case that the address names has been drawn; rejects with a line for a person. */
  readonly ready: Promise<void>;
  /** Shows another case of the server, by name. */
  open(name: string): Promise<void>;
  setView(view: { azimuth: number; elevation: number; zoom?: number }): void;
  /** Keeps dot(normal, x) >= offset; null: nothing is cut. */
  setPlane(plane: { normal: Triple; offset: number } | null): void;
  setClip(clip: ClipOperator): void;
  /** What cut faces are drawn from; a case without a section volume draws them by its splats. */
  setSection(section: FaceSource): void;
  /** How faces drawn from the volume look: 0 cinematic … 1 grey values through the window. */
  setGrey(grey: number): void;
  /** Values from center − width/2 (black) to center + width/2 (white); null: the case's own. */
  setWindow(window: Window | null): void;
  /** Marks a point with its value, 20 of them at most; false where there is none: outside and in air. */
  addPin(point: Triple): boolean;
  /** By its index in `pins`. */
  removePin(index: number): void;
  /** What is marked, the oldest first, with `text` as the page shows it. */
  readonly pins: { point: Triple; value: number; error: number; text: string }[];
  /** What is shown. */
  readonly state: {
    case: string | null;
    view: { azimuth: number; elevation: number; zoom: number };
    plane: { normal: Triple; offset: number } | null;
    clip: ClipOperator;
    section: FaceSource;
    grey: number;
    window: Window | null;
  };
  readonly stats: Readonly<ViewerStats>;
  /** The picture alone, as `clipgs render` writes it. */
  renderToPixels(width: number, height: number): Promise<Picture>;
  /** Where a point appears on the page, CSS px; null behind the camera. */
  project(point: Triple): { x: number; y: number } | null;
}

declare global {
  interface Window {
    clipgs: ClipgsApi;
  }
}

export function makeApi(app: App, ready: Promise<void>): ClipgsApi {
  const { viewer } = app;
  return {
    ready,
    stats: viewer.stats,
    open: (name) => app.open(name),
    setView: ({ azimuth, elevation, zoom = 1 }) =>
      viewer.setView({ azimuth, elevation, zoom, pan: new Vector3() }),
    setPlane: (plane) => {
      if (plane) {
        const normal = new Vector3(...plane.normal);
        const length = normal.length();
        viewer.setPlane({ normal: normal.divideScalar(length), offset: plane.offset / length });
      } else {
        viewer.setPlane(null);
      }
    },
    setClip: (clip) => viewer.setClip(clip),
    setSection: (section) => viewer.setSection(section),
    setGrey: (grey) => viewer.setGrey(Math.min(1, Math.max(0, grey))),
    setWindow: (window) => viewer.setWindow(window && { ...window }),
    addPin: (point) => viewer.addPin(new Vector3(...point)),
    removePin: (index) => viewer.removePin(index),
    get pins() {
      return viewer.state.pins.map((pin) => ({
        point: pin.point.toArray(),
        value: pin.value,
        error: pin.error,
        text: valueText(viewer.section!, pin),
      }));
    },
    get state() {
      const { view, plane, clip, section, grey } = viewer.state;
      return {
        case: viewer.caseName,
        view: { azimuth: view.azimuth, elevation: view.elevation, zoom: view.zoom },
        plane: plane && { normal: plane.normal.toArray(), offset: plane.offset },
        clip,
        section,
        grey,
        window: viewer.window,
      };
    },
    renderToPixels: (width, height) => viewer.renderToPixels(width, height),
    project: (point) => {
      const at = viewer.project(new Vector3(...point));
      const box = viewer.canvas.getBoundingClientRect();
      return at && { x: at.x + box.left, y: at.y + box.top };
    },
  };
}
