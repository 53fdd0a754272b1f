import type { Container } from "@pmndrs/uikit";

import type { Layers } from "../../model/layers";
import { texts } from "../../text/text";
import { isByVolume, type PanelContext } from "./panel_context";
import { button, column, kSmallFont, label, row, slider } from "./widgets";

/** Whether letters stand where the patient's sides are. */
export interface Lettering {
  shown: boolean;
}

/** What of the case is shown, and how much what is far away fades. */
export function layersTab(context: PanelContext, lettering: Lettering): Container {
  const { viewer, live, set } = context;
  const t = texts().headset;
  const { names } = texts().layers;
  const layer = (name: keyof Layers, enabled: () => boolean) =>
    button(names[name], () => viewer.store.setLayers({ [name]: !viewer.state.layers[name] }), {
      enabled: live(enabled),
      pressed: live(() => viewer.state.layers[name]),
    });
  return column(
    { gap: 10 },
    row(
      layer("body", () => isByVolume(viewer) && viewer.state.layers.faces),
      layer("faces", () => isByVolume(viewer)),
    ),
    row(
      button(t.handle, () => viewer.store.setHandle(!viewer.state.handle), {
        pressed: live(() => viewer.state.handle),
      }),
      layer("marks", () => true),
      button(t.letters, () => set(() => (lettering.shown = !lettering.shown)), {
        pressed: live(() => lettering.shown),
      }),
    ),
    label(t.depth),
    slider(
      live(() => ({ min: 0, max: 1, value: viewer.state.depthCue })),
      (strength) => viewer.store.setDepthCue(strength),
    ),
    label(t.facesAlone, { quiet: true, size: kSmallFont }),
  );
}
