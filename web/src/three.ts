export { ClippableSplats } from "./clippable_splats";
export type { ClippableSplatsEventMap } from "./clippable_splats";
export type { ClipOperator, FaceSource, GreyWindow } from "./api";
