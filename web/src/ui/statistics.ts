import { formatBytes, formatCount } from "../model/case_list";
import { texts } from "../text/text";
import type { Viewer } from "../viewer";
import { h } from "./dom";

const kIntervalMs = 250;

/** How fast the case is drawn, and how much of it. */
export class Statistics {
  readonly element = h("output", {
    class: "stats",
    "aria-label": texts().page.statistics,
    "aria-live": "off",
  });
  readonly #viewer: Viewer;
  #timer = 0;

  constructor(viewer: Viewer) {
    this.#viewer = viewer;
  }

  /** After every frame. */
  update(): void {
    this.#timer ||= window.setTimeout(() => this.#show(), kIntervalMs);
  }

  dispose(): void {
    clearTimeout(this.#timer);
  }

  #show(): void {
    this.#timer = 0;
    const { frameMs, sortMs, drawn, total, scale, sectionBytes, sectionMs } = this.#viewer.stats;
    if (total === 0) {
      return;
    }
    const frame = frameMs > 0 ? `${frameMs.toFixed(1)} ms a frame · ` : "";
    const section =
      sectionBytes > 0
        ? ` · section ${formatBytes(sectionBytes)}, decoded in ${Math.round(sectionMs)} ms`
        : "";
    const reduced = scale < 0.99 ? ` · ${Math.round(100 * scale)} % resolution` : "";
    this.element.textContent = `${frame}sort ${sortMs.toFixed(1)} ms · ${formatCount(drawn)} of ${formatCount(total)} splats${section}${reduced}`;
  }
}
