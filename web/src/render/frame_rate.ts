/** Frames of a movement that say nothing about speed: they compile and upload. */
const kWarmUpFrames = 4;

/** Before resolution falls to this, … */
const kLeanScale = 0.7;
/** … what is drawn less of may be drawn at so much more, and is drawn again at full where frames take a third of the time. */
const kLeanGain = 1.4;
const kRichShare = 1 / 3;

/** How long frames take, and at which resolution and with how much they take no longer than they should. */
export class FrameRate {
  /** Between frames while something moves, ms; 0: none have been drawn yet. */
  frameMs = 0;
  /** Resolution while something moves, 1: full. */
  scale = 1;
  /** Whether to draw less while something moves. */
  lean = false;
  readonly #targetMs: number;
  readonly #minScale: number;
  #tick = -1; // of the last frame: its number and time
  #time = 0;
  #frames = 0;

  constructor(targetMs: number, minScale: number) {
    this.#targetMs = targetMs;
    this.#minScale = minScale;
  }

  /** Another case: what it costs is not known. */
  restart(): void {
    this.#frames = 0;
  }

  /** A frame is being drawn, at `now` ms; `tick` counts the frames that could have been. */
  count(now: number, tick: number): void {
    const elapsed = now - this.#time;
    const inRow = this.#tick === tick - 1;
    this.#tick = tick;
    this.#time = now;
    if (!inRow || ++this.#frames < kWarmUpFrames) {
      return;
    }
    this.frameMs = this.frameMs > 0 ? 0.8 * this.frameMs + 0.2 * elapsed : elapsed;
    const step = Math.min(1.05, Math.max(0.7, Math.sqrt(this.#targetMs / this.frameMs)));
    this.scale = Math.min(1, Math.max(this.#minScale, this.scale * step));
    if (!this.lean && this.scale < kLeanScale) {
      this.lean = true;
      this.scale = Math.min(1, kLeanGain * this.scale);
    } else if (this.lean && this.scale === 1 && this.frameMs < kRichShare * this.#targetMs) {
      this.lean = false;
    }
  }
}
