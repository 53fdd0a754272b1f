import { type Length, lengthsOf, lengthText, type Mark, type Marking, type Pin } from "../model/pins";
import { barLength, directionLetters, pointText, valueText } from "../model/values";
import { cameraAxes, viewDirection } from "../model/view";
import type { Viewer } from "../viewer";
import { h, icon, kIcons, svg } from "./dom";

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
  const { right, down } = cameraAxes(viewDirection(view.azimuth, view.elevation).negate());
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
 * What is said about faces over their picture: the value under the pointer, pins, lengths between them, and where faces
 * are grey, a scale bar, the window, and where in the patient the picture's edges are.
 */
export class FaceOverlay {
  readonly element: HTMLElement;
  readonly #viewer: Viewer;
  readonly #value = h("strong");
  readonly #point = h("span");
  readonly #readout: HTMLElement;
  readonly #pins = h("div", { role: "list", "aria-label": "Pins" });
  readonly #lines = svg("svg", { "aria-hidden": "true" });
  readonly #lengths = h("div", { role: "list", "aria-label": "Lengths" });
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
  /** Of what the next click on a face marks. */
  readonly buttons: HTMLElement;
  readonly #marking: Marking;
  #shownPins: readonly Pin[] = [];
  #shownLengths: readonly Length[] = [];
  #pointer: Place | null = null; // over the canvas, with no button pressed

  constructor(viewer: Viewer, marking: Marking) {
    this.#viewer = viewer;
    this.#marking = marking;
    this.#readout = h(
      "output",
      { class: "reading", "aria-label": "Value under the pointer", "aria-live": "off", hidden: true },
      this.#value,
      this.#point,
    );
    this.element = h(
      "div",
      { class: "overlay" },
      this.#marks,
      this.#lines,
      this.#lengths,
      this.#pins,
      this.#readout,
    );
    const marks: Record<Mark, HTMLButtonElement> = {
      pin: this.#button("pin", "Pin", "Mark a point of a face with its value (I)"),
      length: this.#button("length", "Measure", "Measure between two points of faces (L)"),
    };
    this.buttons = h("span", { class: "tools" }, marks.pin, marks.length);
    marking.changed = () => {
      viewer.canvas.classList.toggle("marking", marking.mark !== null);
      for (const [mark, button] of Object.entries(marks)) {
        button.setAttribute("aria-pressed", String(mark === marking.mark));
      }
    };
    const { canvas } = viewer;
    // Before other listeners: the click that marks a point does nothing else.
    canvas.addEventListener("pointerdown", (event) => {
      if (marking.mark && event.button === 0 && this.#markAt(this.#placeOf(event), marking.mark)) {
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

  /** Marks the point under the pointer, or else the one of the next click on a face. */
  mark(mark: Mark): void {
    const other = this.#marking.mark !== null && this.#marking.mark !== mark;
    if (other || !this.#pointer || !this.#markAt(this.#pointer, mark)) {
      this.#marking.toggle(mark);
    }
  }

  /** After every frame. */
  update(): void {
    this.#updateMarks();
    this.#updatePins();
    this.#updateLengths();
    this.#updateReadout();
  }

  #button(mark: Mark, text: string, title: string): HTMLButtonElement {
    return h(
      "button",
      { class: "small", title, "aria-pressed": "false", onclick: () => this.#marking.toggle(mark) },
      icon(kIcons[mark]),
      text,
    );
  }

  #placeOf(event: PointerEvent): Place {
    const box = this.#viewer.canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  /** Whether there was something to mark. */
  #markAt({ x, y }: Place, mark: Mark): boolean {
    const reading = this.#viewer.picking.readingAt(x, y);
    return reading !== null && this.#marking.put(reading.point, mark);
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
    const edges = kEdges.map((edge, i) => `${edge} ${letters[i]}`).join(", ");
    this.#marks.setAttribute("aria-label", `Directions of the patient: ${edges}. Scale bar: ${barMm} mm`);
    this.#window.textContent = window;
  }

  #updatePins(): void {
    const viewer = this.#viewer;
    const { pins, layers } = viewer.state;
    for (const marks of [this.#pins, this.#lines, this.#lengths]) {
      marks.toggleAttribute("hidden", !layers.marks);
    }
    if (pins !== this.#shownPins) {
      this.#shownPins = pins;
      this.#pins.replaceChildren(...pins.map((pin, i) => this.#pin(pin, i)));
      this.#shownLengths = lengthsOf(pins);
      this.#lengths.replaceChildren(
        ...this.#shownLengths.map((length) =>
          h("div", { class: "length", role: "listitem" }, lengthText(length)),
        ),
      );
      this.#lines.replaceChildren(...this.#shownLengths.map(() => svg("line")));
    }
    pins.forEach((pin, i) => {
      const mark = this.#pins.children[i] as HTMLElement;
      const at = viewer.camera.project(pin.point);
      mark.hidden = !at;
      mark.classList.toggle("faded", !viewer.picking.isSeen(pin.point));
      if (at) {
        mark.classList.toggle("left", at.x > viewer.camera.freeSize.width - kPinWidth);
        place(mark, at);
      }
    });
  }

  #updateLengths(): void {
    this.#shownLengths.forEach(({ from, to }, i) => {
      const [a, b] = [this.#viewer.camera.project(from), this.#viewer.camera.project(to)];
      const [line, text] = [this.#lines.children[i]!, this.#lengths.children[i] as HTMLElement];
      text.hidden = !a || !b;
      line.toggleAttribute("hidden", text.hidden);
      if (a && b) {
        [a, b].forEach(({ x, y }, end) => {
          line.setAttribute(`x${end + 1}`, x.toFixed(1));
          line.setAttribute(`y${end + 1}`, y.toFixed(1));
        });
        place(text, { x: 0.5 * (a.x + b.x), y: 0.5 * (a.y + b.y) });
      }
    });
  }

  #pin(pin: Pin, index: number): HTMLElement {
    const text = valueText(pin);
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
