import { Container, Text } from "@pmndrs/uikit";
import { computed, signal } from "@preact/signals-core";

import type { Actions } from "../../actions";
import { clock } from "../../model/values";
import type { Question, Screen } from "../../study/screen";
import type { Study } from "../../study/study";
import type { SdfFont } from "./sdf_font";
import { button, column, label, replaceChildren, row, slider } from "./widgets";

const kAnswersInRow = 7;

/** What a study shows, in the panel's place in the room. */
export class StudyBoard {
  readonly content = column({ gap: 12 });
  readonly #study: Study;
  readonly #actions: Actions;
  readonly #font: SdfFont;
  readonly #remaining = signal("");
  readonly #version = signal(0);
  #shown = "";

  constructor(study: Study, actions: Actions, font: SdfFont) {
    this.#study = study;
    this.#actions = actions;
    this.#font = font;
  }

  /** The study shows something else, or time has gone by. */
  update(): void {
    const screen = this.#study.screen;
    const { remaining, entry, ...rest } = screen;
    this.#remaining.value = remaining === null ? "" : clock(remaining);
    ++this.#version.value;
    const shown = JSON.stringify([rest, entry?.label, remaining === null]);
    if (shown !== this.#shown) {
      this.#shown = shown;
      this.content.setProperties({ fontFamilies: this.#font.families(shown) });
      replaceChildren(this.content, this.#parts(screen));
    }
  }

  #parts(screen: Screen): (Container | Text)[] {
    return [
      label(screen.title, { size: 24 }),
      ...(screen.remaining === null ? [] : [label(this.#remaining, { quiet: true })]),
      ...screen.text.map((text) => label(text, { size: 19 })),
      ...(screen.trouble ? [label(screen.trouble, { size: 19, color: "#ffb3a6" })] : []),
      ...(screen.question ? question(screen.question) : []),
      ...(screen.entry ? [label(this.#study.words.typedAtDesk, { quiet: true })] : []),
      ...(screen.slides ? this.#slide() : []),
      row(
        ...screen.buttons.map(({ text, enabled, press }) =>
          button(text, press, { enabled: signal(enabled), height: 64, size: 21 }),
        ),
      ),
    ];
  }

  #slide(): (Container | Text)[] {
    const live = <T>(read: () => T) =>
      computed(() => {
        void this.#version.value;
        return read();
      });
    return [
      label(live(() => this.#actions.positionText || this.#study.words.noPlane)),
      slider(
        live(() => this.#actions.position ?? { min: 0, max: 1, value: 0 }),
        (value) => this.#actions.moveTo(value),
      ),
    ];
  }
}

function question({ text, low, high, values, chosen, enabled, choose }: Question): (Container | Text)[] {
  const rows = Array.from({ length: Math.ceil(values.length / kAnswersInRow) }, (_, i) =>
    values.slice(kAnswersInRow * i, kAnswersInRow * (i + 1)),
  );
  const ends = row();
  ends.setProperties({ justifyContent: "space-between" });
  return [
    label(text, { size: 21 }),
    ends.add(label(low, { quiet: true }), label(high, { quiet: true })),
    ...rows.map((some) =>
      row(
        ...some.map((value) =>
          button(String(value), () => choose(value), {
            pressed: signal(value === chosen),
            enabled: signal(enabled),
            height: 64,
            size: 21,
          }),
        ),
      ),
    ),
  ];
}
