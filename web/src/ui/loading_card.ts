import { amountText } from "../model/case_list";
import { texts } from "../text/text";
import type { Cover } from "../worker/arriving";
import type { LoadListener } from "../worker/case_client";
import type { CaseSource } from "../worker/protocol";
import { h } from "./dom";

/** What is seen of a case while it is on its way: its picture, what it is called, and how much of it is there. */
export class LoadingCard implements LoadListener {
  readonly #picture = h("img", { alt: "", hidden: true });
  readonly #title = h("strong", {});
  readonly #said = h("small", {});
  readonly element = h(
    "div",
    { class: "loading", role: "progressbar", "aria-label": texts().page.loading, hidden: true },
    h("span", { class: "picture" }, this.#picture),
    this.#title,
    h("span", { class: "amount" }),
    this.#said,
  );
  #file: CaseSource | null = null;
  #bytes = 0; // of the case, where the server says so
  #own = ""; // the address of a picture that came with the case

  /** The case of a file is on its way; that it is may be said twice. `over`: another one is seen meanwhile. */
  begin(file: CaseSource, over: boolean): void {
    if (this.#file !== file) {
      this.end();
      this.#file = file;
      this.element.classList.toggle("over", over);
      this.element.hidden = false;
    }
  }

  /** What the server says of it. */
  name({
    file,
    title,
    thumbnail,
    bytes,
  }: {
    file: CaseSource;
    title: string;
    thumbnail: string | null;
    bytes: number;
  }): void {
    if (this.#file === file) {
      this.#title.textContent = title;
      this.#bytes = bytes;
      if (thumbnail && this.#picture.hidden) {
        this.#show(thumbnail);
      }
    }
  }

  /** Why nothing comes yet. */
  say(text: string): void {
    this.#said.textContent = text;
  }

  cover({ title, thumbnail }: Cover): void {
    this.#title.textContent = title || this.#title.textContent;
    if (this.#picture.hidden) {
      this.#own = URL.createObjectURL(new Blob([thumbnail], { type: "image/webp" }));
      this.#show(this.#own);
    }
  }

  progress(loaded: number, total: number): void {
    const all = total || this.#bytes;
    const share = all > 0 ? Math.min(1, loaded / all) : 0;
    this.element.style.setProperty("--share", String(share));
    this.element.ariaValueNow = String(Math.round(100 * share));
    this.say(share < 1 ? amountText(loaded, all) : texts().loading.prepares);
    this.element.ariaValueText = this.#said.textContent;
  }

  /** The case itself is seen, but for what cuts need. */
  pictured(): void {
    this.element.classList.add("aside");
  }

  end(): void {
    URL.revokeObjectURL(this.#own);
    this.#file = null;
    this.#bytes = 0;
    this.#own = "";
    this.#picture.hidden = true;
    this.#picture.removeAttribute("src");
    this.#title.textContent = "";
    this.say("");
    this.element.hidden = true;
    this.element.classList.remove("aside", "over");
    this.element.style.removeProperty("--share");
    this.element.ariaValueNow = this.element.ariaValueText = null;
  }

  #show(address: string): void {
    this.#picture.src = address;
    this.#picture.hidden = false;
  }
}
