import type { Viewer } from "../viewer";
import type { BesidePart } from "./beside";

/** What stands on a viewer's page beside its picture. */
export interface Around {
  readonly root: HTMLElement;
  /** At the right, or below on a narrow page. */
  readonly panel: HTMLElement;
  /** What slices leave of the picture; without a size where there are none. */
  readonly free: HTMLElement;
  readonly beside: BesidePart;
  /** Of a study, where the case is to be seen above it. */
  card(): HTMLElement | null;
}

/** Frames the case in what is left free of the page. */
export function frameCase(viewer: Viewer, { root, panel, free, beside, card }: Around): void {
  const stage = viewer.canvas.getBoundingClientRect();
  const box = panel.getBoundingClientRect();
  const isBelow = box.width >= viewer.canvas.clientWidth;
  if (isBelow && !panel.classList.contains("open")) {
    root.style.setProperty("--panel-height", `${box.height}px`);
  }
  const left = free.getBoundingClientRect();
  const isSliced = left.width > 0;
  root.classList.toggle("sliced", isSliced);
  const inset = { right: 0, bottom: 0 };
  const above = card();
  if (isSliced) {
    inset.right = stage.right - left.right;
    inset.bottom = stage.bottom - left.bottom;
  } else {
    const isShown = box.width > 0;
    inset.right = isShown && !isBelow ? stage.right - box.left : 0;
    inset.bottom = above
      ? stage.bottom - above.getBoundingClientRect().top
      : isShown && isBelow
        ? stage.bottom - box.top
        : 0;
  }
  const half = beside.place(stage.width - inset.right, stage.height - inset.bottom);
  root.classList.toggle("has-beside", half.right + half.bottom > 0);
  inset.right += half.right;
  inset.bottom += half.bottom;
  root.style.setProperty("--free-right", `${inset.right}px`);
  root.style.setProperty("--free-bottom", `${inset.bottom}px`);
  viewer.resize(inset);
}
