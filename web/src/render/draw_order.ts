// The order of drawing around the splats, or their picture, which have 0.

export const kBehindSplats = -1;
/** What belongs to the same picture. */
export const kOverSplats = 0.5;
export const kBeforeSplats = 1;
export const kOnTop = 2;
