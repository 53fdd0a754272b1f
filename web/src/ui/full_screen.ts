import { texts } from "../text/text";
import { h, icon, kIcons } from "./dom";

/** Shows an element on all of the screen, where the browser offers that. */
export class FullScreen {
  readonly button: HTMLButtonElement;
  readonly #element: HTMLElement;

  constructor(element: HTMLElement) {
    this.#element = element;
    this.button = h(
      "button",
      {
        class: "plain",
        title: texts().page.fullScreen,
        "aria-pressed": "false",
        onclick: () => this.toggle(),
      },
      icon(kIcons.fullScreen),
    );
    this.button.hidden = !document.fullscreenEnabled;
    element.addEventListener("fullscreenchange", () =>
      this.button.setAttribute("aria-pressed", String(this.#isShown)),
    );
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
