import type { Follow } from "../model/follower";
import { texts } from "../text/text";
import type { Viewer } from "../viewer";
import { h } from "./dom";
import { choices } from "./segments";

/** What of a case is shown. */
export function layerButtons(viewer: Viewer, live: Follow): HTMLElement {
  const t = texts().layers;
  const { store } = viewer;
  return h(
    "div",
    { hidden: live(() => viewer.noSection !== null) },
    h("h3", {}, t.title),
    choices(
      t.title,
      t.names,
      (layer) => live(() => store.state.layers[layer]),
      (layer) => store.setLayers({ [layer]: !store.state.layers[layer] }),
      (layer) => ({ hint: t.hints[layer] }),
    ),
  );
}
