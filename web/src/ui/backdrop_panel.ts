import { kBackdrops } from "../model/backdrop";
import type { Follow } from "../model/follower";
import { texts } from "../text/text";
import type { Viewer } from "../viewer";
import { h } from "./dom";
import { range } from "./range";

/** What lies behind the case, and how much what is far away fades towards it. */
export function backdropPanel(viewer: Viewer, live: Follow): HTMLElement {
  const t = texts().background;
  const { store } = viewer;
  const backdrop = h(
    "select",
    {
      title: t.hint,
      "aria-label": t.title,
      value: live(() => viewer.state.backdrop ?? ""),
      onchange: () => store.setBackdrop(backdrop.value || null),
    },
    h("option", { value: "" }, t.title),
    ...[...kBackdrops].map(([name, { title }]) => h("option", { value: name }, t.names[name] ?? title)),
  );
  const depth = range(
    { title: t.depthHint, "aria-label": t.depthName },
    live(() => ({ min: 0, max: 1, step: 0.05, value: viewer.state.depthCue })),
    (strength) => store.setDepthCue(strength),
  );
  return h("div", { class: "blend backdrop" }, backdrop, h("span", {}, t.depth), depth);
}
