// The order of drawing around the splats, or their picture, which have 0.

export const kBehindSplats = -1;
export const kBeforeSplats = 1;
export const kOnTop = 2;
/** In a headset, what stands beside the case, each where its depth is, and rays that lie upon that. */
export const kBesideCase = 3;
export const kUponThings = 4;
/** Over the case, whatever its depth. */
export const kOverCase = 10;
