import type { Container } from "@pmndrs/uikit";

import { formatCount } from "../../model/case_list";
import { texts } from "../../text/text";
import type { Effort } from "../governor";
import { handedness, posture } from "../preferences";
import { kLeastScale, kMostScale } from "../stage";
import type { PanelContext } from "./panel_context";
import { button, choice, column, kSmallFont, label, row, slider } from "./widgets";

/** How large the case is, where things stand, and what is drawn. */
export function viewTab({ viewer, host, live, set }: PanelContext): Container {
  const t = texts().headset;
  const { stage, governor } = host;
  return column(
    { gap: 10 },
    label(live(() => t.scale(scaleText(stage.scale)))),
    slider(
      live(() => ({ min: Math.log(kLeastScale), max: Math.log(kMostScale), value: Math.log(stage.scale) })),
      (value) => set(() => (stage.scale = Math.exp(value))),
    ),
    row(
      button(t.lifeSize, () => set(() => (stage.scale = 1)), { pressed: live(() => stage.scale === 1) }),
      button(t.beforeMe, () => host.place()),
    ),
    choice(t.handed, handedness.signal, (hand) => {
      handedness.value = hand;
      host.place();
    }),
    choice(t.posture, posture.signal, (how) => {
      posture.value = how;
      host.place();
    }),
    row(
      button(t.steady, () => set(() => (governor.enabled = !governor.enabled)), {
        pressed: live(() => governor.enabled),
      }),
      button(t.takeOff, () => host.leave()),
    ),
    label(
      live(() => {
        const { drawn, total } = viewer.stats;
        return t.drawn(formatCount(drawn), formatCount(total), effortText(governor.effort));
      }),
      { quiet: true, size: kSmallFont },
    ),
  );
}

/** What is given up for frames in time. */
function effortText({ scale, extent, leastPixels, walls, detail }: Effort): string {
  const t = texts().headset.effort;
  const parts = [
    ...(scale < 1 ? [t.resolution(Math.round(100 * scale))] : []),
    ...(extent < Infinity ? [t.extent(extent.toFixed(1))] : []),
    ...(leastPixels > 0 ? [t.from(leastPixels)] : []),
    ...(walls !== "fine" ? [t.walls[walls]] : []),
    ...(detail === "outline" ? [t.noSurface] : detail === "splats" ? [t.splatsAlone] : []),
  ];
  return parts.length > 0 ? parts.join(", ") : t.full;
}

function scaleText(scale: number): string {
  const t = texts().headset;
  return scale === 1 ? t.isLifeSize : t.timesLifeSize(scale < 1 ? scale.toFixed(2) : scale.toFixed(1));
}
