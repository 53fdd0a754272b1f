import { computed } from "@preact/signals-core";

import { texts } from "../text/text";
import type { TourPlayer } from "../tour_player";
import { h, icon, kIcons } from "./dom";

/** What is said of the stop that is shown, over the case, and what goes on from it. */
export function tourCaption(player: TourPlayer): HTMLElement {
  const t = texts().views;
  const { stop } = player;
  const toggle = h(
    "button",
    {
      class: "plain",
      "aria-label": computed(() => (player.playing ? t.pause : t.play)),
      title: t.playHint,
      onclick: () => void player.toggle(),
    },
    h("span", { hidden: computed(() => player.playing) }, icon(kIcons.play)),
    h("span", { hidden: computed(() => !player.playing) }, icon(kIcons.pause)),
  );
  const step = (by: -1 | 1, text: string, drawing: string, isEnd: () => boolean) =>
    h(
      "button",
      { class: "plain", title: text, disabled: computed(isEnd), onclick: () => void player.step(by) },
      icon(drawing),
    );
  return h(
    "section",
    { class: "tour-caption", "aria-label": t.caption, hidden: computed(() => stop.value === null) },
    h(
      "div",
      { class: "tour-text", "aria-live": "polite" },
      h(
        "strong",
        { dir: "auto" },
        computed(() => stop.value?.name || t.unnamed),
      ),
      h(
        "p",
        { dir: "auto", hidden: computed(() => !stop.value?.text) },
        computed(() => stop.value?.text ?? ""),
      ),
      h(
        "p",
        { class: "tour-trouble", role: "alert", hidden: computed(() => player.trouble === "") },
        computed(() => player.trouble),
      ),
    ),
    h(
      "div",
      { class: "tour-buttons" },
      step(-1, t.previous, kIcons.previous, () => player.index <= 0),
      toggle,
      step(1, t.next, kIcons.next, () => player.index + 1 >= player.stops.length),
      h(
        "span",
        { class: "tour-count" },
        computed(() => t.count(player.index + 1, player.stops.length)),
      ),
      h("button", { class: "plain", title: t.leave, onclick: () => player.leave() }, icon(kIcons.close)),
    ),
  );
}
