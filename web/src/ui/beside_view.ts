import type { Actions } from "../actions";
import { besideState, carried } from "../model/beside";
import { isSameVolume } from "../model/case_info";
import type { CaseSummary } from "../model/case_list";
import type { ViewerState } from "../model/viewer_state";
import { texts } from "../text/text";
import { Viewer } from "../viewer";
import { CaseClient } from "../worker/case_client";
import { h, icon, kIcons } from "./dom";
import { PointerControls } from "./pointer";

/** Another case beside the one of the page, which is seen, cut and lit as that is; what is done with either is done with both. */
export class BesideView {
  readonly parts: readonly HTMLElement[];
  readonly #main: Viewer;
  readonly #viewer: Viewer;
  readonly #title = h("b");
  readonly #places = h("span");
  readonly #resized: ResizeObserver;
  #given: Partial<ViewerState> = {};
  #from: ViewerState | null = null; // that was given

  /** Throws CaseError where the browser cannot draw another. */
  constructor(main: Viewer, actions: Actions, takesWheel: () => boolean, close: () => void) {
    this.#main = main;
    const t = texts();
    const canvas = h("canvas", { class: "stage", role: "img", "aria-label": t.beside.canvas });
    this.#viewer = new Viewer(canvas, new CaseClient());
    new PointerControls(this.#viewer, (mm) => actions.step(mm), takesWheel);
    for (const type of ["pointermove", "wheel"]) {
      canvas.addEventListener(type, () => this.#pull());
    }
    this.#resized = new ResizeObserver(() => this.#viewer.resize({ right: 0, bottom: 0 }));
    this.#resized.observe(canvas);
    this.parts = [
      canvas,
      h(
        "div",
        { class: "beside-title" },
        h("span", {}, this.#title, this.#places),
        h("button", { class: "plain", title: t.beside.close, onclick: close }, icon(kIcons.close)),
      ),
      h("strong", { class: "warning" }, t.notForDiagnosis),
    ];
  }

  /** Rejects with CaseError. */
  async open({ name, file }: Pick<CaseSummary, "name" | "file">): Promise<void> {
    this.#title.textContent = name;
    await this.#viewer.open(name, file, null, () => {
      this.#title.textContent = this.#viewer.title;
      this.update();
    });
    this.update();
  }

  /** After every change of what the page shows. */
  update(): void {
    const [main, viewer] = [this.#main, this.#viewer];
    const { state } = main.store;
    viewer.setGlow(main.painter.background.glow);
    if (!main.info || !viewer.info) {
      return;
    }
    const sameVolume = isSameVolume(main.info, viewer.info);
    this.#places.textContent = sameVolume ? texts().beside.samePlaces : texts().beside.relativePlaces;
    // Values of one modality are seen through the same window.
    const isAlike = main.section?.modality === viewer.section?.modality;
    const window = isAlike ? main.window : viewer.state.window;
    if (this.#from !== state || this.#given.window !== window) {
      this.#from = state;
      this.#given = { ...besideState(state, main.info, viewer.info), window };
      viewer.store.restore(this.#given);
    }
  }

  dispose(): void {
    this.#resized.disconnect();
    this.#viewer.dispose();
  }

  /** What was done with this case is done with that of the page. */
  #pull(): void {
    const { info, state } = this.#viewer;
    const { store } = this.#main;
    if (!info || !store.info || !this.#given.view) {
      return;
    }
    const { view, cuts } = carried(state, info, store.info);
    if (state.view !== this.#given.view) {
      store.setView(view);
    }
    if (state.cuts !== this.#given.cuts) {
      store.setCuts(cuts, state.active);
    }
    if (
      state.window !== this.#given.window &&
      this.#main.section?.modality === this.#viewer.section?.modality
    ) {
      store.setWindow(state.window);
    }
  }
}
