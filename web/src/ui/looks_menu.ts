import type { Look } from "../model/looks";
import { texts } from "../text/text";
import { caseCard } from "./case_card";
import { h } from "./dom";
import { sheetDialog } from "./sheet_dialog";

/** The looks of one volume with their pictures, and what each shows. */
export class LooksMenu {
  readonly element: HTMLDialogElement;
  readonly #cards = h("div", { class: "cards" });
  readonly #choose: (name: string) => void;

  constructor(choose: (name: string) => void) {
    this.#choose = choose;
    this.element = sheetDialog(
      "sheet menu looks",
      texts().menu.looksName,
      texts().menu.looksTitle,
      h("p", { class: "hint" }, texts().menu.looksHint),
      this.#cards,
      h("strong", { class: "warning" }, texts().notForDiagnosis),
    );
  }

  show(looks: readonly Look[], current: string | null): void {
    this.#cards.replaceChildren(
      ...looks.map(({ case: one, name }) =>
        caseCard(one, name, [h("small", {}, one.look?.description ?? "")], one.name === current, () => {
          this.element.close();
          this.#choose(one.name);
        }),
      ),
    );
    if (!this.element.open) {
      this.element.showModal();
      this.#cards.querySelector<HTMLElement>("[aria-current]")?.focus();
    }
  }
}
