import type { XRDevice } from "iwer";

declare global {
  interface Window {
    /** The emulated Quest 3, where a test has one. */
    headset: XRDevice;
    /** Strengths of what was felt in the right hand, where a test listens. */
    ticks: number[];
  }
}
