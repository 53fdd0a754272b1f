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

/** The smallest box around these places, and so much more on every side. */
function boxAround(places: readonly Place[], margin = 0): Box {
  const x = places.map((place) => place.x);
  const y = places.map((place) => place.y);
  const [left, top] = [Math.min(...x) - margin, Math.min(...y) - margin];
  return {
    x: left,
    y: top,
    width: Math.max(...x) + margin - left,
    height: Math.max(...y) + margin - top,
  };
}

function touch(a: Box, b: Box): boolean {
  return a.x <= b.x + b.width && b.x <= a.x + a.width && a.y <= b.y + b.height && b.y <= a.y + a.height;
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
  const dots = labels.map(({ anchor }) => boxAround([anchor], kDot));
  const lines = labels.flatMap(({ line = [] }) =>
    line.slice(1).map((to, k) => ({ from: line[k]!, to, box: boxAround([line[k]!, to]) })),
  );
  const placed: Box[] = [];
  return labels.map((label, i) => {
    const { width, height } = label;
    const boxes = candidates(label).map((place) => ({ ...place, width, height }));
    // Most of what is to be kept clear of is far from all places of this label.
    const reach = boxAround(
      [...boxes, ...boxes.map(({ x, y }) => ({ x: x + width, y: y + height }))],
      kApart,
    );
    const nearPlaced = placed.filter((box) => touch(box, reach));
    const nearDots = dots.filter((dot) => touch(dot, reach));
    const nearLines = lines.filter(({ box }) => touch(box, reach));
    /** Of a place; no less than `enough` where it is no less than that. */
    const cost = (box: Box, enough: number): number => {
      const wide = {
        x: box.x - kApart,
        y: box.y - kApart,
        width: width + 2 * kApart,
        height: height + 2 * kApart,
      };
      let sum = 2 * beyond(box, picture);
      for (let k = 0; k < nearPlaced.length && sum < enough; ++k) {
        sum += overlap(wide, nearPlaced[k]!);
      }
      for (let k = 0; k < nearDots.length && sum < enough; ++k) {
        sum += overlap(box, nearDots[k]!);
      }
      for (let k = 0; k < nearLines.length && sum < enough; ++k) {
        const { from, to } = nearLines[k]!;
        sum += kLine * within(box, from, to);
      }
      return sum;
    };
    const last = before[i];
    let choice = 0;
    if (last !== undefined && cost(boxes[last]!, Infinity) === 0) {
      choice = last;
    } else {
      let least = Infinity;
      for (let k = 0; k < boxes.length && least > 0; ++k) {
        const its = cost(boxes[k]!, least);
        if (its < least) {
          [choice, least] = [k, its];
        }
      }
    }
    const box = boxes[choice]!;
    placed.push(box);
    return { at: box, choice };
  });
}
