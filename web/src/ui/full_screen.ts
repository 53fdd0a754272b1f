import { texts } from "../text/text";
import { h, icon, kIcons } from "./dom";

/** Shows an element on all of the screen, where the browser offers that. */
export class FullScreen {
  readonly #element: HTMLElement;

  constructor(element: HTMLElement) {
    this.#element = element;
  }

  /** A button that does it; `where` says on which pages. */
  button(where: "wide" | "narrow"): HTMLElement {
    const button = h(
      "button",
      {
        class: `plain ${where}`,
        title: texts().page.fullScreen,
        hidden: !document.fullscreenEnabled,
        "aria-pressed": "false",
        onclick: () => this.toggle(),
      },
      icon(kIcons.fullScreen),
    );
    this.#element.addEventListener("fullscreenchange", () =>
      button.setAttribute("aria-pressed", String(this.#isShown)),
    );
    return button;
  }

  toggle(): void {
    // The user may refuse it, and browsers where another element is being shown.
    const done = this.#isShown ? document.exitFullscreen() : this.#element.requestFullscreen?.();
    done?.catch(() => {});
  }

  get #isShown(): boolean {
    return this.#element.matches(":fullscreen");
  }
}
