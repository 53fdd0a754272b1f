/** CSS px. */
export interface Place {
  x: number;
  y: number;
}

export interface Size {
  width: number;
  height: number;
}

/** A label, the place that it is about, and from point to point the line there, which no label is to cover. */
export interface Label extends Size {
  anchor: Place;
  line?: readonly Place[];
}

/** Between a label and its anchor, and between labels, px. */
const kGap = 9;
const kApart = 3;
/** How much of an anchor's dot no label is to cover, px. */
const kDot = 6;
/** How wide lines are that no label is to cover, px. */
const kLine = 6;

interface Box extends Place, Size {}

/** Where a label may stand: to the right first, then around its anchor, nearer places before farther ones. */
function candidates({ anchor: { x, y }, width, height }: Label): Place[] {
  const rings = [kGap, kGap + height + kApart, kGap + 2 * (height + kApart)];
  return rings.flatMap((gap) => [
    { x: x + gap, y: y - 0.5 * height },
    { x: x - gap - width, y: y - 0.5 * height },
    { x: x - 0.5 * width, y: y - gap - height },
    { x: x - 0.5 * width, y: y + gap },
    { x: x + gap, y: y - gap - height },
    { x: x - gap - width, y: y - gap - height },
    { x: x + gap, y: y + gap },
    { x: x - gap - width, y: y + gap },
  ]);
}

/** Of two boxes, px². */
function overlap(a: Box, b: Box): number {
  const width = Math.min(a.x + a.width, b.x + b.width) - Math.max(a.x, b.x);
  const height = Math.min(a.y + a.height, b.y + b.height) - Math.max(a.y, b.y);
  return width > 0 && height > 0 ? width * height : 0;
}

/** How much of a straight line lies within a box, px. */
function within(box: Box, from: Place, to: Place): number {
  // Most lines are elsewhere, and are asked for every place of every label.
  if (
    Math.max(from.x, to.x) < box.x ||
    Math.min(from.x, to.x) > box.x + box.width ||
    Math.max(from.y, to.y) < box.y ||
    Math.min(from.y, to.y) > box.y + box.height
  ) {
    return 0;
  }
  const spans = (low: number, size: number, begin: number, end: number): [number, number] => {
    if (begin === end) {
      return low <= begin && begin <= low + size ? [0, 1] : [1, 0];
    }
    const [a, b] = [(low - begin) / (end - begin), (low + size - begin) / (end - begin)];
    return [Math.min(a, b), Math.max(a, b)];
  };
  const across = spans(box.x, box.width, from.x, to.x);
  const down = spans(box.y, box.height, from.y, to.y);
  const share = Math.min(1, across[1], down[1]) - Math.max(0, across[0], down[0]);
  return Math.max(0, share) * Math.hypot(to.x - from.x, to.y - from.y);
}

/** How much of a box lies beyond the picture, px². */
function beyond(box: Box, { width, height }: Size): number {
  return box.width * box.height - overlap(box, { x: 0, y: 0, width, height });
}

/**
 * The top left corners of labels in a picture, which keep clear of each other, of all anchors and lines and of its edges
 * where there is room: the earlier ones first. A label goes where it was `before` while that is clear, so that labels do not jump.
 */
export function layOut(
  labels: readonly Label[],
  picture: Size,
  before: readonly (number | undefined)[] = [],
): { at: Place; choice: number }[] {
  const dots = labels.map(({ anchor: { x, y } }) => ({
    x: x - kDot,
    y: y - kDot,
    width: 2 * kDot,
    height: 2 * kDot,
  }));
  const lines = labels.flatMap(({ line = [] }) => line.slice(1).map((to, k) => [line[k]!, to] as const));
  const placed: Box[] = [];
  return labels.map((label, i) => {
    const places = candidates(label);
    const boxes = places.map((place) => ({ ...place, width: label.width, height: label.height }));
    const cost = (box: Box): number => {
      const wide = {
        x: box.x - kApart,
        y: box.y - kApart,
        width: box.width + 2 * kApart,
        height: box.height + 2 * kApart,
      };
      const others = placed.reduce((sum, other) => sum + overlap(wide, other), 0);
      const covered = dots.reduce((sum, dot) => sum + overlap(box, dot), 0);
      const crossed = lines.reduce((sum, [from, to]) => sum + kLine * within(box, from, to), 0);
      return others + covered + crossed + 2 * beyond(box, picture);
    };
    const last = before[i];
    let choice = last !== undefined && cost(boxes[last]!) === 0 ? last : -1;
    if (choice < 0) {
      const costs = boxes.map(cost);
      choice = costs.indexOf(Math.min(...costs));
    }
    placed.push(boxes[choice]!);
    return { at: places[choice]!, choice };
  });
}
