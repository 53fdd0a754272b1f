// The order of drawing around the splats, or their picture, which have 0.

export const kBehindSplats = -1;
export const kBeforeSplats = 1;
export const kOnTop = 2;
