import { signal } from "@preact/signals-core";

import type { Host } from "../host";
import { inOwnWords, texts } from "../text/text";
import { h, icon, kIcons } from "./dom";

/** What went wrong, in a line, and how to do it again, where that may help. */
export interface Trouble {
  text: string;
  again: (() => void) | null;
}

/** What went wrong, and what can be done. */
export class Message {
  /** Null: nothing is wrong, or it was dismissed. A headset shows it, too. */
  readonly trouble = signal<Trouble | null>(null);
  readonly element = h("div", { class: "message", role: "alert", hidden: true });
  readonly #host: Pick<Host, "choose">;

  constructor(host: Pick<Host, "choose">) {
    this.#host = host;
  }

  /** `line` may be an error's, in English. */
  say(line: string, again: (() => void) | null): void {
    const text = inOwnWords(line);
    this.trouble.value = { text, again };
    const t = texts().page;
    const host = this.#host;
    const retry = (): void => {
      this.dismiss();
      again?.();
    };
    this.element.replaceChildren(
      h(
        "button",
        { class: "plain dismiss", "aria-label": t.dismiss, onclick: () => this.dismiss() },
        icon(kIcons.close),
      ),
      icon(kIcons.warning),
      h("p", {}, text),
      h(
        "div",
        { class: "row" },
        host.choose ? h("button", { class: "solid", onclick: () => host.choose?.() }, t.chooseCase) : null,
        again && h("button", { class: "solid quiet", onclick: retry }, t.again),
      ),
    );
    this.element.hidden = false;
  }

  get isSaid(): boolean {
    return !this.element.hidden;
  }

  dismiss(): void {
    this.trouble.value = null;
    this.element.hidden = true;
  }
}
