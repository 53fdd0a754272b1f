import { signal, untracked } from "@preact/signals-core";
import type { Vector3 } from "three";

import type { Follow } from "../model/follower";
import { layOut, type Place, type Size } from "../model/label_layout";
import type { Marking } from "../model/marking";
import {
  anchorOf,
  isLine,
  linesOf,
  type Mark,
  type MarkKind,
  type MarkShape,
  markText,
  measure,
  measureText,
} from "../model/marks";
import { shownMarks } from "../model/viewer_state";
import type { Section } from "../sog/section";
import { texts } from "../text/text";
import type { Viewer } from "../viewer";
import { follow, h, svg } from "./dom";
import { placeOn } from "./place";

/** A label that is farther from what it is about has a line to it, px. */
const kLeader = 14;
/** More labels than these hide what they are about: those on faces that are seen come first. */
const kMostLabels = 100;

const kNoSize: Size = { width: 0, height: 0 };

/** A mark as it is drawn. */
interface Drawn {
  mark: Mark;
  text: string;
  label: HTMLElement;
  size: Size | null; // of the label, once it was seen
  lines: SVGElement;
  leader: SVGElement; // from its label, where that is away from it
  dots: readonly SVGElement[];
  choice: number | undefined; // where its label stood last
}

/** A mark in the picture. */
interface SeenMark {
  drawn: Drawn;
  anchor: Place;
  line: Place[]; // that no label is to cover
  faded: boolean;
}

/** What is said of a mark, read again only where the section is another; one that is gone is not held. */
export class MarkTexts {
  readonly #viewer: Viewer;
  readonly #read = new WeakMap<Section, { number: number; known: WeakMap<Mark, string> }>();
  #sections = 0;
  #known = new WeakMap<Mark, string>();

  constructor(viewer: Viewer) {
    this.#viewer = viewer;
  }

  of(mark: Mark): string {
    const { section } = this.#viewer;
    // While another look is on its way there is none: what was read stays.
    if (section) {
      ({ known: this.#known } = this.#of(section));
    }
    const known = this.#known.get(mark);
    const text = known ?? (markText(mark, measure(mark, section)) || texts().marks.kinds[mark.kind]);
    if (section) {
      this.#known.set(mark, text);
    }
    return text;
  }

  /** The number of the section that is read, from 1; 0: there is none. */
  get source(): number {
    const { section } = this.#viewer;
    return section ? this.#of(section).number : 0;
  }

  #of(section: Section): { number: number; known: WeakMap<Mark, string> } {
    const read = this.#read.get(section) ?? { number: ++this.#sections, known: new WeakMap<Mark, string>() };
    this.#read.set(section, read);
    return read;
  }
}

/** Marks over the picture, with labels that keep clear of each other; a press on a label chooses its mark. */
export class MarksOverlay {
  readonly element: HTMLElement;
  /** The mark that is chosen, by its id. */
  readonly chosen = signal<string | null>(null);
  readonly texts: MarkTexts;
  readonly #viewer: Viewer;
  readonly #marking: Marking;
  readonly #drawing = svg("svg", { "aria-hidden": "true" });
  readonly #begun = svg("path", { class: "begun" });
  readonly #begunText = h("div", { class: "mark-label begun", hidden: true });
  readonly #aim = h("div", { class: "reticle", "aria-hidden": "true" });
  readonly #labels = h("div", { role: "list", "aria-label": texts().marks.title });
  #drawn = new Map<string, Drawn>();
  #pointer: Place | null = null; // over the canvas
  #moved = false; // since the picture was drawn

  /** Belongs to whoever makes it, as owned() says. */
  constructor(viewer: Viewer, marking: Marking, live: Follow) {
    this.#viewer = viewer;
    this.#marking = marking;
    this.texts = new MarkTexts(viewer);
    this.element = h(
      "div",
      { class: "mark-layer", hidden: live(() => !viewer.state.layers.marks) },
      this.#drawing,
      this.#aim,
      this.#labels,
      this.#begunText,
    );
    this.#drawing.append(this.#begun);
    const marks = live(() => shownMarks(viewer.state));
    const section = live(() => viewer.section); // one that comes later brings values
    follow(() => {
      void section.value;
      this.#show(marks.value);
    });
    follow(() => {
      viewer.canvas.classList.toggle("marking", marking.kind !== null);
      if (marking.kind !== null) {
        this.chosen.value = null;
      }
      void marking.points;
      this.#updateBegun();
    });
    follow(() => {
      void this.chosen.value;
      this.#showChosen();
    });
    this.#listen();
  }

