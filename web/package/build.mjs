// Makes the package `clipgs-viewer` in FOLDER/clipgs-viewer (the element, its types, worker and WebAssembly) and packs
// it as FOLDER/clipgs-viewer-VERSION.tgz. Usage: node package/build.mjs [FOLDER]
import { execFileSync } from "node:child_process";
import {
  copyFileSync,
  existsSync,
  mkdirSync,
  mkdtempSync,
  readFileSync,
  rmSync,
  writeFileSync,
} from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { build, loadConfigFromFile } from "vite";

const web = resolve(dirname(fileURLToPath(import.meta.url)), "..");
const folder = resolve(process.argv[2] ?? process.env.CLIPGS_WEB_OUT ?? resolve(web, "build"));
const output = resolve(folder, "clipgs-viewer");
process.chdir(web);

/** The packages that modules come from. */
function packagesOf(modules) {
  const inside = [...modules].map((id) => /^.*\/node_modules\/(?:@[^/]+\/)?[^/]+(?=\/)/.exec(id)?.[0]);
  return [...new Set(inside.filter((folder) => folder !== undefined))].sort();
}

/** The licence of what is in the package, as its own licence asks for. */
function licenceOf(folder) {
  const { name, version, license } = JSON.parse(readFileSync(`${folder}/package.json`, "utf8"));
  const file = ["LICENSE", "LICENSE.md", "LICENSE.txt", "license", "COPYING"].find((one) =>
    existsSync(`${folder}/${one}`),
  );
  const text = file ? readFileSync(`${folder}/${file}`, "utf8").trim() : license;
  const held = kHeld[name] ? `\n${readFileSync(kHeld[name], "utf8")}` : "";
  return `${name} ${version}\n\n${text}\n${held}`;
}

/** Of what packages hold besides their own. */
const kHeld = {
  "@cwasm/webp": "package/LICENSE-libwebp",
  ogv: "node_modules/ogv/dist/COPYING-dav1d.txt",
};

/** Takes over a file of types, and those that it names. */
function copyTypes(name) {
  const text = readFileSync(`${declared}/${name}.d.ts`, "utf8");
  const file = `${output}/${name}.d.ts`;
  mkdirSync(dirname(file), { recursive: true });
  writeFileSync(file, text.replace(/from "(\.[^"]+)"/g, 'from "$1.js"'));
  for (const [, other] of text.matchAll(/from "(\.[^"]+)"/g)) {
    copyTypes(join(dirname(name), other));
  }
}

const { config } = await loadConfigFromFile({ command: "build", mode: "production" }, "vite.config.ts");
const bundled = new Set();
/** Builds src/ENTRY.ts with some of the page's plugins, without the packages that are those of who uses it. */
function bundle(entry, plugins, external, emptyOutDir) {
  return build({
    ...config,
    configFile: false,
    logLevel: "warn",
    plugins: [
      ...config.plugins.filter(({ name }) => plugins.includes(name)),
      {
        name: "bundled",
        generateBundle() {
          for (const id of this.getModuleIds()) {
            bundled.add(id);
          }
        },
      },
    ],
    resolve: {
      alias: { ...config.resolve.alias, "./start_workers": resolve(web, "package/inline_workers.ts") },
    },
    worker: { format: "es", rollupOptions: { output: { inlineDynamicImports: true } } },
    build: {
      ...config.build,
      outDir: output,
      emptyOutDir,
      copyPublicDir: false,
      assetsDir: "",
      minify: "esbuild", // whoever bundles it does that again
      assetsInlineLimit: (file) => file.endsWith(".wasm"), // of workers, which have no address
      modulePreload: false,
      rollupOptions: {
        input: `src/${entry}.ts`,
        external,
        preserveEntrySignatures: "strict",
        output: { entryFileNames: `${entry}.js` },
      },
    },
  });
}

await bundle("index", ["three-parts", "strip-shaders", "lean-models"], [], true);
await bundle("three", ["strip-shaders"], ["three"], false);
const declared = mkdtempSync(join(tmpdir(), "clipgs-types-"));
execFileSync("node_modules/.bin/tsc", ["-p", "package/tsconfig.json", "--outDir", declared], {
  stdio: "inherit",
});
copyTypes("index");
copyTypes("three");
rmSync(declared, { recursive: true });

const { name, description, license, dependencies } = JSON.parse(readFileSync("package.json", "utf8"));
const version = /project\(clipgs VERSION ([\d.]+)/.exec(readFileSync("../CMakeLists.txt", "utf8"))[1];
const manifest = {
  name,
  version,
  description,
  license,
  author: "The clipgs developers",
  keywords: [
    "gaussian-splatting",
    "medical-imaging",
    "volume-rendering",
    "ct",
    "mri",
    "clipping",
    "three.js",
    "web-components",
    "webxr",
  ],
  type: "module",
  exports: {
    ".": { types: "./index.d.ts", default: "./index.js" },
    "./three": { types: "./three.d.ts", default: "./three.js" },
    "./custom-elements.json": "./custom-elements.json",
    "./package.json": "./package.json",
  },
  main: "./index.js",
  module: "./index.js",
  types: "./index.d.ts",
  unpkg: "./index.js",
  jsdelivr: "./index.js",
  sideEffects: ["./index*.js"], // they define the element
  customElements: "./custom-elements.json",
  peerDependencies: { three: `>=${dependencies.three.split(".").slice(0, 2).join(".")}` },
  peerDependenciesMeta: { three: { optional: true } }, // of clipgs-viewer/three alone
};
writeFileSync(`${output}/package.json`, `${JSON.stringify(manifest, null, 2)}\n`);
copyFileSync("package/custom-elements.json", `${output}/custom-elements.json`);
copyFileSync("package/README.md", `${output}/README.md`);
copyFileSync("../LICENSE", `${output}/LICENSE`);
writeFileSync(
  `${output}/LICENSES-OF-OTHERS`,
  packagesOf(bundled)
    .map(licenceOf)
    .join(`\n${"-".repeat(80)}\n\n`),
);
execFileSync("npm", ["pack", "--silent", "--pack-destination", folder, output], { stdio: "inherit" });
