import { type ReadonlySignal, signal } from "@preact/signals-core";
import type { Vector3 } from "three";

import { orientationOf, planePosition } from "../model/planes";
import { projectOnto } from "../model/geometry";
import {
  depths,
  fittedTo,
  movedBySlices,
  planeOf,
  pointOf,
  scrollsInto,
  type SliceAxes,
  sliceAxes,
  type SliceFrame,
  type SliceKind,
} from "../model/slice";
import type { Place, Size } from "../model/label_layout";
import { drawSlice } from "../render/slice_pixels";
import { texts } from "../text/text";
import { follow, h } from "./dom";
import { SliceMarks } from "./slice_marks";
import { sliceOverlay } from "./slice_overlay";
import { SlicePointer } from "./slice_pointer";
import type { SliceContext } from "./slices";

/** Of the pane, what the volume fills at first. */
const kFilled = 0.94;
const kZoom = { least: 0.5, most: 30 };
const kMostPixelRatio = 2;

/** What of a slice is seen: larger than fitted, and moved from the middle, mm. */
interface SliceZoom {
  zoom: number;
  right: number;
  down: number;
}

const kFitted: SliceZoom = { zoom: 1, right: 0, down: 0 };

/** One slice of the volume, as sharp as the screen, and what is done in it. */
export class SlicePane {
  readonly element: HTMLElement;
  readonly context: SliceContext;
  readonly kind: SliceKind;
  /** What is shown; null: nothing, as of the plane where nothing is cut. */
  readonly frame: ReadonlySignal<SliceFrame | null>;
  /** Over the pane, with no button pressed. */
  readonly pointer = signal<Place | null>(null);
  readonly canvas: HTMLCanvasElement;
  readonly #size = signal<Size>({ width: 0, height: 0 });
  readonly #zoom = signal(kFitted);
  #pixels: ImageData | null = null;
  #isDue = false;

