import { describe, expect, it } from "vitest";

import { shader } from "../../src/render/shaders";

describe("the shaders' text", () => {
  it("has each include once, and no loop over planes: one body for each instead", () => {
    const text = shader("splat.vert.glsl");
    expect(text).not.toMatch(/#include/);
    expect(text.match(/Splat project\(/g)).toHaveLength(1);
    expect(text).not.toMatch(/< kPlanes/);
    const bodies = [
      ...text.matchAll(/#if kPlanes > (\d)\n\{\nconst int i = (\d);\n\s*vPlane\[i\] = kUncut;\n\}\n#endif/g),
    ];
    expect(bodies.map(([, least, i]) => [least, i])).toEqual(
      ["0", "1", "2", "3", "4", "5"].map((i) => [i, i]),
    );
  });
});
