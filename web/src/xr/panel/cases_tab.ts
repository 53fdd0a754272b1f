import type { Container, Text } from "@pmndrs/uikit";
import { computed, signal } from "@preact/signals-core";

import { inShort } from "../../model/case_title";
import { type CaseGroup, countText, groupCases, type Look } from "../../model/looks";
import { texts } from "../../text/text";
import { CaseCards, pairs } from "./case_cards";
import type { PanelContext } from "./panel_context";
import { button, column, kSmallFont, label, replaceChildren, row, when } from "./widgets";

/** Cases on a page: as many as are seen at once without scrolling. */
const kPage = 6;

/** A case, and the volume that it is of. */
interface Entry {
  look: Look;
  group: CaseGroup;
}

/** What can be opened, page by page, the cases of one volume together. */
export class CasesTab {
  readonly element: Container;
  readonly #context: PanelContext;
  readonly #shown = column({ gap: 6 });
  readonly #cards: CaseCards;
  readonly #entries = signal<readonly Entry[]>([]);
  readonly #page = signal(0);

  constructor(context: PanelContext) {
    this.#context = context;
    this.#cards = new CaseCards(context);
    this.element = column({ gap: 10 }, this.#shown, this.#pages());
  }

  /** Lists what there is now, from where the case that is shown is. */
  async list(): Promise<void> {
    try {
      const groups = groupCases(await this.#context.host.cases());
      const entries = groups.flatMap((group) => group.looks.map((look) => ({ look, group })));
      this.#entries.value = entries;
      const at = entries.findIndex(({ look }) => look.case.name === this.#context.viewer.caseName);
      await this.#turnTo(Math.floor(Math.max(0, at) / kPage));
      this.#context.host.message.dismiss();
    } catch (error) {
      this.#context.host.message.say((error as Error).message, () => void this.list());
    }
  }

  dispose(): void {
    this.#cards.dispose();
  }

  #pages(): Container {
    const t = texts().headset;
    const count = computed(() => Math.ceil(this.#entries.value.length / kPage));
    const turn = (by: number) => void this.#turnTo(this.#page.value + by);
    const where = label(computed(() => t.page(this.#page.value + 1, count.value)));
    where.setProperties({ textAlign: "center" });
    return when(
      computed(() => count.value > 1),
      row(
        button(t.pageBack, () => turn(-1), { enabled: computed(() => this.#page.value > 0) }),
        column({ flexGrow: 1, flexBasis: 0, justifyContent: "center" }, where),
        button(t.pageOn, () => turn(1), { enabled: computed(() => this.#page.value + 1 < count.value) }),
      ),
    );
  }

  async #turnTo(page: number): Promise<void> {
    this.#page.value = page;
    const entries = this.#entries.value.slice(kPage * page, kPage * (page + 1));
    const cards = await this.#cards.make(entries.map(({ look }) => look));
    if (cards) {
      replaceChildren(this.#shown, inGroups(entries, cards));
      this.#cards.forget();
    }
  }
}

/** Cards two in a row; those of a volume that has several begin with its title. */
function inGroups(entries: readonly Entry[], cards: readonly Container[]): (Container | Text)[] {
  const volume = ({ group }: Entry) => (group.looks.length > 1 ? group : null);
  const starts = entries.flatMap((entry, i) =>
    i === 0 || volume(entry) !== volume(entries[i - 1]!) ? [i] : [],
  );
  return starts.flatMap((start, k) => {
    const group = volume(entries[start]!);
    const title =
      group && label(`${inShort(group.title)} · ${countText(group)}`, { quiet: true, size: kSmallFont });
    return [...(title ? [title] : []), ...pairs(cards.slice(start, starts[k + 1]))];
  });
}