  /** Belongs to whoever makes it, as owned() says. */
  constructor(context: SliceContext, kind: SliceKind) {
    const { viewer, live } = context;
    this.context = context;
    this.kind = kind;
    this.frame = live(() => this.#frame);
    const t = texts().slices;
    const place = live(() => this.#placeText);
    const depth = live(() => this.#depths);
    this.canvas = h("canvas", {
      tabindex: "0",
      role: "slider",
      "aria-orientation": "vertical",
      "aria-label": live(() => t.slice(this.title)),
      "aria-valuemin": live(() => String(depth.value[0])),
      "aria-valuemax": live(() => String(depth.value[1])),
      "aria-valuenow": live(() => String(depth.value[2])),
      "aria-valuetext": place,
    });
    const marks = new SliceMarks(this);
    this.element = h(
      "div",
      { class: `slice ${kind}` },
      this.canvas,
      sliceOverlay(this, place),
      marks.element,
    );
    new SlicePointer(this);
    const section = live(() => viewer.section);
    const window = live(() => viewer.window);
    follow(() => {
      void [this.frame.value, section.value, window.value];
      this.#drawSoon();
    });
    follow(() => {
      const observer = new ResizeObserver(() => {
        // Whole px, so that those of the picture are the screen's.
        const { clientWidth: width, clientHeight: height } = this.element;
        Object.assign(this.canvas.style, { width: `${width}px`, height: `${height}px` });
        this.#size.value = { width, height };
      });
      observer.observe(this.element);
      return () => observer.disconnect();
    });
  }

  /** "Axial" */
  get title(): string {
    const t = texts();
    const { cut } = this.context.viewer;
    const orientation = this.kind === "plane" ? cut && orientationOf(cut) : this.kind;
    return orientation ? t.orientations[orientation] : t.plane.oblique;
  }

  get axes(): SliceAxes | null {
    return sliceAxes(this.kind, this.context.viewer.cut);
  }

  /** The crosshair in this slice: where it lies apart from the plane, its projection. */
  get at(): Vector3 | null {
    const { cut, state } = this.context.viewer;
    const at = state.slices?.at ?? null;
    return at && this.kind === "plane" && cut ? projectOnto(cut, at) : at;
  }

  /** Shows all of the slice. */
  fit(): void {
    this.#zoom.value = kFitted;
  }

  /** Shows this slice alone, or those of the body beside each other; the focus goes with it. */
  enlarge(alone: boolean): void {
    const { store } = this.context.viewer;
    const { kind } = this;
    if (alone || kind !== "plane") {
      store.showSlices(alone ? kind : "all");
      requestAnimationFrame(() => this.canvas.focus({ preventScroll: true }));
    }
  }

  /** Larger by a factor; what is at a place stays there. */
  zoomAt(place: Place, factor: number): void {
    const frame = this.frame.value;
    if (!frame) {
      return;
    }
    const { zoom, right, down } = this.#zoom.value;
    const to = Math.min(kZoom.most, Math.max(kZoom.least, zoom * factor));
    const share = (1 - zoom / to) / frame.scale;
    this.#zoom.value = {
      zoom: to,
      right: right + share * (place.x - 0.5 * frame.width),
      down: down + share * (place.y - 0.5 * frame.height),
    };
  }

  /** Moves what is seen by px. */
  pan(x: number, y: number): void {
    const frame = this.frame.value;
    if (frame) {
      const { zoom, right, down } = this.#zoom.value;
      this.#zoom.value = { zoom, right: right - x / frame.scale, down: down - y / frame.scale };
    }
  }

  /** To other slices, up or to the front: the crosshair goes with them, and the plane where it is linked or shown. */
  slide(slices: number): void {
    const { viewer, actions } = this.context;
    const { section, cut, store } = viewer;
    const { axes, at } = this;
    if (!section || !axes || !at) {
      return;
    }
    const ways = slices * scrollsInto(axes);
    const linked = store.state.slices!.linked;
    const isCuts = cut !== null && Math.abs(axes.into.dot(cut.normal)) > 0.9999;
    if (actions.isUniaxial && isCuts && (linked || this.kind === "plane")) {
      actions.step(ways * Math.sign(axes.into.dot(store.info!.states.axis)));
      return;
    }
    const to = movedBySlices(section, axes, at, ways);
    if (this.kind === "plane" && !linked && cut) {
      store.movePlane({ normal: cut.normal, offset: cut.normal.dot(to) });
    } else {
      store.setCrosshair(to);
    }
  }

  /** Puts the crosshair there. */
  point(place: Place): void {
    const frame = this.frame.value;
    if (frame) {
      this.context.viewer.store.setCrosshair(pointOf(frame, place));
    }
  }

  /** Marks what is there. Returns whether there was something to mark. */
  mark(point: Vector3, kind = this.context.marking.kind ?? "point"): boolean {
    const frame = this.frame.value;
    return frame !== null && this.context.marking.put({ point, plane: planeOf(frame) }, kind);
  }

  get #frame(): SliceFrame | null {
    const { section, state } = this.context.viewer;
    const { width, height } = this.#size.value;
    const { zoom, right, down } = this.#zoom.value;
    const { axes, at } = this;
    if (!state.slices || !section || !axes || !at || width === 0) {
      return null;
    }
    const { middle, scale } = fittedTo(section, axes, at, { width, height });
    middle.addScaledVector(axes.right, right).addScaledVector(axes.down, down);
    return { axes, middle, scale: kFilled * zoom * scale, width, height };
  }

  /** Where the slice is: "S 12.3 mm". */
  get #placeText(): string {
    const { axes, at } = this;
    return axes && at ? planePosition(planeOf({ axes, middle: at })) : texts().cut.nothing;
  }

  /** From where to where slices are, and where this one is, in the direction that keys go: mm. */
  get #depths(): [number, number, number] {
    const { section } = this.context.viewer;
    const { axes, at } = this;
    if (!section || !axes || !at) {
      return [0, 0, 0];
    }
    const up = axes.into.clone().multiplyScalar(scrollsInto(axes));
    const [first, last] = depths(section, up);
    return [Math.floor(first), Math.ceil(last), Math.round(up.dot(at))];
  }

  /** Once a frame is enough. */
  #drawSoon(): void {
    if (!this.#isDue) {
      this.#isDue = true;
      requestAnimationFrame(() => {
        this.#isDue = false;
        this.#draw();
      });
    }
  }

  #draw(): void {
    const { section, window } = this.context.viewer;
    const frame = this.frame.value;
    const { width: across, height: along } = this.#size.value;
    const ratio = Math.min(kMostPixelRatio, devicePixelRatio);
    const [width, height] = [Math.round(ratio * across), Math.round(ratio * along)];
    if (width < 1 || height < 1) {
      return;
    }
    const { canvas } = this;
    if (this.#pixels?.width !== width || this.#pixels.height !== height) {
      Object.assign(canvas, { width, height });
      this.#pixels = new ImageData(width, height);
    } else {
      this.#pixels.data.fill(0);
    }
    if (frame && section) {
      const scale = (frame.scale * width) / frame.width;
      drawSlice(section, window, { ...frame, scale, width, height }, this.#pixels.data);
    }
    canvas.getContext("2d")!.putImageData(this.#pixels, 0, 0);
  }
}