  /** Marks the point under the pointer, or the reticle of who has none, or else the one of the next click on a face. */
  mark(kind: MarkKind): void {
    const other = this.#marking.kind !== null && this.#marking.kind !== kind;
    const place = this.#pointer ?? this.#reticle;
    if (other || !place || !this.#put(place, kind)) {
      this.#marking.toggle(kind);
    }
  }

  /** Ends what is begun, or what is chosen. */
  escape(): void {
    this.#marking.toggle(null);
    this.chosen.value = null;
  }

  removeChosen(): void {
    if (this.chosen.value) {
      this.#viewer.store.removeMark(this.chosen.value);
      this.chosen.value = null;
    }
  }

  /** After every frame. */
  update(): void {
    this.#moved = false;
    const { camera, picking, state } = this.#viewer;
    if (!state.layers.marks) {
      return;
    }
    const { width, height } = camera.freeSize;
    this.#aim.style.translate = `${0.5 * width}px ${0.5 * height}px`;
    const seen: SeenMark[] = [];
    for (const drawn of this.#drawn.values()) {
      const { mark, label, lines, leader, dots } = drawn;
      const places = mark.points.map((point) => camera.project(point));
      const anchor = camera.project(anchorOf(mark));
      const isThere = anchor !== null && places.every((place) => place !== null);
      for (const part of [label, lines, leader, ...dots]) {
        part.toggleAttribute("hidden", !isThere);
      }
      if (isThere) {
        const faded = !mark.points.some((point) => picking.isSeen(point));
        label.classList.toggle("faded", faded);
        lines.classList.toggle("faded", faded);
        lines.setAttribute(
          "d",
          pathOf(linesOf(mark), (point) => camera.project(point)),
        );
        places.forEach((place, i) => {
          dots[i]!.setAttribute("transform", `translate(${place.x.toFixed(1)},${place.y.toFixed(1)})`);
          dots[i]!.classList.toggle("faded", faded);
        });
        seen.push({ drawn, anchor, line: isLine(mark) ? places : [], faded });
      }
    }
    this.#layOut(seen);
    this.#updateBegun();
  }

  /** Puts the labels of marks that are seen. */
  #layOut(seen: SeenMark[]): void {
    const { camera } = this.#viewer;
    this.element.classList.toggle("many", seen.length > kMostLabels);
    if (seen.length > kMostLabels) {
      const last = ({ drawn, faded }: SeenMark) =>
        drawn.mark.id === this.chosen.peek() ? -1 : Number(faded);
      seen.sort((a, b) => last(a) - last(b));
      for (const { drawn } of seen.splice(kMostLabels)) {
        drawn.label.hidden = true;
        drawn.leader.setAttribute("d", "");
      }
    }
    // Lengths first: of a point, the value is under the pointer, too.
    seen.sort((a, b) => Number(a.drawn.mark.kind === "point") - Number(b.drawn.mark.kind === "point"));
    // All are asked for their sizes before any of them is moved: the page is laid out once.
    const labels = seen.map(({ drawn, anchor, line }) => ({
      anchor,
      line,
      ...((drawn.size ??= sizeOf(drawn.label)) ?? kNoSize),
    }));
    const laid = layOut(
      labels,
      camera.freeSize,
      seen.map(({ drawn }) => drawn.choice),
    );
    laid.forEach(({ at, choice }, i) => {
      const { drawn } = seen[i]!;
      const label = labels[i]!;
      drawn.choice = choice;
      drawn.label.style.translate = `${at.x.toFixed(1)}px ${at.y.toFixed(1)}px`;
      const to = nearest(label.anchor, { ...at, ...label });
      const away = Math.hypot(to.x - label.anchor.x, to.y - label.anchor.y) > kLeader;
      const { anchor } = label;
      drawn.leader.setAttribute("d", away ? `M${anchor.x} ${anchor.y}L${to.x} ${to.y}` : "");
    });
  }

