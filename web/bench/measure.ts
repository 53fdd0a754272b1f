/** Of an odd number of values, the one in the middle. */
export function median(values: readonly number[]): number {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[sorted.length >> 1]!;
}

/** A table in Markdown. */
export function table(head: readonly string[], rows: readonly (readonly string[])[]): string {
  const lines = [head, head.map(() => "---"), ...rows].map((cells) => `| ${cells.join(" | ")} |`);
  return lines.join("\n");
}

/** Pixels that benchmarks draw for one of a page, without a GPU: fewer than tests would tell nothing of frames. */
export const kScale = 0.5;
/** What the viewer is seen in. */
export const kPage = { width: 900, height: 600, scale: kScale };
