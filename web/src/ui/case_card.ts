import { type CaseSummary, formatBytes, formatCount } from "../model/case_list";
import { type CaseGroup, countText, groupCases, type Look } from "../model/looks";
import { texts } from "../text/text";
import { h, icon, kIcons } from "./dom";
import { openFileButton } from "./open_file";
import { segments } from "./segments";

/** The cases of the server as cards with their pictures, those of one volume together. */
export class CaseMenu {
  readonly element: HTMLDialogElement;
  readonly #cards = h("div", { class: "cards" });
  readonly #choose: (name: string, beside: boolean) => void;
  readonly #ways: HTMLElement;
  #beside = false;

  /** What is chosen is shown, or shown beside what is. */
  constructor(choose: (name: string, beside: boolean) => void, openFile: (file: File) => void) {
    this.#choose = choose;
    const { ways, way } = texts().beside;
    this.#ways = segments(way, [
      { text: ways.instead, press: () => this.#setBeside(false) },
      { text: ways.beside, press: () => this.#setBeside(true) },
    ]);
    const ownFile = openFileButton((file) => {
      this.element.close();
      openFile(file);
    });
    const { title } = texts().menu;
    this.element = sheetDialog("sheet menu", title, title, this.#ways, this.#cards, ownFile);
  }

  /** `beside`: for a case beside the one that is shown, unless a person wants it otherwise. */
  show(cases: CaseSummary[], current: string | null, beside = false): void {
    this.#ways.hidden = current === null || cases.length < 2;
    this.#setBeside(beside && !this.#ways.hidden);
    this.#cards.replaceChildren(
      ...(cases.length > 0
        ? groupCases(cases).map((group) => this.#group(group, current))
        : [
            h(
              "p",
              { class: "hint" },
              texts().menu.none,
              h("code", {}, "clipgs build VOLUME -o CASE.sog"),
              texts().menu.makes,
            ),
          ]),
    );
    if (!this.element.open) {
      this.element.showModal();
    }
  }

  #setBeside(beside: boolean): void {
    this.#beside = beside;
    [...this.#ways.children].forEach((way, i) =>
      way.setAttribute("aria-pressed", String((i === 1) === beside)),
    );
  }

  #group(group: CaseGroup, current: string | null): HTMLElement {
    const cards = group.looks.map((look) => this.#card(look, group, current));
    if (cards.length === 1) {
      return cards[0]!;
    }
    return h(
      "section",
      { class: "volume", "aria-label": `${group.title}, ${countText(group)}` },
      h("h3", {}, `${group.title} · ${countText(group)}`),
      h("div", { class: "cards" }, ...cards),
    );
  }

  #card({ case: one, name }: Look, { looks }: CaseGroup, current: string | null): HTMLElement {
    const preset = looks.length === 1 && one.preset ? `${one.preset} · ` : "";
    const detail = `${preset}${texts().menu.splats(formatCount(one.splats))} · ${formatBytes(one.bytes)}`;
    return caseCard(one, name, detail, one.name === current, () => {
      this.element.close();
      this.#choose(one.name, this.#beside);
    });
  }
}

/** A sheet with a heading and a button that closes it; a press beside it does, too. */
export function sheetDialog(
  classes: string,
  name: string,
  heading: string,
  ...content: HTMLElement[]
): HTMLDialogElement {
  const dialog: HTMLDialogElement = h(
    "dialog",
    { class: classes, "aria-label": name, autofocus: true },
    h(
      "header",
      {},
      h("h2", {}, heading),
      closeButton(() => dialog.close()),
    ),
    ...content,
  );
  closeOnBackdrop(dialog);
  return dialog;
}

/** A case's picture, what it is called and a line about it, or what is wrong with it. */
export function caseCard(
  one: CaseSummary,
  title: string,
  detail: string,
  current: boolean,
  choose: () => void,
): HTMLElement {
  const picture = one.thumbnail
    ? h("img", { src: one.thumbnail, alt: "", loading: "lazy" })
    : h("span", { class: "no-picture" }, icon(one.error ? kIcons.warning : kIcons.coronal));
  return h(
    "button",
    {
      class: `card${current ? " current" : ""}${one.error ? " broken" : ""}`,
      "data-case": one.name,
      "aria-current": current ? "true" : false,
      onclick: choose,
    },
    h("span", { class: "picture" }, picture),
    h("strong", {}, one.error ? one.name : title),
    h("small", {}, one.error ?? detail),
  );
}

function closeButton(close: () => void): HTMLElement {
  return h("button", { class: "plain", "aria-label": texts().close, onclick: close }, icon(kIcons.close));
}

function closeOnBackdrop(dialog: HTMLDialogElement): void {
  dialog.addEventListener("click", (event) => {
    if (event.target === dialog) {
      dialog.close();
    }
  });
}