  /** Marks that are the same, and say the same, stay as they are drawn. */
  #show(marks: readonly Mark[]): void {
    const before = this.#drawn;
    this.#drawn = new Map(
      marks.map((mark) => {
        const same = before.get(mark.id);
        const text = this.texts.of(mark);
        const isSame = same?.mark === mark && same.text === text;
        return [mark.id, isSame ? same : this.#draw(mark, text, same?.choice)];
      }),
    );
    const all = [...this.#drawn.values()];
    this.#labels.replaceChildren(...all.map(({ label }) => label));
    this.#drawing.replaceChildren(
      ...all.flatMap(({ lines, leader, dots }) => [leader, lines, ...dots]),
      this.#begun,
    );
    untracked(() => {
      if (this.chosen.value && !this.#drawn.has(this.chosen.value)) {
        this.chosen.value = null;
      }
      this.#showChosen();
      this.update();
    });
  }

  #draw(mark: Mark, text: string, choice: number | undefined): Drawn {
    const { id } = mark;
    const title = mark.note || texts().marks.chooseHint;
    const choose = () => (this.chosen.value = this.chosen.value === id ? null : id);
    const label = h(
      "div",
      { class: "mark-label", role: "listitem" },
      h("button", { title, onclick: choose }, text),
    );
    const lines = svg("path", { class: "mark" });
    const leader = svg("path", { class: "leader" });
    const dots = mark.points.map(() => svg("circle", { class: "dot", r: "5" }));
    return { mark, text, label, size: null, lines, leader, dots, choice };
  }

  #showChosen(): void {
    for (const [id, { label }] of this.#drawn) {
      label.firstElementChild!.setAttribute("aria-pressed", String(id === this.chosen.value));
    }
  }

  #listen(): void {
    const { canvas } = this.#viewer;
    const marking = this.#marking;
    // Before other listeners: the click that marks a point does nothing else.
    canvas.addEventListener("pointerdown", (event) => {
      const { kind } = marking;
      if (kind && event.button === 0 && this.#put(placeOn(this.#viewer.canvas, event), kind)) {
        event.stopImmediatePropagation();
      } else if (event.button === 0) {
        this.chosen.value = null;
      }
    });
    canvas.addEventListener("dblclick", () => marking.finish());
    for (const type of ["pointermove", "pointerleave"] as const) {
      canvas.addEventListener(type, (event) => {
        this.#pointer = type === "pointerleave" ? null : placeOn(this.#viewer.canvas, event);
        if (marking.isBegun.value && !this.#moved) {
          this.#moved = true;
          requestAnimationFrame(() => {
            this.#moved = false;
            this.#updateBegun();
          });
        }
      });
    }
  }

  /** The middle of the picture, while the canvas shows its focus to who uses keys. */
  get #reticle(): Place | null {
    const { canvas, camera } = this.#viewer;
    const { width, height } = camera.freeSize;
    return canvas.matches(":focus-visible") ? { x: 0.5 * width, y: 0.5 * height } : null;
  }

  /** What a place of the canvas would mark. */
  #pointAt({ x, y }: Place): Vector3 | null {
    const { camera, picking } = this.#viewer;
    const ray = camera.ray(x, y);
    return this.#marking.meet(ray) ?? picking.readingAlong(ray)?.point ?? null;
  }

  /** Whether there was something to mark. */
  #put(place: Place, kind: MarkKind): boolean {
    const point = this.#pointAt(place);
    return point !== null && this.#marking.put({ point, plane: this.#viewer.picking.faceOf(point) }, kind);
  }

  /** What is begun, as far as the pointer. */
  #updateBegun(): void {
    // Nothing is begun in most frames: what lies under the pointer is not looked for then.
    const point = this.#marking.isBegun.value && this.#pointer ? this.#pointAt(this.#pointer) : null;
    const shape = this.#marking.preview(point);
    this.#begun.toggleAttribute("hidden", !shape);
    const at = shape && this.#viewer.camera.project(shape.points.at(-1)!);
    const text = shape ? begunText(shape) : "";
    this.#begunText.hidden = !at || text === "";
    if (shape && at) {
      const { camera } = this.#viewer;
      this.#begun.setAttribute(
        "d",
        pathOf(linesOf(shape), (point) => camera.project(point)),
      );
      this.#begunText.textContent = text;
      this.#begunText.style.translate = `${(at.x + 14).toFixed(1)}px ${(at.y - 26).toFixed(1)}px`;
    }
  }
}

/** Of what has one: what is hidden with all that is around it has none yet. */
function sizeOf({ offsetWidth: width, offsetHeight: height }: HTMLElement): Size | null {
  return width > 0 ? { width, height } : null;
}

/** The point of a box that is nearest to a place. */
function nearest({ x, y }: Place, box: Place & Size): Place {
  return {
    x: Math.min(Math.max(x, box.x), box.x + box.width),
    y: Math.min(Math.max(y, box.y), box.y + box.height),
  };
}

/** What it measures so far, without the volume's values: those take time. */
export function begunText(shape: MarkShape): string {
  const isWhole = shape.kind !== "angle" || shape.points.length === 3;
  const known = shape.kind !== "outline" || shape.points.length > 2;
  return isWhole && known ? measureText(measure(shape, null)) : "";
}

/** Through points where they are seen; of a line of which one is not, nothing. */
export function pathOf(
  lines: readonly (readonly Vector3[])[],
  placeOf: (point: Vector3) => Place | null,
): string {
  return lines
    .map((line) => {
      const places = line.map(placeOf);
      return places.every((place) => place !== null)
        ? places.map(({ x, y }, i) => `${i === 0 ? "M" : "L"}${x.toFixed(1)} ${y.toFixed(1)}`).join("")
        : "";
    })
    .join("");
}
