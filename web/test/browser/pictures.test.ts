import { afterAll, beforeAll, describe, expect, it } from "vitest";
import type { Page } from "playwright-core";

import { shader } from "../../src/render/shaders";
import { coverage, pagePicture, psnr } from "./picture";
import { copyMadeCases } from "./made_cases";
import { missing } from "./program";
import { Session } from "./session";
import { choose, facesOf, rendered, renderedAndPrinted, type Shot, show } from "./shot";

const kMinAlike = 50; // dB of pictures that are drawn alike, pixel by pixel

const kViews: Shot["view"][] = [
  [0, 0, 1],
  [35, 20, 1],
  [-110, -30, 1.6],
  [0, 90, 1],
];
const kPlanes: Shot["plane"][] = [
  [0, -1, 0, 0],
  [0.5, 0.3, -0.6, 10],
];
/** Every plane with its faces drawn from the volume and by splats. */
const kShots: Shot[] = [
  ...kViews.map((view): Shot => ({ view, plane: null, clip: "exact" })),
  ...kPlanes.flatMap((plane) =>
    (["hard", "soft", "exact"] as const).flatMap((clip, i) => facesOf({ view: kViews[i]!, plane, clip })),
  ),
  ...facesOf({ view: [60, 10, 3], plane: [-1, 0, 0, -20], clip: "exact" }),
  // A slab and two planes more; a second plane alone.
  ...(["hard", "soft", "exact"] as const).flatMap((clip) =>
    facesOf({
      view: [30, 35, 1],
      plane: [0, 0, -1, -40],
      more: [
        [0.2, -1, 0.1, -20, 45],
        [1, 0.1, 0, -60],
      ],
      clip,
    }),
  ),
  ...facesOf({ view: [-40, 30, 1], plane: [0, -1, 0, 0], more: [[0, 0, -1, -30]], clip: "exact" }),
  // Face colours, at one plane and at three.
  ...(["hard", "soft", "exact"] as const).map(
    (clip, i): Shot => ({ name: "solid", view: kViews[i]!, plane: kPlanes[1]!, clip, section: "splats" }),
  ),
  {
    name: "solid",
    view: [-40, 30, 1.1],
    plane: [0, -1, 0, 0],
    more: [
      [0, 0, -1, -30],
      [1, 0.1, 0, -20, 30],
    ],
    clip: "exact",
    section: "splats",
  },
  ...[0, 1].map(
    (grey): Shot => ({
      name: "photo",
      view: [35, 20, 1],
      plane: [0.2, -1, 0.3, 5],
      clip: "exact",
      section: "volume",
      grey,
    }),
  ),
  { view: [35, 20, 1], plane: [0, -1, 0, 0], clip: "exact", section: "volume", grey: 1, shades: [40, 400] },
  {
    view: [20, 60, 1],
    plane: [0.1, 0, -1, 10],
    clip: "exact",
    section: "volume",
    grey: 0.5,
    shades: [-300, 900],
  },
];

/** Φ, integrated by Simpson's rule. */
function normalCdf(z: number): number {
  const kSteps = 2000;
  const density = (x: number) => Math.exp(-0.5 * x * x) / Math.sqrt(2 * Math.PI);
  let sum = density(0) + density(z);
  for (let i = 1; i < kSteps; ++i) {
    sum += (i % 2 === 1 ? 4 : 2) * density((z * i) / kSteps);
  }
  return 0.5 + (sum * z) / (3 * kSteps);
}

