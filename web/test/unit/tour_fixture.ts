import { Vector3 } from "three";

import { flight } from "../../src/model/flight";
import type { Sphere } from "../../src/model/geometry";
import { parseLink } from "../../src/model/link";
import { linkedState } from "../../src/model/linked_state";
import type { PlaneStates } from "../../src/model/states";
import { type ViewerState, ViewerStore } from "../../src/model/viewer_state";

/** What is shown before anybody chose anything. */
export const kBase: ViewerState = new ViewerStore().state;

/** What a flight shows, as src/tour/flights.json says it: from one link to another after a share of the way. */
export function shownOf(
  from: string,
  to: string,
  share: number,
  sphere: Sphere,
  states: PlaneStates,
): object {
  const [a, b] = [from, to].map((link) => linkedState(parseLink(link), kBase, states));
  const { view, cuts, window, layers, handle, ...rest } = flight(a!, b!, share, sphere);
  const { azimuth, elevation, zoom, pan, back } = view;
  const list = (vector: Vector3) => vector.toArray().map((part) => part + 0); // no −0
  return {
    view: [azimuth, elevation, zoom, back],
    pan: list(pan),
    cuts: cuts.map(({ normal, offset, thickness }) => ({ normal: list(normal), offset, thickness })),
    window: window && [window.center, window.width],
    grey: rest.grey,
    turn: rest.turn,
    lamp: rest.lamp,
    depth_cue: rest.depthCue,
    clip: rest.clip,
    section: rest.section,
    openings: rest.openings,
    rig: rest.rig,
    background: rest.backdrop,
    body: layers.body,
    faces: layers.faces,
    marks: layers.marks,
    handle,
  };
}
