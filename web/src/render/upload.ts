import { type Data3DTexture, Vector3, type WebGLRenderer } from "three";

/**
 * Gives a volume to the GPU, some slices at a time, so that the page can do other things in between: `piece` makes a
 * texture of those from z on. Ends early where that is no longer `wanted`. Returns whether the GPU was lost meanwhile: a
 * new one is then given all of it at once.
 */
export async function uploadInPieces(
  renderer: WebGLRenderer,
  texture: Data3DTexture,
  piece: (z: number, depth: number) => Data3DTexture,
  slices: number,
  wanted: () => boolean,
): Promise<boolean> {
  const { depth: all } = texture.image;
  let lost = false;
  const lose = (): void => void (lost = true);
  renderer.domElement.addEventListener("webglcontextlost", lose);
  texture.source.dataReady = false; // only memory is asked for
  for (let z = 0; z < all && wanted(); z += slices) {
    const depth = Math.min(slices, all - z);
    renderer.copyTextureToTexture(piece(z, depth), texture, null, new Vector3(0, 0, z));
    if (z + depth < all) {
      await new Promise((resolve) => setTimeout(resolve));
    }
  }
  renderer.domElement.removeEventListener("webglcontextlost", lose);
  texture.source.dataReady = true; // from now on three.js gives all of it to a new context
  if (lost) {
    texture.needsUpdate = true;
  }
  return lost;
}
