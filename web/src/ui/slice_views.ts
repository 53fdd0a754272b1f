import { computed } from "@preact/signals-core";

import { kOrientations } from "../model/planes";
import { kSliceChoices, type SliceChoice, type SliceKind } from "../model/slice";
import { texts } from "../text/text";
import { each, follow, h, icon, kIcons, owned } from "./dom";
import { placeOn } from "./place";
import { segments } from "./segments";
import { SlicePane } from "./slice_pane";
import type { SliceContext } from "./slices";

/** The slices that are shown, and what is chosen of them. */
export interface SliceViews {
  readonly parts: readonly HTMLElement[];
  /** After every frame. */
  update(): void;
}

export function makeSliceViews(context: SliceContext): [views: SliceViews, end: () => void] {
  return owned(() => {
    const { viewer, live } = context;
    const panes = new Map<SliceKind, SlicePane>();
    const makePane = (kind: SliceKind): HTMLElement => {
      const pane = new SlicePane(context, kind);
      panes.set(kind, pane);
      // One that is gone would hold what it showed: the values of a case that may be gone as well.
      follow(() => () => panes.get(kind) === pane && panes.delete(kind));
      return pane.element;
    };
    const shown = live(() => viewer.state.slices?.shown ?? null);
    const kinds = computed<readonly SliceKind[]>(() =>
      shown.value === "all" ? kOrientations : shown.value ? [shown.value] : [],
    );
    const parts = h("div", { class: "slice-panes" });
    each(parts, kinds, makePane);
    const cross = h("div", { class: "slice-cross", "aria-hidden": "true" });
    const update = () => {
      const at = viewer.state.slices && viewer.camera.project(viewer.state.slices.at);
      cross.hidden = !at;
      cross.style.translate = at ? `${at.x.toFixed(1)}px ${at.y.toFixed(1)}px` : "";
    };
    // A point of a face is found in the slices, too.
    const find = (event: MouseEvent) => {
      const { x, y } = placeOn(viewer.canvas, event);
      const reading = viewer.picking.readingAt(x, y);
      if (reading && context.marking.kind === null) {
        viewer.store.setCrosshair(reading.point);
      }
    };
    follow(() => {
      viewer.canvas.addEventListener("dblclick", find);
      return () => viewer.canvas.removeEventListener("dblclick", find);
    });
    const fit = () => kinds.value.forEach((kind) => panes.get(kind)?.fit());
    return { parts: [cross, toolbar(context, shown, fit), parts], update };
  });
}

function toolbar(
  { viewer, actions, live }: SliceContext,
  shown: { value: SliceChoice | null },
  fit: () => void,
): HTMLElement {
  const t = texts().slices;
  const { store } = viewer;
  const choose = (one: SliceChoice): void => {
    const { slices } = store.state;
    const orientation = kOrientations.find((name) => name === one);
    if (slices?.linked && orientation) {
      actions.orientThrough(orientation, slices.at);
    }
    store.showSlices(one);
  };
  const isLinked = live(() => viewer.state.slices?.linked ?? false);
  return h(
    "div",
    { class: "slice-tools" },
    segments(
      t.shown,
      kSliceChoices.map((one) => ({
        text: t.choices[one],
        hint: t.choiceHints[one],
        icon: kChoiceIcons[one],
        pressed: live(() => shown.value === one),
        press: () => choose(one),
      })),
      "fit",
    ),
    h(
      "span",
      { class: "group" },
      h(
        "button",
        {
          class: "plain",
          title: t.link,
          "aria-pressed": isLinked,
          onclick: () => store.linkSlices(!isLinked.value),
        },
        icon(kIcons.link),
      ),
      h("button", { class: "plain", title: t.fit, onclick: fit }, icon(kIcons.fullScreen)),
      h(
        "button",
        { class: "plain", title: t.close, onclick: () => store.showSlices(null) },
        icon(kIcons.close),
      ),
    ),
  );
}

const kChoiceIcons: Readonly<Record<SliceChoice, string>> = {
  plane: kIcons.slab,
  axial: kIcons.axial,
  coronal: kIcons.coronal,
  sagittal: kIcons.sagittal,
  all: kIcons.looks,
};
