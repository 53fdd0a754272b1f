// Φ, as it is and as the shaders have it.

/** Φ, integrated by Simpson's rule. */
export function normalCdf(z: number): number {
  const kSteps = 2000;
  const density = (x: number) => Math.exp(-0.5 * x * x) / Math.sqrt(2 * Math.PI);
  let sum = density(0) + density(z);
  for (let i = 1; i < kSteps; ++i) {
    sum += (i % 2 === 1 ? 4 : 2) * density((z * i) / kSteps);
  }
  return 0.5 + (sum * z) / (3 * kSteps);
}

/** In the page: what the shaders' normalCdf gives, as the GPU computes it. */
export function runNormalCdf({ text, at }: { text: string; at: number[] }): number[] {
  const gl = document.createElement("canvas").getContext("webgl2")!;
  const program = gl.createProgram();
  const add = (type: number, source: string) => {
    const one = gl.createShader(type)!;
    gl.shaderSource(one, `#version 300 es\nprecision highp float;\nprecision highp int;\n${source}`);
    gl.compileShader(one);
    gl.attachShader(program, one);
  };
  add(gl.VERTEX_SHADER, `${text}\nin float z;\nout float share;\nvoid main() { share = normalCdf(z); }`);
  add(gl.FRAGMENT_SHADER, "out vec4 color;\nvoid main() { color = vec4(0.0); }");
  gl.transformFeedbackVaryings(program, ["share"], gl.INTERLEAVED_ATTRIBS);
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
    throw new Error(gl.getProgramInfoLog(program) ?? "no program");
  }
  gl.useProgram(program);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, Float32Array.from(at), gl.STATIC_DRAW);
  const place = gl.getAttribLocation(program, "z");
  gl.enableVertexAttribArray(place);
  gl.vertexAttribPointer(place, 1, gl.FLOAT, false, 0, 0);
  gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, gl.createBuffer());
  gl.bufferData(gl.TRANSFORM_FEEDBACK_BUFFER, 4 * at.length, gl.STREAM_READ);
  gl.enable(gl.RASTERIZER_DISCARD);
  gl.beginTransformFeedback(gl.POINTS);
  gl.drawArrays(gl.POINTS, 0, at.length);
  gl.endTransformFeedback();
  const shares = new Float32Array(at.length);
  gl.getBufferSubData(gl.TRANSFORM_FEEDBACK_BUFFER, 0, shares);
  return [...shares];
}
