import { Color, DoubleSide, ShaderMaterial, Vector3 } from "three";

import { shader } from "../render/shaders";

/** What hands and controllers are made of, under lights that stand still in the room: all else there has colours of its own. */
export function inputMaterial(): ShaderMaterial {
  return new ShaderMaterial({
    side: DoubleSide, // the models' seams are not tight
    vertexShader: shader("input.vert.glsl"),
    fragmentShader: shader("input.frag.glsl"),
    uniforms: {
      uColor: { value: new Color(0xc9d3dd) },
      uSky: { value: new Color(0xdfe8f2).multiplyScalar(1.4) },
      uGround: { value: new Color(0x4a4640).multiplyScalar(1.4) },
      uLamp: { value: new Color(1.6, 1.6, 1.6) },
      uTowardsLamp: { value: new Vector3(0.4, 1, 0.7).normalize() },
    },
  });
}
