import { computed, type ReadonlySignal, type Signal } from "@preact/signals-core";

import type { Follow } from "../model/follower";
import type { Marking } from "../model/marking";
import { kLongestName, kLongestNote, type Mark } from "../model/marks";
import { texts } from "../text/text";
import type { Viewer } from "../viewer";
import { each, h, icon, kIcons } from "./dom";
import { fileField } from "./file_field";
import type { MarkTexts } from "./marks_overlay";
import { choices } from "./segments";

/** What is done with files of marks. */
export interface MarksFiles {
  save(): void;
  open(file: File): void;
}

/** What can be marked, and what is. */
export function marksPanel(
  viewer: Viewer,
  marking: Marking,
  live: Follow,
  chosen: Signal<string | null>,
  said: MarkTexts,
  files: MarksFiles,
  trouble: ReadonlySignal<string | null>,
): HTMLElement {
  const t = texts().marks;
  const { store } = viewer;
  const marks = live(() => viewer.state.marks);
  const source = live(() => said.source);
  const tools = choices(
    t.tools,
    t.kinds,
    (kind) => computed(() => marking.kind === kind),
    (kind) => marking.toggle(kind),
    (kind) => ({ hint: t.hints[kind], icon: kIcons[kind] }),
  );
  tools.classList.add("tall");
  const hint = computed(() => (marking.kind ? t.next[marking.kind] : ""));
  const list = h("ul", { class: "mark-list", "aria-label": t.list });
  each(list, marks, (mark) => row(mark));
  const input = fileField(".json,application/json", (file) => files.open(file));
  const isEmpty = computed(() => marks.value.length === 0);

  function row(mark: Mark): HTMLElement {
    const text = computed(() => {
      void source.value;
      return said.of(mark);
    });
    return h(
      "li",
      {},
      h(
        "button",
        {
          class: "mark-name",
          "aria-pressed": computed(() => chosen.value === mark.id),
          onclick: () => (chosen.value = chosen.value === mark.id ? null : mark.id),
        },
        icon(kIcons[mark.kind]),
        h("span", {}, text),
      ),
      h(
        "button",
        {
          class: "plain",
          "aria-label": computed(() => t.remove(text.value)),
          title: t.removeHint,
          onclick: () => store.removeMark(mark.id),
        },
        icon(kIcons.close),
      ),
    );
  }

  return h(
    "div",
    { hidden: live(() => viewer.noSection !== null && viewer.state.marks.length === 0) },
    h("h3", {}, t.title),
    h("div", { hidden: live(() => viewer.noSection !== null) }, tools),
    h("p", { class: "hint", "aria-live": "polite", hidden: computed(() => hint.value === "") }, hint),
    h(
      "button",
      {
        class: "small",
        hidden: computed(() => marking.kind !== "outline" || marking.points.length < 3),
        onclick: () => marking.finish(),
      },
      t.finish,
    ),
    list,
    h(
      "p",
      { class: "hint", role: "status", hidden: computed(() => trouble.value === null) },
      computed(() => t.notKept(trouble.value ?? "")),
    ),
    h(
      "div",
      { class: "row" },
      h("button", { class: "small", title: t.openHint, onclick: () => input.click() }, t.open),
      h(
        "button",
        { class: "small", title: t.saveHint, hidden: isEmpty, onclick: () => files.save() },
        t.save,
      ),
    ),
    input,
  );
}

/** The name and the note of the mark that is chosen, and the only way to remove it by a press. */
export function markCard(
  viewer: Viewer,
  live: Follow,
  chosen: Signal<string | null>,
  said: MarkTexts,
): HTMLElement {
  const t = texts().marks;
  const { store } = viewer;
  const mark = live(() => viewer.state.marks.find(({ id }) => id === chosen.value) ?? null);
  const name = h("input", {
    type: "text",
    maxlength: String(kLongestName),
    dir: "auto",
    value: computed(() => mark.value?.name ?? ""),
    oninput: () => mark.value && store.setWords(mark.value.id, { name: name.value }),
  });
  const note = h("textarea", {
    rows: "3",
    maxlength: String(kLongestNote),
    dir: "auto",
    value: computed(() => mark.value?.note ?? ""),
    oninput: () => mark.value && store.setWords(mark.value.id, { note: note.value }),
  });
  const remove = (): void => {
    if (mark.value) {
      store.removeMark(mark.value.id);
      chosen.value = null;
    }
  };
  return h(
    "section",
    { class: "mark-card", "aria-label": t.card, hidden: computed(() => mark.value === null) },
    h(
      "header",
      {},
      h(
        "strong",
        {},
        computed(() => (mark.value ? said.of(mark.value) : "")),
      ),
      h(
        "button",
        { class: "plain", "aria-label": texts().close, onclick: () => (chosen.value = null) },
        icon(kIcons.close),
      ),
    ),
    h("label", {}, t.name, name),
    h("label", {}, t.note, note),
    h("button", { class: "small", title: t.removeHint, onclick: remove }, icon(kIcons.close), t.removeThis),
  );
}
