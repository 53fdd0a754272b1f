import { barLength, directionLetters, pointText, type Reading, valueText } from "../model/values";
import { cameraAxes, viewDirection } from "../model/view";
import type { Viewer } from "../viewer";
import { h, icon, kIcons } from "./dom";

// No wider, CSS px.
const kReadoutWidth = 300;
const kPinWidth = 150;
/** Of the picture's width: the scale bar is no longer. */
const kBarShare = 0.25;
const kEdges = ["left", "right", "top", "bottom"] as const;

interface Place {
  x: number;
  y: number;
}

/**
 * What is said about faces over their picture: the value under the pointer, pins, and where faces are grey, a scale
 * bar, the window, and where in the patient the picture's edges are.
 */
export class FaceOverlay {
  readonly element: HTMLElement;
  readonly #viewer: Viewer;
  readonly #value = h("strong");
  readonly #point = h("span");
  readonly #readout: HTMLElement;
  readonly #pins = h("div", { role: "list", "aria-label": "Pins" });
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
  /** Makes the next click on a face put a pin there. */
  readonly button: HTMLButtonElement;
  #shownPins: readonly Reading[] = [];
  #pointer: Place | null = null; // over the canvas, with no button pressed

  constructor(viewer: Viewer) {
    this.#viewer = viewer;
    this.#readout = h(
      "output",
      { class: "reading", "aria-label": "Value under the pointer", "aria-live": "off", hidden: true },
      this.#value,
      this.#point,
    );
    this.element = h("div", { class: "overlay" }, this.#marks, this.#pins, this.#readout);
    this.button = h(
      "button",
      {
        class: "small",
        title: "Mark a point of a face with its value (I)",
        "aria-pressed": "false",
        onclick: () => this.#await(!this.#awaiting),
      },
      icon(kIcons.pin),
      "Pin",
    );
    const { canvas } = viewer;
    // Before other listeners: the click that puts a pin does nothing else.
    canvas.addEventListener("pointerdown", (event) => {
      if (this.#awaiting && event.button === 0 && this.#pinAt(this.#placeOf(event))) {
        event.stopImmediatePropagation();
      }
    });
    for (const type of ["pointermove", "pointerdown", "pointerup", "pointerleave"] as const) {
      canvas.addEventListener(type, (event) => {
        const over = event.buttons === 0 && type !== "pointerleave" && event.pointerType !== "touch";
        this.#pointer = over ? this.#placeOf(event) : null;
        this.#updateReadout();
      });
    }
  }

  /** Pins the point under the pointer, or else the one of the next click on a face. */
  pin(): void {
    if (!this.#pointer || !this.#pinAt(this.#pointer)) {
      this.#await(!this.#awaiting);
    }
  }

  /** No click is waited for any more. */
  cancel(): void {
    this.#await(false);
  }

  /** After every frame. */
  update(): void {
    this.#updateMarks();
    this.#updatePins();
    this.#updateReadout();
  }

  get #awaiting(): boolean {
    return this.button.getAttribute("aria-pressed") === "true";
  }

  #await(click: boolean): void {
    this.button.setAttribute("aria-pressed", String(click));
    this.#viewer.canvas.classList.toggle("pinning", click);
  }

  #placeOf(event: PointerEvent): Place {
    const box = this.#viewer.canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  /** Whether there was something to pin. */
  #pinAt({ x, y }: Place): boolean {
    const reading = this.#viewer.readingAt(x, y);
    const pinned = reading !== null && this.#viewer.addPin(reading.point);
    if (pinned) {
      this.#await(false);
    }
    return pinned;
  }

  #updateMarks(): void {
    const viewer = this.#viewer;
    const { grey, section, view } = viewer.state;
    const middle = grey > 0 && section === "volume" ? viewer.faceMiddle : null;
    const scale = middle && viewer.pixelsPerMm(middle);
    this.#marks.hidden = !scale;
    if (!scale) {
      return;
    }
    const { width, height } = viewer.freeSize;
    this.#marks.style.width = `${width}px`;
    this.#marks.style.height = `${height}px`;
    const { right, down } = cameraAxes(viewDirection(view.azimuth, view.elevation).negate());
    const [left, up] = [right.clone().negate(), down.clone().negate()];
    const letters = [left, right, up, down].map(directionLetters);
    letters.forEach((text, i) => (this.#letters[i]!.textContent = text));
    const { window } = viewer;
    const mm = barLength((kBarShare * width) / scale);
    this.#bar.style.width = `${(mm * scale).toFixed(1)}px`;
    this.#length.textContent = `${mm} mm`;
    const edges = kEdges.map((edge, i) => `${edge} ${letters[i]}`).join(", ");
    this.#marks.setAttribute("aria-label", `Directions of the patient: ${edges}. Scale bar: ${mm} mm`);
    this.#window.textContent = window ? `C ${window.center.toFixed(0)} W ${window.width.toFixed(0)}` : "";
  }

  #updatePins(): void {
    const viewer = this.#viewer;
    const { pins } = viewer.state;
    if (pins !== this.#shownPins) {
      this.#shownPins = pins;
      this.#pins.replaceChildren(...pins.map((pin, i) => this.#mark(pin, i)));
    }
    pins.forEach((pin, i) => {
      const mark = this.#pins.children[i] as HTMLElement;
      const at = viewer.project(pin.point);
      mark.hidden = !at;
      mark.classList.toggle("faded", !viewer.showsPin(pin));
      if (at) {
        mark.classList.toggle("left", at.x > viewer.freeSize.width - kPinWidth);
        place(mark, at);
      }
    });
  }

  #mark(pin: Reading, index: number): HTMLElement {
    const text = valueText(this.#viewer.section!, pin);
    const where = pointText(pin.point);
    return h(
      "div",
      { class: "pin", role: "listitem" },
      h("i"),
      h(
        "button",
        {
          title: `${where}: click to remove`,
          "aria-label": `Remove pin ${index + 1}: ${text} at ${where}`,
          onclick: () => this.#viewer.removePin(index),
        },
        text,
      ),
    );
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
