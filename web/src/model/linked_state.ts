import { Vector3 } from "three";

import type { Hidden, Link } from "./link";
import type { Mark } from "./marks";
import { type PlaneStates, stateCut } from "./states";
import type { ViewerState } from "./viewer_state";

// What a link says, and what is shown: the one place where they meet. The twin of src/tour/link.cpp.

/**
 * What is shown where `now` is what was, and a link says what of it is to be another. `states`: of the case. Slices, which
 * follow the cut, are for the store to show.
 */
export function linkedState(link: Link, now: ViewerState, states: PlaneStates | null): ViewerState {
  const hidden = (one: Hidden) => link.hidden?.includes(one) ?? false;
  return {
    ...now,
    ...linkedCuts(link, states),
    view: link.view ?? now.view,
    clip: link.clip ?? now.clip,
    section: link.section ?? "volume",
    grey: link.grey ?? 0,
    openings: link.openings ?? "cinematic",
    rig: link.rig ?? null,
    turn: link.turn ?? 0,
    lamp: link.lamp ? new Vector3(...link.lamp).normalize().toArray() : null,
    window: link.window ?? now.window,
    layers: { body: !hidden("body"), faces: !hidden("faces"), marks: !hidden("marks") },
    handle: !hidden("handle"),
    backdrop: link.background ?? null,
    depthCue: link.depthCue ?? 0,
  };
}

/** How a link cuts; nothing where it does not say. */
function linkedCuts(
  { state, cuts, active = 0 }: Link,
  states: PlaneStates | null,
): Partial<Pick<ViewerState, "mode" | "cuts" | "active">> {
  if (state !== undefined && states) {
    const cut = state === null ? [] : [stateCut(states, Math.min(state, states.count - 1))];
    return { mode: "uniaxial", cuts: cut, active: 0 };
  }
  return cuts ? { mode: "arbitrary", cuts, active: Math.min(active, Math.max(0, cuts.length - 1)) } : {};
}

/** The link to what is shown of the case of that name; `marks` and the state of the uniaxial mode are shown with it. */
export function linkTo(
  name: string | undefined,
  state: ViewerState,
  planeState: number | null,
  marks: readonly Mark[],
): Link {
  const { view, mode, cuts, active, clip, section, grey, openings, rig, turn, lamp, window } = state;
  const { backdrop, depthCue, handle, layers, slices } = state;
  const cut = mode === "uniaxial" ? { state: planeState } : { cuts, active };
  const style = {
    ...(grey > 0 ? { grey } : {}),
    ...(window && (grey > 0 || slices) ? { window } : {}),
    ...(grey > 0 && openings !== "cinematic" ? { openings } : {}),
    ...(rig ? { rig } : {}),
    ...(turn ? { turn } : {}),
    ...(lamp ? { lamp } : {}),
    ...(backdrop ? { background: backdrop } : {}),
    ...(depthCue ? { depthCue } : {}),
    ...(slices ? { slices } : {}),
  };
  const hidden = Object.entries({ ...layers, handle }).flatMap(([one, shown]) =>
    shown ? [] : [one as Hidden],
  );
  return { case: name, view, ...cut, clip, section, ...style, hidden, marks };
}
