import { type Data3DTexture, Vector3, type WebGLRenderer } from "three";

/**
 * Gives a volume to the GPU, some slices at a time, so that the page can do other things in between: `piece` makes a
 * texture of those from z on. Ends early where that is no longer `wanted`.
 */
export async function uploadInPieces(
  renderer: WebGLRenderer,
  texture: Data3DTexture,
  piece: (z: number, depth: number) => Data3DTexture,
  slices: number,
  wanted: () => boolean,
): Promise<void> {
  const { depth: all } = texture.image;
  texture.source.dataReady = false; // only memory is asked for
  for (let z = 0; z < all && wanted(); z += slices) {
    const depth = Math.min(slices, all - z);
    renderer.copyTextureToTexture(piece(z, depth), texture, null, new Vector3(0, 0, z));
    if (z + depth < all) {
      await new Promise((resolve) => setTimeout(resolve));
    }
  }
  texture.source.dataReady = true; // from now on three.js gives all of it to a new context
}
