import type { Actions } from "../actions";
import { clock } from "../model/values";
import type { Button, Entry, Question, Screen } from "../study/screen";
import type { StudyTexts } from "../text/study_en";
import type { Language } from "../text/text";
import { h } from "./dom";

/** What a study shows, on the page. */
export class StudyCard {
  readonly element: HTMLElement;
  readonly #actions: Actions;
  readonly #words: StudyTexts;
  readonly #remaining = h("output", { class: "readout", "aria-live": "off" });
  readonly #slider: HTMLInputElement;
  readonly #position = h("output", { class: "readout", "aria-live": "off" });
  #shown = "";
  #key = "";

  constructor(actions: Actions, words: StudyTexts, lang: Language) {
    this.#actions = actions;
    this.#words = words;
    this.element = h("section", { class: "study", "aria-label": words.title, lang });
    this.#slider = h("input", {
      type: "range",
      "aria-label": words.slider,
      oninput: () => actions.moveTo(Number(this.#slider.value)),
    });
  }

  /** Whether the case is to be seen beside it. */
  get isAside(): boolean {
    return this.element.classList.contains("aside");
  }

  /** Returns whether it is another now, of another size perhaps. */
  show(screen: Screen): boolean {
    const { remaining, entry, ...rest } = screen;
    this.#remaining.textContent = remaining === null ? "" : clock(remaining);
    if (screen.slides) {
      this.#slide();
    }
    // What is typed is there already; time goes by without another card.
    const shown = JSON.stringify([rest, entry?.label, remaining === null]);
    if (shown === this.#shown) {
      return false;
    }
    this.#shown = shown;
    this.element.classList.toggle("aside", screen.aside);
    const focused = screen.key === this.#key ? document.activeElement?.textContent : null;
    this.element.replaceChildren(
      h("header", {}, h("h2", { tabindex: "-1" }, screen.title), this.#remaining),
      ...screen.text.map((text) => h("p", {}, text)),
      ...(screen.trouble ? [h("p", { class: "trouble", role: "alert" }, screen.trouble)] : []),
      ...(screen.question ? [question(screen.question)] : []),
      ...(entry ? [field(entry)] : []),
      ...(screen.slides ? [h("div", { class: "row" }, this.#slider, this.#position)] : []),
      h("div", { class: "row end" }, ...screen.buttons.map(button)),
    );
    this.#focus(screen.key, focused ?? null);
    return true;
  }

  #slide(): void {
    const { position, positionText } = this.#actions;
    this.#slider.disabled = position === null;
    if (position) {
      const { min, max, step, value } = position;
      Object.assign(this.#slider, { min, max, step });
      this.#slider.value = String(value);
    }
    this.#position.textContent = positionText;
    this.#slider.setAttribute("aria-valuetext", positionText || this.#words.noPlane);
  }

  /** A new screen is read from its title on; on the same one the button of this text is focused again. */
  #focus(key: string, text: string | null): void {
    if (key !== this.#key) {
      this.#key = key;
      const entry = this.element.querySelector<HTMLElement>("input[type=number], textarea");
      (entry ?? this.element.querySelector<HTMLElement>("h2"))!.focus({ preventScroll: true });
    } else if (text) {
      [...this.element.querySelectorAll("button")].find((one) => one.textContent === text)?.focus();
    }
  }
}

function button({ text, enabled, press }: Button): HTMLElement {
  return h("button", { class: "solid", disabled: !enabled, onclick: press }, text);
}

function question({ text, low, high, values, chosen, enabled, choose }: Question): HTMLElement {
  const answers = values.map((value) =>
    h(
      "button",
      { "aria-pressed": String(value === chosen), disabled: !enabled, onclick: () => choose(value) },
      String(value),
    ),
  );
  return h(
    "div",
    { class: "question" },
    h("p", { class: "asked", id: "study-question" }, text),
    h("div", { class: "ends" }, h("span", {}, low), h("span", {}, high)),
    h(
      "div",
      {
        class: values.length > 7 ? "answers many" : "answers",
        role: "group",
        "aria-labelledby": "study-question",
      },
      ...answers,
    ),
  );
}

function field({ label, kind, value, set }: Entry): HTMLElement {
  const input =
    kind === "number"
      ? h("input", { type: "number", min: "1", max: "9999", inputmode: "numeric", autocomplete: "off" })
      : h("textarea", { rows: "5", maxlength: "4000" });
  input.value = value;
  input.addEventListener("input", () => set(input.value));
  return h("label", { class: "entry" }, h("span", {}, label), input);
}
