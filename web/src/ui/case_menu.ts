import { type CaseSummary, formatBytes, formatCount } from "../model/case_list";
import { h, icon, kIcons } from "./dom";

/** The cases of the server as cards with their pictures. */
export class CaseMenu {
  readonly element: HTMLDialogElement;
  readonly #cards = h("div", { class: "cards" });
  readonly #choose: (name: string) => void;

  constructor(choose: (name: string) => void) {
    this.#choose = choose;
    this.element = h(
      "dialog",
      { class: "sheet menu", "aria-label": "Cases", autofocus: true },
      h(
        "header",
        {},
        h("h2", {}, "Cases"),
        closeButton(() => this.element.close()),
      ),
      this.#cards,
    );
    closeOnBackdrop(this.element);
  }

  show(cases: CaseSummary[], current: string | null): void {
    this.#cards.replaceChildren(
      ...(cases.length > 0
        ? cases.map((one) => this.#card(one, one.name === current))
        : [
            h(
              "p",
              { class: "hint" },
              "The folder holds no case yet. ",
              h("code", {}, "clipgs build VOLUME -o CASE.sog"),
              " makes one.",
            ),
          ]),
    );
    if (!this.element.open) {
      this.element.showModal();
    }
  }

  #card(one: CaseSummary, current: boolean): HTMLElement {
    const picture = one.thumbnail
      ? h("img", { src: one.thumbnail, alt: "", loading: "lazy" })
      : h("span", { class: "no-picture" }, icon(one.error ? kIcons.warning : kIcons.coronal));
    return h(
      "button",
      {
        class: `card${current ? " current" : ""}${one.error ? " broken" : ""}`,
        "data-case": one.name,
        "aria-current": current ? "true" : false,
        onclick: () => {
          this.element.close();
          this.#choose(one.name);
        },
      },
      h("span", { class: "picture" }, picture),
      h("strong", {}, one.error ? one.name : one.title),
      h(
        "small",
        {},
        one.error ??
          `${one.preset ? `${one.preset} · ` : ""}${formatCount(one.splats)} splats · ${formatBytes(one.bytes)}`,
      ),
    );
  }
}

export function closeButton(close: () => void): HTMLElement {
  return h(
    "button",
    { class: "plain", "aria-label": "Close", onclick: close },
    icon("M6 6l12 12|M18 6L6 18"),
  );
}

export function closeOnBackdrop(dialog: HTMLDialogElement): void {
  dialog.addEventListener("click", (event) => {
    if (event.target === dialog) {
      dialog.close();
    }
  });
}
