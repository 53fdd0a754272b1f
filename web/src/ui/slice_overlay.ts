import { computed, type ReadonlySignal } from "@preact/signals-core";
import type { Vector3 } from "three";

import { planesOf } from "../model/cut";
import { isSameWindow } from "../model/grey";
import { kAxes, kOrientations } from "../model/planes";
import { lineOfPlane, placeOf, pointOf, sliceLetters, type SliceFrame } from "../model/slice";
import type { Place } from "../model/label_layout";
import { barLength, pointText, readSection, valueText } from "../model/values";
import { drawSlice } from "../render/slice_pixels";
import type { Section } from "../sog/section";
import { texts } from "../text/text";
import { each, follow, h, svg } from "./dom";
import type { SlicePane } from "./slice_pane";

/** Of the pane's width: the scale bar is no longer. */
const kBarShare = 0.3;
/** Around the crosshair's middle no line hides what is there, px. */
const kGap = 12;
/** A slice is in a plane from this cosine on. */
const kAlong = 0.9999;

/** What is said over a slice: where it is in the patient, what meets it, a scale, the window, and the value pointed at. */
export function sliceOverlay(pane: SlicePane, place: ReadonlySignal<string>): HTMLElement {
  const t = texts();
  const { live } = pane.context;
  const lines = svg("svg", { "aria-hidden": "true" });
  follow(() => {
    const frame = pane.frame.value;
    lines.replaceChildren(...(frame ? [...cutLines(pane, frame), ...crosshair(pane, frame)] : []));
  });
  const letters = live(() => (pane.frame.value ? sliceLetters(pane.frame.value.axes) : ["", "", "", ""]));
  const edges = (["left", "right", "top", "bottom"] as const).map((edge, i) =>
    h(
      "span",
      { class: `edge ${edge}` },
      computed(() => letters.value[i]!),
    ),
  );
  return h(
    "div",
    { class: "slice-overlay" },
    lines,
    ...edges,
    h(
      "div",
      { class: "slice-head" },
      h(
        "span",
        {},
        h(
          "b",
          {},
          live(() => pane.title),
        ),
        " ",
        place,
      ),
      h("strong", { class: "slice-warning" }, t.notForDiagnosis),
    ),
    h("div", { class: "slice-foot" }, scale(pane), h("div", {}, reading(pane), windowChoice(pane))),
  );
}

function line([from, to]: readonly [Place, Place], name: string): SVGElement {
  const [x1, y1, x2, y2] = [from.x, from.y, to.x, to.y].map((v) => v.toFixed(1));
  return svg("line", { class: name, x1: x1!, y1: y1!, x2: x2!, y2: y2! });
}

/** Where the planes of cuts meet the slice; those of the active one are told apart. */
function cutLines({ context: { viewer } }: SlicePane, frame: SliceFrame): SVGElement[] {
  const { cuts, active } = viewer.state;
  return cuts.flatMap((cut, i) =>
    planesOf([cut]).flatMap((plane) => {
      const met = lineOfPlane(frame, plane);
      return met ? [line(met, i === active ? "cut active" : "cut")] : [];
    }),
  );
}

/** In the colours of the slices that its lines stand for, where it goes along these. */
function crosshair(pane: SlicePane, frame: SliceFrame): SVGElement[] {
  const { width, height, axes } = frame;
  const { x, y } = placeOf(frame, pane.at!);
  const across = (normal: typeof axes.down) =>
    kOrientations.find((name) => Math.abs(kAxes[name].dot(normal)) > kAlong) ?? "";
  const [level, upright] = [`cross ${across(axes.down)}`, `cross ${across(axes.right)}`];
  return [
    line(
      [
        { x: 0, y },
        { x: x - kGap, y },
      ],
      level,
    ),
    line(
      [
        { x: x + kGap, y },
        { x: width, y },
      ],
      level,
    ),
    line(
      [
        { x, y: 0 },
        { x, y: y - kGap },
      ],
      upright,
    ),
    line(
      [
        { x, y: y + kGap },
        { x, y: height },
      ],
      upright,
    ),
  ].filter((_, i) => [x > kGap, x < width - kGap, y > kGap, y < height - kGap][i]);
}

function scale(pane: SlicePane): HTMLElement {
  const bar = h("i");
  const length = h("span");
  follow(() => {
    const { width, scale } = pane.frame.value ?? { width: 0, scale: 1 };
    const mm = barLength((kBarShare * width) / scale);
    length.textContent = `${mm} mm`;
    bar.style.width = `${(mm * scale).toFixed(1)}px`;
  });
  return h("div", { class: "slice-scale" }, length, bar);
}

/** Of photographs the colour. */
function reading(pane: SlicePane): HTMLElement {
  const { viewer, live } = pane.context;
  const read = live(() => {
    const frame = pane.frame.value;
    const { section } = viewer;
    const at = pane.pointer.value;
    const reading = frame && section && at ? readSection(section, pointOf(frame, at)) : null;
    const isColor = section?.channels === 3;
    return (
      reading && {
        what: isColor ? colorText(section, frame!, reading.point) : valueText(reading),
        point: reading.point,
      }
    );
  });
  return h(
    "output",
    { class: "slice-reading", "aria-label": texts().page.valueHere, "aria-live": "off" },
    live(() => read.value?.what ?? ""),
    h(
      "span",
      {},
      live(() => (read.value ? ` · ${pointText(read.value.point)}` : "")),
    ),
  );
}

/** "RGB 135 96 80": a slice of one pixel. */
function colorText(section: Section, frame: SliceFrame, point: Vector3): string {
  const pixel = new Uint8ClampedArray(4);
  drawSlice(section, null, { ...frame, middle: point, width: 1, height: 1 }, pixel);
  return `RGB ${pixel.subarray(0, 3).join(" ")}`;
}

/** The window in use, of those that the case is usually seen through. */
function windowChoice({ context: { viewer, live } }: SlicePane): HTMLElement {
  const t = texts();
  const names = live(() => [...viewer.windows.keys()]);
  const chosen = live(() => {
    const { window } = viewer;
    return [...viewer.windows].find(([, one]) => isSameWindow(one, window))?.[0] ?? "";
  });
  const select = h("select", {
    "aria-label": t.face.window,
    onchange: () => viewer.store.setWindow(viewer.windows.get(select.value) ?? viewer.window),
  });
  const own = h("option", { value: "", hidden: true }, t.slices.ownWindow);
  each(
    select,
    live(() => ["", ...names.value]),
    (name) => (name === "" ? own : h("option", { value: name }, name)),
  );
  follow(() => {
    void names.value;
    select.value = chosen.value;
  });
  const numbers = live(() => {
    const { window } = viewer;
    return window ? `C ${window.center.toFixed(0)} W ${window.width.toFixed(0)}` : "";
  });
  return h(
    "label",
    { class: "slice-window", hidden: live(() => !viewer.window) },
    select,
    h("span", {}, numbers),
  );
}
