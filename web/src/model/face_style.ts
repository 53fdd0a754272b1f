/**
 * What grey shows in gaps of a face that the window has black, in the order of kNeutralWalls and kGapValues of
 * shaders/face.glsl: the walls behind them, cinematic or of clay, or the gaps' values.
 */
export const kGreyOpenings = ["cinematic", "neutral", "values"] as const;
export type GreyOpenings = (typeof kGreyOpenings)[number];

/** How closely walls behind gaps are looked at: as `clipgs render` does, while things move, and where time is short. */
export type WallEffort = "fine" | "coarse" | "least";

/** What is drawn of a volume beside faces: where the body ends and its surface, where it ends, or nothing: splats alone. */
export type Detail = "surface" | "outline" | "splats";

/** What a pixel of a volume may cost. */
export interface FaceEffort {
  rays: number; // of faces
  /** Whether outlines and surfaces have as many as `clipgs render` gives them. */
  fine: boolean;
  walls: WallEffort;
  detail: Detail;
  /** Side of a pixel of the surface, in pixels of the picture. */
  surfacePixel: number;
}

/** WallSteps of shaders/face.glsl. */
export interface WallSteps {
  search: number;
  halvings: number;
  fine: number;
  growth: number;
  count: number;
}

export const kWallSteps: Readonly<Record<WallEffort, WallSteps>> = {
  fine: { search: 0.5, halvings: 3, fine: 0.1, growth: 1.3, count: 12 },
  coarse: { search: 1, halvings: 3, fine: 0.3, growth: 2, count: 3 },
  least: { search: 1.5, halvings: 0, fine: 1, growth: 1, count: 2 },
};
