import { createHash } from "node:crypto";
import { readFileSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { brotliCompressSync, constants, gzipSync } from "node:zlib";
import type { Plugin } from "vite";
import { defineConfig } from "vitest/config";
import type { Reporter } from "vitest/reporters";

import { leanModels } from "./vite/lean_models";
import { threeParts } from "./vite/three_parts";

// CLIPGS_WEB_OUT: where the WASM module is and the bundle goes; the build of the C++ program sets it.
const out = resolve(process.env["CLIPGS_WEB_OUT"] ?? "build");

/** The page asks for the viewer's code at once, not when its beginning has run. */
const preloadPage: Plugin = {
  name: "preload-page",
  transformIndexHtml: {
    order: "post",
    handler(_html, { bundle }) {
      const page = Object.values(bundle ?? {}).find((part) => part.type === "chunk" && part.name === "page");
      return (
        page && [
          { tag: "link", attrs: { rel: "modulepreload", crossorigin: true, href: `./${page.fileName}` } },
        ]
      );
    },
  },
};

/** The page's styles lie within it: what is seen first waits for nothing else. */
const inlineStyles: Plugin = {
  name: "inline-styles",
  transformIndexHtml: {
    order: "post",
    handler(html, { bundle = {} }) {
      return html.replace(/<link rel="stylesheet"[^>]*href="\.\/([^"]+)">/, (link, file: string) => {
        const styles = bundle[file];
        delete bundle[file];
        return styles?.type === "asset" ? `<style>${String(styles.source)}</style>` : link;
      });
    },
  },
};

/** The layout engine of the headset's panel is WebAssembly in base 64: as a file it is a third smaller, compressed. */
const unpackYoga: Plugin = {
  name: "unpack-yoga",
  apply: "build",
  transform(code, id) {
    if (!id.endsWith("yoga-wasm-base64-esm.js")) {
      return null;
    }
    const [address, base64] = /data:application\/octet-stream;base64,([\w+/=]+)/.exec(code)!;
    const source = Buffer.from(base64!, "base64");
    const name = `yoga-${createHash("sha256").update(source).digest("base64url").slice(0, 8)}.wasm`;
    this.emitFile({ type: "asset", fileName: `assets/${name}`, source }); // beside the code, where it is looked for
    return code.replace(address, name);
  },
};

/** Comments of shaders are for those who read the source. */
const stripShaders: Plugin = {
  name: "strip-shaders",
  apply: "build",
  enforce: "pre",
  load(id) {
    const [file, query] = id.split("?");
    if (!file!.endsWith(".glsl") || query !== "raw") {
      return null;
    }
    const lines = readFileSync(file!, "utf8").split("\n");
    const code = lines.map((line) => line.replace(/\/\/.*$/, "").trimEnd()).filter((line) => line !== "");
    return `export default ${JSON.stringify(code.join("\n"))};`;
  },
};

/** Puts FILE.br and FILE.gz beside every file that they make smaller, as the server sends them. */
const compressFiles: Plugin = {
  name: "compress-files",
  apply: "build",
  writeBundle({ dir }, bundle) {
    for (const name of Object.keys(bundle)) {
      const file = join(dir!, name);
      const bytes = readFileSync(file);
      const best = { [constants.BROTLI_PARAM_SIZE_HINT]: bytes.length };
      for (const [ending, compressed] of [
        ["br", brotliCompressSync(bytes, { params: best })], // at its best, 11, as the default is
        ["gz", gzipSync(bytes, { level: 9 })],
      ] as const) {
        if (compressed.length < bytes.length) {
          writeFileSync(`${file}.${ending}`, compressed);
        }
      }
    }
  },
};

/** Says what passed at a second try alone: scripts/test.sh shows it, as it may hide a fault. */
const tellFlaky: Reporter = {
  onTestCaseResult(test) {
    if (test.diagnostic()?.flaky) {
      console.log(`needed a second try: ${test.fullName}: ${test.result().errors?.[0]?.message ?? ""}`);
    }
  },
};

export default defineConfig({
  base: "./",
  plugins: [threeParts(), preloadPage, inlineStyles, unpackYoga, stripShaders, leanModels, compressFiles],
  resolve: {
    alias: {
      "@wasm": out,
      // uikit's own fonts and its maker of fonts from TTF files: the viewer has another font, and none of these.
      "@pmndrs/msdfonts/inter": resolve("src/xr/panel/no_font.ts"),
      "@zappar/msdf-generator": resolve("src/xr/panel/no_font.ts"),
    },
  },
  build: {
    outDir: resolve(out, "dist"),
    emptyOutDir: true,
    target: "es2022",
    minify: "terser", // 2 % smaller than by default
    assetsInlineLimit: 0,
    chunkSizeWarningLimit: 800,
  },
  worker: { format: "es" },
  server: {
    fs: { allow: [".", out] },
    // `npm run dev` shows the cases of a running `clipgs serve`.
    proxy: { "/api": "http://127.0.0.1:8080", "/cases": "http://127.0.0.1:8080" },
    headers: { "Cross-Origin-Opener-Policy": "same-origin", "Cross-Origin-Embedder-Policy": "require-corp" },
  },
  test: {
    reporters: ["default", tellFlaky],
    projects: [
      { extends: true, test: { name: "unit", include: ["test/unit/**/*.test.ts"] } },
      {
        extends: true,
        test: {
          name: "browser",
          include: ["test/browser/**/*.test.ts"],
          globalSetup: "test/browser/cases.ts",
          retry: process.env["CI"] ? 1 : 0, // busy cores and software GL are late at times
          testTimeout: 300_000,
          expect: { poll: { timeout: 120_000 } },
          hookTimeout: 900_000, // trains cases
          poolOptions: { forks: { singleFork: true } },
        },
      },
    ],
  },
});
