import { pointText, valueText } from "../model/values";
import type { Viewer } from "../viewer";
import { h } from "./dom";

const kReadoutWidth = 300; // no wider, CSS px

interface Place {
  x: number;
  y: number;
}

/** What is said about faces over their picture: the value under the pointer. */
export class FaceOverlay {
  readonly element: HTMLElement;
  readonly #viewer: Viewer;
  readonly #value = h("strong");
  readonly #point = h("span");
  readonly #readout: HTMLElement;
  #pointer: Place | null = null; // over the canvas, with no button pressed

  constructor(viewer: Viewer) {
    this.#viewer = viewer;
    this.#readout = h(
      "output",
      { class: "reading", "aria-label": "Value under the pointer", "aria-live": "off", hidden: true },
      this.#value,
      this.#point,
    );
    this.element = h("div", { class: "overlay" }, this.#readout);
    const { canvas } = viewer;
    for (const type of ["pointermove", "pointerdown", "pointerup", "pointerleave"] as const) {
      canvas.addEventListener(type, (event) => {
        const box = canvas.getBoundingClientRect();
        const over = event.buttons === 0 && type !== "pointerleave" && event.pointerType !== "touch";
        this.#pointer = over ? { x: event.clientX - box.left, y: event.clientY - box.top } : null;
        this.#updateReadout();
      });
    }
  }

  /** After every frame. */
  update(): void {
    this.#updateReadout();
  }

  #updateReadout(): void {
    const viewer = this.#viewer;
    const at = this.#pointer;
    const reading = at && viewer.readingAt(at.x, at.y);
    this.#readout.hidden = !reading;
    if (reading) {
      this.#value.textContent = valueText(viewer.section!, reading);
      this.#point.textContent = pointText(reading.point);
      this.#readout.classList.toggle("left", at.x > viewer.freeSize.width - kReadoutWidth);
      place(this.#readout, at);
    }
  }
}

function place(element: HTMLElement, { x, y }: Place): void {
  element.style.translate = `${x.toFixed(1)}px ${y.toFixed(1)}px`;
}
