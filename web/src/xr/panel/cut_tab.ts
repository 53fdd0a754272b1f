import type { Container } from "@pmndrs/uikit";
import { computed } from "@preact/signals-core";

import { kLeastThickness } from "../../actions";
import { kOrientations, type Orientation, orientationOf, planeText } from "../../model/planes";
import type { Mode } from "../../model/states";
import { texts } from "../../text/text";
import type { ClipOperator } from "../../worker/protocol";
import type { PanelContext } from "./panel_context";
import { button, choice, column, label, row, slider, when } from "./widgets";

/** Of those that every case has. */
type Operator = Exclude<ClipOperator, "layers">;

/** Planes: how they move, where they are, and how splats are cut by them. */
export function cutTab(context: PanelContext): Container {
  const { viewer, actions, live } = context;
  const t = texts().headset;
  return column(
    { gap: 10 },
    choice<Mode>(
      t.modes,
      live(() => viewer.state.mode),
      (mode) => viewer.store.setMode(mode),
    ),
    when(
      live(() => !actions.isUniaxial),
      choice<Orientation>(
        Object.fromEntries(kOrientations.map((one) => [one, texts().orientations[one]])) as Record<
          Orientation,
          string
        >,
        live(() => viewer.cut && orientationOf(viewer.cut)),
        (one) => actions.orient(one),
      ),
    ),
    label(live(() => readout(context))),
    slider(
      live(() => actions.position ?? { min: 0, max: 1, value: 0 }),
      (value) => actions.moveTo(value),
    ),
    activePlane(context),
    slab(context),
    row(
      button(t.cut, () => actions.toggle(), { pressed: live(() => viewer.cut !== null) }),
      button(t.undo, () => actions.undo(), { enabled: live(() => actions.canUndo) }),
      button(t.redo, () => actions.redo(), { enabled: live(() => actions.canRedo) }),
    ),
    when(
      live(() => !actions.isUniaxial),
      allPlanes(context),
    ),
    operators(context),
  );
}

/** What is done with the plane that is moved. */
function activePlane({ viewer, actions, host, live, set }: PanelContext): Container {
  const t = texts().headset;
  const { grip } = host.stage;
  const free = live(() => !actions.isUniaxial);
  const enabled = live(() => !actions.isUniaxial && viewer.cut !== null);
  return row(
    button(t.flip, () => actions.flip(), { enabled }),
    button(t.slab, () => actions.toggleSlab(), {
      enabled,
      pressed: live(() => (viewer.cut?.thickness ?? null) !== null),
    }),
    button(t.lock, () => set(() => (grip.locked = !grip.locked)), {
      pressed: live(() => grip.locked),
    }),
    button(t.snap, () => set(() => (grip.snap.enabled = !grip.snap.enabled)), {
      enabled: free,
      pressed: live(() => grip.snap.enabled),
    }),
    button(t.reset, () => actions.resetPlane()),
  );
}

function slab({ viewer, actions, live }: PanelContext): Container {
  const thickness = live(() => {
    const { min, max } = actions.position ?? { min: 0, max: 1 };
    return {
      min: kLeastThickness,
      max: Math.max(kLeastThickness, max - min),
      value: viewer.cut?.thickness ?? 0,
    };
  });
  return when(
    live(() => (viewer.cut?.thickness ?? null) !== null),
    column(
      {},
      label(computed(() => texts().headset.slabOf(thickness.value.value.toFixed(1)))),
      slider(thickness, (mm) => actions.setThickness(mm)),
    ),
  );
}

function allPlanes({ viewer, actions, live }: PanelContext): Container {
  const t = texts().headset;
  return row(
    button(t.addPlane, () => actions.add(), { enabled: live(() => actions.canAdd) }),
    button(
      live(() => t.planeOf(viewer.state.active + 1, viewer.state.cuts.length)),
      () => actions.activate(),
      { enabled: live(() => viewer.state.cuts.length > 1) },
    ),
    button(t.remove, () => actions.remove(), { enabled: live(() => viewer.cut !== null) }),
  );
}

function operators({ viewer, live }: PanelContext): Container {
  const { layers, ...others } = texts().splats.operators;
  const clip = live(() => viewer.state.clip);
  return column(
    {},
    when(
      live(() => viewer.hasLayers),
      choice<ClipOperator>({ ...others, layers }, clip, (one) => viewer.store.setClip(one)),
    ),
    when(
      live(() => !viewer.hasLayers),
      choice<Operator>(
        others,
        computed(() => (clip.value === "layers" ? "exact" : clip.value)),
        (one) => viewer.store.setClip(one),
      ),
    ),
  );
}

function readout({ viewer, actions }: PanelContext): string {
  const { cut, planeState } = viewer.store;
  const { positionText } = actions;
  if (!cut) {
    return texts().cut.nothing;
  }
  return planeState === null ? `${planeText(cut)} · ${positionText}` : positionText;
}
