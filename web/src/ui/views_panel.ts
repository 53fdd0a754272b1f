import { computed, type ReadonlySignal, signal } from "@preact/signals-core";

import type { Follow } from "../model/follower";
import { kLongestName, kLongestNote } from "../model/marks";
import { kLongestFlight, kLongestStay, type Stop, withChange, withMove, withoutStop } from "../model/tour";
import type { ViewerStore } from "../model/viewer_state";
import { texts } from "../text/text";
import type { TourPlayer } from "../tour_player";
import { each, h, icon, kIcons } from "./dom";
import { fileField } from "./file_field";
import { segments } from "./segments";

/** What is done with views that are saved. */
export interface ViewsDesk {
  store: ViewerStore;
  player: TourPlayer;
  /** Saves what is shown, as another stop. */
  save(): void;
  /** Shows what is shown now at that stop. */
  update(id: string): void;
  saveFile(): void;
  openFile(file: File): void;
  /** Why they are not kept; null: they are. */
  trouble: ReadonlySignal<string | null>;
}

/** The views that were saved, to be shown, changed and played; `picture` asks for one of what is shown. */
export function viewsPanel(desk: ViewsDesk, live: Follow, picture: () => void): HTMLElement {
  const t = texts().views;
  const { store, player } = desk;
  const stops = live(() => store.state.stops);
  const ids = listed(() => stops.value.map(({ id }) => id));
  const isEmpty = computed(() => stops.value.length === 0);
  const edited = signal<string | null>(null);
  const list = h("ol", { class: "view-list", "aria-label": t.list });
  each(list, ids, (id) => viewRow(desk, stops, id, edited));
  const input = fileField(".json,application/json", (file) => desk.openFile(file));
  const play = computed(() => (player.playing ? t.pause : t.play));
  return h(
    "div",
    { class: "views" },
    h("h3", {}, t.title),
    segments(t.title, [
      { text: t.save, hint: t.saveHint, icon: kIcons.plus, press: () => desk.save() },
      { text: play, hint: t.playHint, icon: kIcons.play, hidden: isEmpty, press: () => void player.toggle() },
    ]),
    list,
    h(
      "p",
      { class: "hint", role: "status", hidden: computed(() => desk.trouble.value === null) },
      computed(() => t.notKept(desk.trouble.value ?? "")),
    ),
    h(
      "div",
      { class: "row" },
      h("button", { class: "small", title: t.openHint, onclick: () => input.click() }, t.openFile),
      h(
        "button",
        { class: "small", title: t.saveFileHint, hidden: isEmpty, onclick: () => desk.saveFile() },
        t.saveFile,
      ),
      h(
        "button",
        { class: "small", title: texts().picture.openHint, onclick: picture },
        texts().picture.open,
      ),
    ),
    input,
  );
}

/** The same list as long as what is in it is. */
function listed(read: () => string[]): ReadonlySignal<readonly string[]> {
  let last: readonly string[] = [];
  return computed(() => {
    const now = read();
    return (last = now.join() === last.join() ? last : now);
  });
}

/** A view in the list: a press shows it; beside it, what is said of it can be changed. */
function viewRow(
  desk: ViewsDesk,
  stops: ReadonlySignal<readonly Stop[]>,
  id: string,
  edited: { value: string | null },
): HTMLElement {
  const t = texts().views;
  const { player } = desk;
  const stop = computed(() => stops.value.find((one) => one.id === id) ?? null);
  const name = computed(() => stop.value?.name || t.unnamed);
  const isEdited = computed(() => edited.value === id);
  const card = h(
    "div",
    { class: "view-card", hidden: computed(() => !isEdited.value) },
    ...fields(desk, stop, id),
  );
  return h(
    "li",
    {},
    h(
      "div",
      { class: "view-row" },
      h(
        "button",
        {
          class: "view-name",
          "aria-current": computed(() => (player.stop.value?.id === id ? "step" : null)),
          title: t.showHint,
          onclick: () => void player.show(id),
        },
        h("span", {}, name),
      ),
      h(
        "button",
        {
          class: "plain",
          "aria-label": computed(() => t.edit(name.value)),
          "aria-expanded": isEdited,
          title: t.editHint,
          onclick: () => (edited.value = isEdited.value ? null : id),
        },
        icon(kIcons.edit),
      ),
    ),
    card,
  );
}

function fields(desk: ViewsDesk, stop: ReadonlySignal<Stop | null>, id: string): HTMLElement[] {
  const t = texts().views;
  const { store } = desk;
  const change = (part: Partial<Stop>) => store.setStops(withChange(store.state.stops, id, part));
  const name = h("input", {
    type: "text",
    maxlength: String(kLongestName),
    dir: "auto",
    value: computed(() => stop.value?.name ?? ""),
    oninput: () => change({ name: name.value }),
  });
  const text = h("textarea", {
    rows: "3",
    maxlength: String(kLongestNote),
    dir: "auto",
    value: computed(() => stop.value?.text ?? ""),
    oninput: () => change({ text: text.value }),
  });
  const seconds = (key: "fly" | "stay", most: number) => {
    const input = h("input", {
      type: "number",
      min: "0",
      max: String(most),
      step: "0.5",
      value: computed(() => String(stop.value?.[key] ?? 0)),
      onchange: () => {
        const wanted = input.valueAsNumber;
        change({ [key]: Number.isFinite(wanted) ? Math.min(most, Math.max(0, wanted)) : stop.peek()![key] });
      },
    });
    return h("label", {}, t[key], input);
  };
  const button = (what: string, hint: string, press: () => void, drawing: string | null = null) =>
    h(
      "button",
      { class: "small", title: hint, "aria-label": drawing ? what : null, onclick: press },
      drawing ? icon(drawing) : what,
    );
  const move = (by: -1 | 1) => store.setStops(withMove(store.state.stops, id, by));
  const down = button(t.down, t.down, () => move(1), kIcons.up);
  down.classList.add("down");
  return [
    h("label", {}, t.name, name),
    h("label", {}, t.text, text),
    h("div", { class: "row" }, seconds("fly", kLongestFlight), seconds("stay", kLongestStay)),
    h(
      "div",
      { class: "row" },
      button(t.update, t.updateHint, () => desk.update(id)),
      button(t.up, t.up, () => move(-1), kIcons.up),
      down,
      button(t.remove, t.removeHint, () => store.setStops(withoutStop(store.state.stops, id))),
    ),
  ];
}
