/** Takes steps until there are no more: `each` of them at once, and as many before every frame that the browser draws. Returns what stops it. */
export function inSlices(steps: Iterator<unknown>, each: number): () => void {
  let frame = 0;
  const work = (): void => {
    for (let i = 0; i < each; ++i) {
      if (steps.next().done) {
        return;
      }
    }
    frame = requestAnimationFrame(work);
  };
  work();
  return () => cancelAnimationFrame(frame);
}
