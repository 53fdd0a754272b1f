import { signedDistance } from "../model/geometry";
import { layOut } from "../model/label_layout";
import { anchorOf, isLine, linesOf, type Mark } from "../model/marks";
import { shownMarks } from "../model/viewer_state";
import { placeOf, planeOf, pointOf, type SliceFrame, sliceSpacing } from "../model/slice";
import { each, follow, h, svg } from "./dom";
import { begunText, pathOf } from "./marks_overlay";
import type { SlicePane } from "./slice_pane";

/** Half a slice is as far as a mark may lie from it, of slices. */
const kReach = 0.5;

/** Marks that lie in a slice, with labels that choose them, and what is begun. */
export class SliceMarks {
  readonly element: HTMLElement;
  readonly #pane: SlicePane;
  readonly #labels = new WeakMap<Mark, HTMLElement>();
  readonly #drawing = svg("svg", { "aria-hidden": "true" });
  readonly #begun = svg("path", { class: "begun" });
  readonly #begunText = h("div", { class: "mark-label begun", hidden: true });

  /** Belongs to whoever makes it, as owned() says. */
  constructor(pane: SlicePane) {
    this.#pane = pane;
    const { viewer, live, marking, marks } = pane.context;
    const there = live(() => this.#there);
    const labels = h("div", { role: "list", "aria-label": pane.title });
    each(labels, there, (mark) => this.#label(mark));
    this.element = h("div", { class: "slice-marks" }, this.#drawing, labels, this.#begunText);
    follow(() => {
      const frame = pane.frame.value;
      void [marks.chosen.value, shownMarks(viewer.state)];
      this.#draw(frame ? there.value : [], frame);
    });
    follow(() => {
      pane.canvas.classList.toggle("marking", marking.kind !== null);
      void marking.points;
      this.#drawBegun(pane.frame.value);
    });
  }

  get #there(): readonly Mark[] {
    const { state, section } = this.#pane.context.viewer;
    const frame = this.#pane.frame.value;
    if (!frame || !section || !state.layers.marks) {
      return [];
    }
    return shownMarks(state).filter((mark) => mark.points.some((point) => this.#isNear(frame, point)));
  }

  #isNear(frame: SliceFrame, point: Mark["points"][number]): boolean {
    const { section } = this.#pane.context.viewer;
    const reach = kReach * sliceSpacing(section!, frame.axes.into);
    return Math.abs(signedDistance(planeOf(frame), point)) <= reach + 1e-6;
  }

  #label(mark: Mark): HTMLElement {
    const { chosen, texts } = this.#pane.context.marks;
    const choose = () => (chosen.value = chosen.value === mark.id ? null : mark.id);
    const button = h("button", { onclick: choose }, texts.of(mark));
    follow(() => button.setAttribute("aria-pressed", String(chosen.value === mark.id)));
    const label = h("div", { class: "mark-label", role: "listitem" }, button);
    this.#labels.set(mark, label);
    return label;
  }

  #draw(marks: readonly Mark[], frame: SliceFrame | null): void {
    this.#drawing.replaceChildren(
      ...(frame ? marks.flatMap((mark) => this.#shapes(mark, frame)) : []),
      this.#begun,
    );
    if (!frame) {
      return;
    }
    const labels = marks.map((mark) => {
      const { offsetWidth: width, offsetHeight: height } = this.#labels.get(mark)!;
      const line = isLine(mark) ? mark.points.map((point) => placeOf(frame, point)) : [];
      return { anchor: placeOf(frame, anchorOf(mark)), line, width, height };
    });
    layOut(labels, frame).forEach(({ at }, i) => {
      this.#labels.get(marks[i]!)!.style.translate = `${at.x.toFixed(1)}px ${at.y.toFixed(1)}px`;
    });
  }

  /** What of a mark is off the slice is fainter. */
  #shapes(mark: Mark, frame: SliceFrame): SVGElement[] {
    const near = mark.points.map((point) => this.#isNear(frame, point));
    const path = svg("path", { class: near.every(Boolean) ? "mark" : "mark faded" });
    path.setAttribute(
      "d",
      pathOf(linesOf(mark), (point) => placeOf(frame, point)),
    );
    const dots = mark.points.map((point, i) => {
      const { x, y } = placeOf(frame, point);
      return svg("circle", {
        class: near[i] ? "dot" : "dot faded",
        r: "4",
        cx: x.toFixed(1),
        cy: y.toFixed(1),
      });
    });
    return [path, ...dots];
  }

  #drawBegun(frame: SliceFrame | null): void {
    const { marking } = this.#pane.context;
    const at = this.#pane.pointer.value;
    const shape = frame && marking.isBegun.value ? marking.preview(at && pointOf(frame, at)) : null;
    const text = shape ? begunText(shape) : "";
    this.#begun.toggleAttribute("hidden", !shape);
    this.#begunText.hidden = !at || text === "";
    if (frame && shape) {
      this.#begun.setAttribute(
        "d",
        pathOf(linesOf(shape), (point) => placeOf(frame, point)),
      );
    }
    if (at && text) {
      this.#begunText.textContent = text;
      this.#begunText.style.translate = `${(at.x + 14).toFixed(1)}px ${(at.y - 26).toFixed(1)}px`;
    }
  }
}
