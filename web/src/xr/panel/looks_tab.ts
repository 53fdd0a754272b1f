import type { Container } from "@pmndrs/uikit";

import { texts } from "../../text/text";
import { CaseCards, pairs } from "./case_cards";
import type { PanelContext } from "./panel_context";
import { column, kSmallFont, label, replaceChildren, scrolled } from "./widgets";

/** The ways in which the volume that is shown can be looked at. */
export class LooksTab {
  readonly element: Container;
  readonly #context: PanelContext;
  readonly #shown = column({ gap: 6 });
  readonly #cards: CaseCards;

  constructor(context: PanelContext) {
    this.#context = context;
    this.#cards = new CaseCards(context);
    this.element = scrolled(this.#shown);
  }

  async list(): Promise<void> {
    const cards = await this.#cards.make(this.#context.host.looks(), true);
    if (cards) {
      const hint = label(texts().headset.looksHint, { quiet: true, size: kSmallFont });
      replaceChildren(this.#shown, [hint, ...pairs(cards)]);
      this.#cards.forget();
    }
  }

  dispose(): void {
    this.#cards.dispose();
  }
}
