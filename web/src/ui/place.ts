import type { Place } from "../model/label_layout";

/** Where a pointer is on an element, CSS px from its top left. */
export function placeOn(element: Element, { clientX, clientY }: MouseEvent): Place {
  const { left, top } = element.getBoundingClientRect();
  return { x: clientX - left, y: clientY - top };
}

/** Between two fingers, CSS px; 0: there is one. */
export function spreadOf(pointers: ReadonlyMap<number, Place>): number {
  const [a, b] = [...pointers.values()];
  return a && b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
}
