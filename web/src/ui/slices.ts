import { computed, signal } from "@preact/signals-core";

import type { Actions } from "../actions";
import type { Follow } from "../model/follower";
import type { Marking } from "../model/marking";
import { texts } from "../text/text";
import type { Viewer } from "../viewer";
import { follow, h, icon, kIcons } from "./dom";
import type { MarksOverlay } from "./marks_overlay";
import type { SliceViews } from "./slice_views";

/** What slices are shown of, and what is done in them. */
export interface SliceContext {
  readonly viewer: Viewer;
  readonly actions: Actions;
  readonly marking: Marking;
  readonly marks: MarksOverlay;
  readonly live: Follow;
}

/** Slices beside the picture, where they are wanted and there is a volume. Their code is fetched when they first are. */
export class SlicesPart {
  readonly element: HTMLElement;
  /** What they leave of the picture; without a size where there are none. */
  readonly free = h("div", { class: "free" });
  readonly #views = signal<SliceViews | null>(null);
  #end = (): void => {};
  #isLoading = false;

  /** Belongs to whoever makes it, as owned() says; `failed` is told why there are none. */
  constructor(context: SliceContext, failed: (why: string) => void) {
    const { viewer, live } = context;
    const wanted = live(() => viewer.state.slices !== null && viewer.section !== null);
    const isShown = computed(() => wanted.value && this.#views.value !== null);
    const layout = live(() => (viewer.state.slices?.shown === "all" ? "slices all" : "slices"));
    this.element = h(
      "section",
      { class: layout, "aria-label": texts().slices.title, hidden: computed(() => !isShown.value) },
      this.free,
    );
    follow(() => {
      if (wanted.value && !this.#isLoading) {
        this.#isLoading = true;
        this.#load(context).catch(() => {
          this.#isLoading = false;
          viewer.store.showSlices(null);
          failed(texts().slices.failed);
        });
      }
    });
    follow(() => () => this.#end());
  }

  /** After every frame. */
  update(): void {
    this.#views.peek()?.update();
  }

  async #load(context: SliceContext): Promise<void> {
    const { makeSliceViews } = await import("./slice_views");
    const [views, end] = makeSliceViews(context);
    this.#end = end;
    this.element.append(...views.parts);
    this.#views.value = views;
  }
}

/** Shows and hides them; `where` says on which pages. */
export function slicesButton(
  viewer: Viewer,
  actions: Actions,
  live: Follow,
  where: "wide" | "narrow",
): HTMLElement {
  return h(
    "button",
    {
      class: `plain ${where}`,
      title: texts().slices.show,
      hidden: live(() => viewer.section === null),
      "aria-pressed": live(() => viewer.state.slices !== null),
      onclick: () => actions.toggleSlices(),
    },
    icon(kIcons.slices),
  );
}
