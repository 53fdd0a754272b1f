import { resolve } from "node:path";
import { build } from "vite";
import { expect, it, vi } from "vitest";

import { threeParts } from "../../vite/three_parts";

vi.setConfig({ testTimeout: 60_000 }); // three.js is bundled each time

/** What a bundle of `code`, which draws with three.js and uikit, is: its text. */
async function bundle(code: string): Promise<string> {
  const kEntry = resolve("test/unit/entry.js"); // no such file: its text is this
  const made = await build({
    configFile: false,
    logLevel: "silent",
    plugins: [
      threeParts(),
      {
        name: "entry",
        resolveId: (id) => (id === kEntry ? id : null),
        load: (id) => (id === kEntry ? code : null),
      },
    ],
    resolve: {
      alias: {
        "@pmndrs/msdfonts/inter": resolve("src/xr/panel/no_font.ts"),
        "@zappar/msdf-generator": resolve("src/xr/panel/no_font.ts"),
      },
    },
    build: { write: false, minify: false, lib: { entry: kEntry, formats: ["es"] } },
  });
  const [{ output }] = made as unknown as [{ output: { code?: string }[] }];
  return output.map((part) => part.code ?? "").join("\n");
}

const kDrawn = 'export { WebGLRenderer, MeshBasicMaterial } from "three";\n';

it("leaves shaders out that nothing is drawn by", async () => {
  const code = await bundle(`${kDrawn}export { Container } from "@pmndrs/uikit";`);
  expect(code).toContain("meshbasic_frag");
  expect(code).not.toMatch(/meshphysical|RE_Direct|PMREM_|VSM_SAMPLES/);
  expect(code).toContain("Copyright 2010-2026 Three.js Authors");
});

it("fails where a material is used whose shader is left out", async () => {
  await expect(bundle(`${kDrawn}export { MeshLambertMaterial } from "three";`)).rejects.toThrow(
    /MeshLambertMaterial is used/,
  );
});

it("fails where a shader includes what is left out", async () => {
  await expect(bundle(`${kDrawn}export const shader = "#include <lights_pars_begin>";`)).rejects.toThrow(
    /entry\.js includes <lights_pars_begin>/,
  );
});

it("fails where nothing asks for what is left out", async () => {
  await expect(bundle(kDrawn)).rejects.toThrow(/uikit\/.* any more/);
});
