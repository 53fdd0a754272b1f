/** What of a case is shown, beside the plane's handle. */
export interface Layers {
  /** The splats. They are left out only where cut faces are drawn from the volume: nothing would be seen else. */
  body: boolean;
  /** Cut faces from the volume; without them splats draw the faces. */
  faces: boolean;
  /** What is marked. */
  marks: boolean;
}

export const kAllLayers: Layers = { body: true, faces: true, marks: true };
