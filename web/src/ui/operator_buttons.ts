import type { Follow } from "../model/follower";
import { texts } from "../text/text";
import type { Viewer } from "../viewer";
import { h } from "./dom";
import { choices } from "./segments";

/** How splats meet the cut. */
export function operatorButtons(viewer: Viewer, live: Follow): HTMLElement {
  const t = texts().splats;
  const { store } = viewer;
  const hint = live(() => {
    const misses = viewer.hasLayers ? t.missesLayers : t.noLayers;
    return viewer.missesLayers ? misses : t.hints[store.state.clip];
  });
  return h(
    "div",
    {},
    h("h3", {}, t.title),
    choices(
      t.operator,
      t.operators,
      (clip) => live(() => store.state.clip === clip),
      (clip) => store.setClip(clip),
      (clip) => ({
        hint: t.hints[clip],
        hidden: clip === "layers" && live(() => !viewer.hasLayers),
      }),
    ),
    h("p", { class: "hint" }, hint),
  );
}
