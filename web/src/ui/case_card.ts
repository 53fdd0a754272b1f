import type { CaseSummary } from "../model/case_list";
import { inOwnWords } from "../text/text";
import { h, icon, kIcons } from "./dom";

/** A case's picture, what it is called and what there is to say of it, line by line, or what is wrong with it. */
export function caseCard(
  one: CaseSummary,
  title: string,
  lines: readonly HTMLElement[],
  current: boolean,
  choose: () => void,
): HTMLButtonElement {
  const picture = one.thumbnail
    ? h("img", { src: one.thumbnail, alt: "", loading: "lazy", decoding: "async" })
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
    h("strong", { dir: "auto", title }, one.error ? one.name : title),
    ...(one.error ? [h("small", {}, inOwnWords(one.error))] : lines),
  );
}
