import type { Follow } from "../model/follower";
import { kRigs } from "../model/rigs";
import { texts } from "../text/text";
import type { Viewer } from "../viewer";
import { h } from "./dom";
import { LampPad } from "./lamp_pad";
import { range } from "./range";

/** The choice of a lamp among the rigs. */
const kLamp = "lamp";

/** By what a case is lit: as it was made, by another rig that can be turned, or by a lamp in hand. */
export function lightPanel(viewer: Viewer, live: Follow): HTMLElement {
  const t = texts().light;
  const { store } = viewer;
  const lamp = new LampPad(viewer, live);
  const held = live(() => viewer.state.lamp !== null);
  const choice = h(
    "select",
    {
      value: live(() => (held.value ? kLamp : (viewer.state.rig ?? ""))),
      onchange: () => {
        if (choice.value === kLamp) {
          lamp.begin();
        } else {
          store.setLamp(null);
          store.setRig(choice.value || null);
        }
      },
    },
    h("option", { value: "" }, t.own),
    ...[...kRigs].map(([name, { title }]) => h("option", { value: name }, t.rigs[name] ?? title)),
    h("option", { value: kLamp }, t.lamp),
  );
  const turn = range(
    { "aria-label": t.turn },
    live(() => ({ min: -180, max: 180, step: 5, value: viewer.state.turn })),
    (degrees) => store.setTurn(degrees),
  );
  return h(
    "div",
    { hidden: live(() => viewer.canChangeRig !== true) },
    h("label", { class: "light" }, t.title, choice),
    h("div", { class: "blend two", hidden: held }, h("span", {}, t.turned), turn),
    h("div", { hidden: live(() => !held.value) }, lamp.element),
  );
}
