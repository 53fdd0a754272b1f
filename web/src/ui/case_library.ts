import "./case_library.css";

import { computed, effect, signal, untracked } from "@preact/signals-core";

import { detailText, findCases, kCaseOrders, type CaseOrder, libraryCases } from "../model/case_library";
import { type CaseIndex, formatCount } from "../model/case_list";
import { newsText } from "../model/case_news";
import { type CaseGroup, countText, type Look } from "../model/looks";
import { texts } from "../text/text";
import { caseCard } from "./case_card";
import { h } from "./dom";
import { inSlices } from "./in_slices";
import { openFileButton } from "./open_file";
import { Preference } from "./preference";
import { segments } from "./segments";
import { sheetDialog } from "./sheet_dialog";

const kNothing: CaseIndex = { cases: [], making: null, keepsMarks: false, keepsTours: false };
/** More than is seen, and so few that nobody waits for them: all of a thousand take a second. */
const kCardsAtOnce = 24;
const kSameRow = 8; // px: cards in a row begin at one height

/** The cases of the server as cards with their pictures, searched and sorted, those of one volume together. */
export class CaseLibrary {
  readonly element: HTMLDialogElement;
  readonly #choose: (name: string, beside: boolean) => void;
  readonly #ways: HTMLElement;
  #beside = false;
  readonly #list = h("div", { class: "cards", onkeydown: (event) => this.#move(event as KeyboardEvent) });
  readonly #count = h("output", { class: "hint" });
  readonly #field = h("input", {
    type: "search",
    placeholder: texts().library.search,
    "aria-label": texts().library.searchHint,
    autocomplete: "off",
    spellcheck: "false",
    oninput: () => (this.#search.value = this.#field.value),
    onkeydown: (event) => this.#searchKey(event as KeyboardEvent),
  });
  readonly #order = new Preference<CaseOrder>("clipgs.cases", kCaseOrders);
  readonly #index = signal(kNothing);
  readonly #search = signal("");
  readonly #cases = computed(() => libraryCases(this.#index.value));
  readonly #groups = computed(() => findCases(this.#cases.value, this.#search.value, this.#order.value));
  readonly #cards = new Map<string, { says: string; element: HTMLButtonElement }>(); // by names of cases
  #current: string | null = null;
  #reached = ""; // the name of the case whose card is reached with Tab
  #takesFocus = false; // that card, as soon as it is there
  #stop = (): void => {};

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
    this.element = sheetDialog(
      "sheet library",
      texts().menu.title,
      texts().menu.title,
      h("div", { class: "finder" }, this.#field, this.#orderChoice(), this.#ways),
      this.#list,
      h(
        "div",
        { class: "foot" },
        this.#count,
        ownFile,
        h("strong", { class: "warning" }, texts().notForDiagnosis),
      ),
    );
    this.element.addEventListener("keydown", (event) => this.#type(event));
    effect(() => {
      const groups = this.#groups.value;
      untracked(() => this.#fill(groups));
    });
  }

  /** Opens it on all cases, at the `current` one; `beside`: for one beside it, unless a person wants it otherwise. */
  show(index: CaseIndex, current: string | null, beside = false): void {
    this.#ways.hidden = current === null || index.cases.length < 2;
    this.#setBeside(beside && !this.#ways.hidden);
    this.#current = this.#reached = current ?? "";
    this.#field.value = this.#search.value = "";
    if (!this.element.open) {
      this.element.showModal();
    }
    this.#takesFocus = true;
    this.#index.value = { ...index };
  }

  #setBeside(beside: boolean): void {
    this.#beside = beside;
    [...this.#ways.children].forEach((way, i) =>
      way.setAttribute("aria-pressed", String((i === 1) === beside)),
    );
  }

  /** What there is may be another, while it is open. */
  update(index: CaseIndex): void {
    if (this.element.open && summary(index) !== summary(this.#index.value)) {
      const { scrollTop } = this.#list;
      this.#index.value = index;
      this.#list.scrollTop = scrollTop;
    }
  }

  #orderChoice(): HTMLElement {
    const t = texts().library;
    const choice = h(
      "select",
      { onchange: () => (this.#order.value = choice.value as CaseOrder) },
      ...kCaseOrders.map((order) => h("option", { value: order }, t.orders[order])),
    );
    choice.value = this.#order.value;
    return h("label", {}, h("span", {}, t.sort), choice);
  }

  #fill(groups: readonly CaseGroup[]): void {
    this.#takesFocus ||= this.#list.contains(document.activeElement);
    this.#stop();
    this.#list.replaceChildren();
    this.#list.scrollTop = 0;
    this.#tellCount(groups.reduce((sum, { looks }) => sum + looks.length, 0));
    const names = groups.flatMap(({ looks }) => looks.map((look) => look.case.name));
    if (!names.includes(this.#reached)) {
      this.#reached = names[0] ?? "";
    }
    this.#stop = inSlices(this.#append(groups), kCardsAtOnce);
  }

  /** Card by card. */
  *#append(groups: readonly CaseGroup[]): Generator<void> {
    for (const group of groups) {
      const into = group.looks.length === 1 ? this.#list : this.#volume(group);
      for (const look of group.looks) {
        const card = this.#card(look);
        into.append(card);
        if (look.case.name === this.#reached) {
          card.tabIndex = 0;
          if (this.#takesFocus) {
            card.focus();
          }
          this.#takesFocus = false;
        }
        yield;
      }
    }
  }

  /** Where the looks of a volume stand together. */
  #volume(group: CaseGroup): HTMLElement {
    const cards = h("div", { class: "cards" });
    const name = `${group.title}, ${countText(group)}`;
    const heading = h("h3", { dir: "auto" }, `${group.title} · ${countText(group)}`);
    this.#list.append(h("section", { class: "volume", "aria-label": name }, heading, cards));
    return cards;
  }

  /** One that was made before, with its picture, if it says the same. */
  #card({ case: one, name }: Look): HTMLButtonElement {
    const news = newsText(one, this.#index.value.making ?? [], one.name);
    const isCurrent = one.name === this.#current;
    const says = [one.version, one.error, name, detailText(one), news, isCurrent].join("\n");
    const before = this.#cards.get(one.name);
    if (before?.says === says) {
      before.element.tabIndex = -1;
      return before.element;
    }
    const isComing = one.file === "" && !one.error;
    const lines = [
      isComing ? null : h("small", { class: "file", translate: "no" }, `${one.name}.sog`),
      h("small", {}, detailText(one)),
      news ? h("small", { class: "news" }, news) : null,
    ].filter((line) => line !== null);
    const element = caseCard(one, name, lines, isCurrent, () => this.#chosen(one.name));
    element.tabIndex = -1;
    element.ariaDisabled = isComing ? "true" : null;
    this.#cards.set(one.name, { says, element });
    return element;
  }

  #chosen(name: string): void {
    const one = this.#cases.value.find((known) => known.name === name);
    if (one && (one.file !== "" || one.error)) {
      this.element.close();
      this.#choose(name, this.#beside);
    }
  }

  #tellCount(found: number): void {
    const t = texts().library;
    const all = this.#cases.value.length;
    const count = formatCount(all);
    this.#count.textContent = found === all ? t.count(count) : t.found(formatCount(found), count);
    if (all === 0) {
      const { none, makes } = texts().menu;
      this.#list.append(
        h("p", { class: "hint" }, none, h("code", {}, "clipgs build VOLUME -o CASE.sog"), makes),
      );
    } else if (found === 0) {
      const clear = () => {
        this.#field.value = this.#search.value = "";
        this.#field.focus();
      };
      this.#list.append(
        h("p", { class: "hint" }, t.nothing, " ", h("button", { class: "small", onclick: clear }, t.clear)),
      );
    }
  }

  #shownCards(): HTMLButtonElement[] {
    return [...this.#list.querySelectorAll<HTMLButtonElement>(".card")];
  }

  /** Arrows, Home and End go from card to card, of which Tab reaches the last one only. */
  #move(event: KeyboardEvent): void {
    const cards = this.#shownCards();
    const at = cards.indexOf(document.activeElement as HTMLButtonElement);
    const goals: Record<string, () => HTMLButtonElement | undefined> = {
      ArrowRight: () => cards[at + 1],
      ArrowLeft: () => cards[at - 1],
      ArrowDown: () => inNextRow(cards, at, 1),
      ArrowUp: () => inNextRow(cards, at, -1),
      Home: () => cards[0],
      End: () => cards.at(-1),
    };
    const goal = goals[event.key];
    if (goal && at >= 0 && !event.ctrlKey && !event.altKey && !event.metaKey) {
      event.preventDefault();
      this.#reach(goal() ?? (event.key === "ArrowUp" ? this.#field : undefined));
    }
  }

  #reach(goal: HTMLElement | undefined): void {
    if (goal instanceof HTMLButtonElement) {
      this.#shownCards().forEach((card) => (card.tabIndex = -1));
      goal.tabIndex = 0;
      this.#reached = goal.dataset["case"]!;
    }
    goal?.focus();
  }

  #searchKey(event: KeyboardEvent): void {
    const [first] = this.#shownCards();
    if (event.key === "ArrowDown") {
      event.preventDefault();
      this.#reach(first);
    } else if (event.key === "Enter" && this.#search.value !== "") {
      first?.click();
    } else if (event.key === "Escape" && this.#search.value !== "") {
      event.preventDefault(); // shows all again, and closes when it is pressed once more
      this.#field.value = this.#search.value = "";
    }
  }

  /** What is typed anywhere is searched for. */
  #type({ key, target, ctrlKey, altKey, metaKey }: KeyboardEvent): void {
    this.#takesFocus = false;
    const isField = target instanceof HTMLInputElement || target instanceof HTMLSelectElement;
    if (!isField && [...key].length === 1 && key !== " " && !ctrlKey && !altKey && !metaKey) {
      this.#field.focus(); // before the browser hands the letter on
    }
  }
}

/** All that the library says of what there is and comes, but where it stands. */
function summary(index: CaseIndex): string {
  const says = libraryCases(index).map((one) => [
    one.name,
    one.version,
    one.error,
    newsText(one, index.making ?? [], one.name),
  ]);
  return JSON.stringify(says);
}

/** Of the next row of cards, down (1) or up (−1), the one that is nearest. */
function inNextRow<Card extends HTMLElement>(
  cards: readonly Card[],
  at: number,
  way: 1 | -1,
): Card | undefined {
  const from = cards[at]!.getBoundingClientRect();
  let best: Card | undefined;
  let row: number | null = null;
  let least = Infinity;
  for (let i = at + way; i >= 0 && i < cards.length; i += way) {
    const { left, top } = cards[i]!.getBoundingClientRect();
    if (way * (top - from.top) > kSameRow) {
      row ??= top;
      if (Math.abs(top - row) > kSameRow) {
        break;
      }
      if (Math.abs(left - from.left) < least) {
        least = Math.abs(left - from.left);
        best = cards[i];
      }
    }
  }
  return best;
}
