import { barLength, directionLetters, pointText, valueText } from "../model/values";
import { viewAxes } from "../model/view";
import { texts } from "../text/text";
import type { Viewer } from "../viewer";
import { h } from "./dom";
import { placeOn } from "./place";

// No wider, CSS px.
const kReadoutWidth = 300;
/** Of the picture's width: the scale bar is no longer. */
const kBarShare = 0.25;
const kEdges = ["left", "right", "top", "bottom"] as const;

interface Place {
  x: number;
  y: number;
}

/** What is said around grey faces. */
export interface FaceMarks {
  /** Where in the patient the picture's edges are, in the order of kEdges. */
  letters: [string, string, string, string];
  /** Of the scale bar. */
  barMm: number;
  barWidth: number; // CSS px
  window: string;
}

/** Null where no face is grey. */
export function faceMarks(viewer: Viewer): FaceMarks | null {
  const { grey, section, view } = viewer.state;
  const middle = grey > 0 && section === "volume" ? viewer.picking.faceMiddle : null;
  const scale = middle && viewer.camera.pixelsPerMm(middle);
  if (!scale) {
    return null;
  }
  const { right, down } = viewAxes(view);
  const [left, up] = [right.clone().negate(), down.clone().negate()];
  const barMm = barLength((kBarShare * viewer.camera.freeSize.width) / scale);
  const { window } = viewer;
  return {
    letters: [directionLetters(left), directionLetters(right), directionLetters(up), directionLetters(down)],
    barMm,
    barWidth: barMm * scale,
    window: window ? `C ${window.center.toFixed(0)} W ${window.width.toFixed(0)}` : "",
  };
}

/**
 * What is said about faces over their picture: the value under the pointer, and where faces are grey, a scale bar, the
 * window, and where in the patient the picture's edges are.
 */
export class FaceOverlay {
  readonly element: HTMLElement;
  readonly #viewer: Viewer;
  readonly #value = h("strong");
  readonly #point = h("span");
  readonly #readout: HTMLElement;
  readonly #letters = kEdges.map((edge) => h("span", { class: edge }));
  readonly #bar = h("i");
  readonly #length = h("span");
  readonly #window = h("span");
  readonly #marks = h(
    "div",
    { class: "marks", role: "img", hidden: true },
    ...this.#letters,
    h("div", { class: "scale" }, this.#window, this.#length, this.#bar),
  );
  #pointer: Place | null = null; // over the canvas, with no button pressed

  constructor(viewer: Viewer) {
    this.#viewer = viewer;
    this.#readout = h(
      "output",
      { class: "reading", "aria-label": texts().page.valueHere, "aria-live": "off", hidden: true },
      this.#value,
      this.#point,
    );
    this.element = h("div", { class: "overlay" }, this.#marks, this.#readout);
    const { canvas } = viewer;
    for (const type of ["pointermove", "pointerdown", "pointerup", "pointerleave"] as const) {
      canvas.addEventListener(type, (event) => {
        const over = event.buttons === 0 && type !== "pointerleave" && event.pointerType !== "touch";
        this.#pointer = over ? placeOn(this.#viewer.canvas, event) : null;
        this.#updateReadout();
      });
    }
  }

  /** After every frame. */
  update(): void {
    this.#updateMarks();
    this.#updateReadout();
  }

  #updateMarks(): void {
    const marks = faceMarks(this.#viewer);
    this.#marks.hidden = !marks;
    if (!marks) {
      return;
    }
    const { letters, barMm, barWidth, window } = marks;
    const { width, height } = this.#viewer.camera.freeSize;
    this.#marks.style.width = `${width}px`;
    this.#marks.style.height = `${height}px`;
    letters.forEach((text, i) => (this.#letters[i]!.textContent = text));
    this.#bar.style.width = `${barWidth.toFixed(1)}px`;
    this.#length.textContent = `${barMm} mm`;
    this.#marks.setAttribute("aria-label", texts().page.directions(...letters, barMm));
    this.#window.textContent = window;
  }

  #updateReadout(): void {
    const viewer = this.#viewer;
    const at = this.#pointer;
    const reading = at && viewer.picking.readingAt(at.x, at.y);
    this.#readout.hidden = !reading;
    if (reading) {
      this.#value.textContent = valueText(reading);
      this.#point.textContent = pointText(reading.point);
      this.#readout.classList.toggle("left", at.x > viewer.camera.freeSize.width - kReadoutWidth);
      place(this.#readout, at);
    }
  }
}

function place(element: HTMLElement, { x, y }: Place): void {
  element.style.translate = `${x.toFixed(1)}px ${y.toFixed(1)}px`;
}
