import type { Container } from "@pmndrs/uikit";
import { SRGBColorSpace, type Texture, TextureLoader } from "three";

import { inShort } from "../../model/case_title";
import type { Look } from "../../model/looks";
import type { PanelContext } from "./panel_context";
import { button, row, space } from "./widgets";

/** Cases to choose from, with their pictures: those of what is shown now are held alone, however many cases there are. */
export class CaseCards {
  readonly #context: PanelContext;
  readonly #loader = new TextureLoader();
  #pictures: (Texture | null)[] = [];
  #gone: (Texture | null)[] = []; // until the cards that show them are
  #asked = 0;

  constructor(context: PanelContext) {
    this.#context = context;
  }

  /** In their order; null where others are asked for meanwhile. */
  async make(looks: readonly Look[], detailed = false): Promise<Container[] | null> {
    const asked = ++this.#asked;
    this.#context.spell(
      looks.flatMap(({ case: { name, title, look, error } }) => [
        name,
        title,
        look?.title ?? "",
        look?.description ?? "",
        error ?? "",
      ]),
    );
    const pictures = await Promise.all(looks.map(({ case: { thumbnail } }) => this.#picture(thumbnail)));
    if (asked !== this.#asked) {
      pictures.forEach((picture) => picture?.dispose());
      return null;
    }
    this.#gone.push(...this.#pictures);
    this.#pictures = pictures;
    return looks.map((look, i) => this.#card(look, pictures[i]!, detailed));
  }

  /** What was made before is shown no more. */
  forget(): void {
    this.#gone.splice(0).forEach((picture) => picture?.dispose());
  }

  dispose(): void {
    ++this.#asked;
    this.#gone.push(...this.#pictures.splice(0));
    this.forget();
  }

  #card({ case: one, name }: Look, picture: Texture | null, detailed: boolean): Container {
    return button(inShort(one.error ? one.name : name), () => void this.#open(one.name), {
      picture: picture ?? undefined,
      pressed: this.#context.live(() => this.#context.viewer.caseName === one.name),
      detail: detailed ? one.look?.description : undefined,
    });
  }

  /** uikit wants it whole; a case without one goes without. */
  async #picture(url: string | null): Promise<Texture | null> {
    const picture = url ? await this.#loader.loadAsync(url).catch(() => null) : null;
    if (picture) {
      picture.colorSpace = SRGBColorSpace;
    }
    return picture;
  }

  /** Why that fails is said by whoever opens cases. */
  async #open(name: string): Promise<void> {
    const { host, set } = this.#context;
    await host.open(name).catch(() => {});
    set(() => {});
  }
}

/** Two in a row. */
export function pairs(cards: readonly Container[]): Container[] {
  return cards.flatMap((card, i) => (i % 2 === 0 ? [row(card, cards[i + 1] ?? space())] : []));
}