/** In the page: what the shaders' normalCdf gives, as the GPU computes it. */
function runNormalCdf({ text, at }: { text: string; at: number[] }): number[] {
  const gl = new OffscreenCanvas(1, 1).getContext("webgl2")!;
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

describe.skipIf(missing !== undefined)(`pictures${missing ? ` (${missing} is missing)` : ""}`, () => {
  const session = new Session();
  const errors: string[] = [];
  let page: Page;

  beforeAll(async () => {
    await session.start(() => copyMadeCases(session));
    // What the page itself shows is small: it is drawn, too, whenever something changes.
    page = await session.open("#case=phantom&size=64x64", errors, { width: 64, height: 64 });
    await page.evaluate(() => window.clipgs.ready);
  });

  afterAll(async () => {
    expect(errors).toEqual([]);
    expect(await session.stop(), "exit status of clipgs serve").toBe(0);
  });

  for (const shot of kShots) {
    const style = `${shot.grey ? `, grey ${shot.grey} ${shot.shades?.join() ?? ""}` : ""}${shot.name ? `, ${shot.name}` : ""}`;
    const more = shot.more?.map((numbers) => ` and ${numbers.join()}`).join("") ?? "";
    const cut = shot.plane ? `plane ${shot.plane.join()}${more}, ${shot.clip}, ${shot.section}` : "uncut";
    it(`equals clipgs render: view ${shot.view.join()}, ${cut}${style}`, async () => {
      const truth = await rendered(page, session, shot, "210x154");
      await choose(page, shot.name ?? "phantom");
      await show(page, shot);
      const got = await pagePicture(page, truth.width, truth.height);
      expect(coverage(truth)).toBeGreaterThan(0.03);
      const { color, alpha } = psnr(got, truth);
      expect(color).toBeGreaterThan(kMinAlike);
      expect(alpha).toBeGreaterThan(kMinAlike);
    });
  }

  it("draws states by layers as clipgs render does, and other cuts exactly", async () => {
    await choose(page, "layered");
    const none: Shot = { name: "layered", view: [25, 30, 1], plane: null, clip: "layers", section: "splats" };
    for (const state of [60, 110, 150]) {
      const options = ["--state", String(state)];
      const { picture: truth } = await renderedAndPrinted(page, session, none, "210x154", options);
      await show(page, none);
      await page.evaluate((k) => window.clipgs.setState(k), state);
      const got = await pagePicture(page, truth.width, truth.height);
      expect(coverage(truth)).toBeGreaterThan(0.03);
      expect(psnr(got, truth).color, `state ${state}`).toBeGreaterThan(kMinAlike);
      expect(psnr(got, truth).alpha, `state ${state}`).toBeGreaterThan(kMinAlike);
      await page.evaluate(() => window.clipgs.setClip("exact"));
      const exact = await pagePicture(page, truth.width, truth.height);
      expect(psnr(exact, truth).color, `state ${state}`).toBeLessThan(kMinAlike - 5);
    }
    const pictures = [];
    for (const clip of ["layers", "exact"] as const) {
      await show(page, { ...none, plane: [0.2, -1, -0.1, 0], clip });
      pictures.push(await pagePicture(page, 160, 160));
    }
    expect(pictures[0]!.data).toEqual(pictures[1]!.data);
    await choose(page, "phantom");
  });

  it("cuts more or less as the plane moves", async () => {
    const at = async (offset: number) => {
      await show(page, { view: [0, 0, 1], plane: [0, 0, -1, offset], clip: "exact" });
      return pagePicture(page, 160, 160);
    };
    const most = await at(-120);
    const half = await at(0);
    const little = await at(120);
    expect(coverage(most)).toBeGreaterThan(1.3 * coverage(half));
    expect(coverage(half)).toBeGreaterThan(1.3 * coverage(little));
    expect(psnr(most, half).color).toBeLessThan(20);
  });

  it("has no holes in a face wherever its plane is", async () => {
    for (let step = 0; step < 12; ++step) {
      const shot: Shot = { view: [20, 40, 1], plane: [0, 0.1, -1, 7.3 - 3.1 * step], clip: "exact" };
      const truth = await rendered(page, session, shot, "128x128");
      await show(page, shot);
      const got = await pagePicture(page, 128, 128);
      let holes = 0;
      for (let i = 3; i < got.data.length; i += 4) {
        holes += truth.data[i]! === 255 && got.data[i]! < 230 ? 1 : 0;
      }
      expect(holes, `plane ${shot.plane!.join()}`).toBe(0);
      expect(psnr(got, truth).alpha).toBeGreaterThan(kMinAlike);
      expect(psnr(got, truth).color).toBeGreaterThan(kMinAlike);
    }
  });

  it("has a Φ that is the normal distribution's to 1.5e-4", async () => {
    const at = Array.from({ length: 1601 }, (_, i) => 0.01 * i - 8);
    const got = await page.evaluate(runNormalCdf, { text: shader("gaussian.glsl"), at });
    at.forEach((z, i) => {
      expect(Math.abs(got[i]! - normalCdf(z)), `Φ(${z.toFixed(2)}) = ${got[i]}`).toBeLessThan(1.5e-4);
    });
  });

  it("tells the three operators apart", async () => {
    const pictures = [];
    for (const clip of ["hard", "soft", "exact"] as const) {
      await show(page, { view: [0, 0, 1], plane: [0, -1, 0, 0], clip, section: "splats" });
      pictures.push(await pagePicture(page, 160, 160));
    }
    for (const [a, b] of [
      [0, 1],
      [1, 2],
      [0, 2],
    ] as const) {
      const { color } = psnr(pictures[a]!, pictures[b]!);
      expect(color).toBeGreaterThan(20); // a cut of the same thing
      expect(color).toBeLessThan(58); // equal pictures have no error at all
    }
  });
});
