import { computed, signal } from "@preact/signals-core";

import type { Actions } from "../actions";
import type { Follow } from "../model/follower";
import { texts } from "../text/text";
import type { Viewer } from "../viewer";
import { backdropPanel } from "./backdrop_panel";
import { CutPanel } from "./cut_panel";
import { h, icon, kIcons } from "./dom";
import { FacePanel } from "./face_panel";
import { layerButtons } from "./layer_buttons";
import { lightPanel } from "./light_panel";
import { operatorButtons } from "./operator_buttons";
import { Preference } from "./preference";

/** What everyone needs, or all that there is. */
export const level = new Preference("clipgs.level", ["simple", "expert"]);

/** A finger that moves farther, px, opens or closes the sheet. */
const kSwipe = 24;

/**
 * Everything about the cut and its faces, beside the case or, on a narrow page, a sheet below it, of which the
 * first part is always seen. `marks` and `views` are about those; `rest` is what the bar has no room for there.
 */
export function sidePanel(
  viewer: Viewer,
  actions: Actions,
  live: Follow,
  marks: HTMLElement,
  views: HTMLElement,
  rest: readonly HTMLElement[],
): HTMLElement {
  const t = texts();
  const cut = new CutPanel(viewer, actions, live);
  const face = new FacePanel(viewer, live);
  const open = signal(false); // the sheet
  const expert = computed(() => level.value === "expert");
  /** For experts, and once it says why things are as they are: what was pressed there is not to go under the pointer. */
  const expertly = (element: HTMLElement, otherwise: () => boolean): HTMLElement => {
    let was = false;
    const wanted = live(() => (was ||= otherwise()));
    return h("div", { hidden: computed(() => !expert.value && !wanted.value) }, element);
  };
  return h(
    "section",
    {
      class: computed(() => `panel${open.value ? " open" : ""}`),
      part: "panel",
      "aria-label": t.cut.panel,
    },
    grabber(open),
    cut.header,
    cut.place,
    h(
      "div",
      { class: "more" },
      expertly(cut.modes, () => actions.isUniaxial),
      cut.tools,
      marks,
      views,
      h("h3", {}, t.face.title),
      expertly(face.sources, () => viewer.state.section === "splats"),
      face.noSection,
      lightPanel(viewer, live),
      face.grey,
      backdropPanel(viewer, live),
      layerButtons(viewer, live),
      expertly(operatorButtons(viewer, live), () => viewer.state.clip !== "exact"),
      h(
        "div",
        { class: "panel-foot" },
        ...rest,
        h(
          "button",
          {
            class: "small level",
            title: t.level.hint,
            "aria-pressed": expert,
            onclick: () => (level.value = expert.value ? "simple" : "expert"),
          },
          icon(kIcons.expert),
          t.level.name,
        ),
      ),
    ),
  );
}

/** Opens and closes the sheet, by a press or a finger that moves up or down. */
function grabber(open: { value: boolean }): HTMLElement {
  const t = texts().sheet;
  let began: number | null = null;
  let swiped = false;
  const button = h(
    "button",
    {
      class: "grabber",
      "aria-label": computed(() => (open.value ? t.close : t.open)),
      "aria-expanded": computed(() => open.value),
      onpointerdown: (event) => {
        began = (event as PointerEvent).clientY;
        swiped = false;
        button.setPointerCapture((event as PointerEvent).pointerId);
      },
      onpointermove: (event) => {
        const moved = began === null ? 0 : (event as PointerEvent).clientY - began;
        if (Math.abs(moved) > kSwipe) {
          open.value = moved < 0;
          began = null;
          swiped = true;
        }
      },
      onpointerup: () => (began = null),
      onclick: () => {
        if (!swiped) {
          open.value = !open.value;
        }
        swiped = false;
      },
    },
    h("i"),
  );
  return button;
}
