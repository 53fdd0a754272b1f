import { type CaseInfo, isSameVolume } from "./case_info";
import { reframed } from "./view";
import { kChosenLook, type ViewerState } from "./viewer_state";

/** Of what is shown, what two cases beside each other have in common as it is. */
const kCommon = [
  ...kChosenLook,
  "active",
  "handle",
  "layers",
  "depthCue",
  "backdrop",
] as const satisfies readonly (keyof ViewerState)[];

/** What lies in the patient: where one looks from, and what is cut. */
type Placed = Pick<ViewerState, "view" | "cuts">;

/**
 * The view and the cuts of a case as those of another one: of the same volume they are the same in the patient, else
 * they are as far from the middle of either.
 */
export function carried({ view, cuts }: Placed, from: CaseInfo, to: CaseInfo): Placed {
  if (isSameVolume(from, to)) {
    return { view: reframed(view, from.sphere, to.sphere), cuts };
  }
  const shift = to.sphere.center.clone().sub(from.sphere.center);
  return {
    view,
    cuts: cuts.map((cut) => ({ ...cut, offset: cut.offset + cut.normal.dot(shift) })),
  };
}

/** What is shown of a case, as it is shown of the one beside it: cut where it is, whatever that one's states are. */
export function besideState(state: ViewerState, from: CaseInfo, to: CaseInfo): Partial<ViewerState> {
  const common = Object.fromEntries(kCommon.map((key) => [key, state[key]]));
  return { ...common, mode: "arbitrary", ...carried(state, from, to) };
}
