import { readFileSync } from "node:fs";
import { resolve } from "node:path";
import type { Plugin, Rollup } from "vite";

/** Of three.js and uikit, what is left out, and what stands in its place: modules of stand_ins.ts, which throw where one is used. */
const kLeftOut: Readonly<Record<string, readonly string[]>> = {
  "three/src/renderers/shaders/DFGLUTData.js": ["getDFGLUT"],
  "three/src/renderers/webgl/WebGLEnvironments.js": ["WebGLEnvironments"],
  "three/src/renderers/webgl/WebGLLights.js": ["WebGLLights"],
  "three/src/renderers/webgl/WebGLMorphtargets.js": ["WebGLMorphtargets"],
  "three/src/renderers/webgl/WebGLOutput.js": ["WebGLOutput"],
  "three/src/renderers/webgl/WebGLShadowMap.js": ["WebGLShadowMap"],
  "three/src/renderers/webgl/WebGLUniformsGroups.js": ["WebGLUniformsGroups"],
  "three/src/renderers/webxr/WebXRDepthSensing.js": ["WebXRDepthSensing"],
  "@pmndrs/uikit/dist/panel/material/depth.js": [
    "PanelDepthMaterial",
    "PanelDistanceMaterial",
    "instancedPanelDepthMaterial",
    "instancedPanelDistanceMaterial",
  ],
  "@pmndrs/uikit/dist/panel/material/presets.js": ["materialClasses", "resolvePanelMaterialClassProperty"],
};

/** Materials that may be used: those whose shaders are there, or that bring their own. */
const kMaterials = ["LineBasicMaterial", "MeshBasicMaterial", "RawShaderMaterial", "ShaderMaterial"];
/** Of ShaderLib, what draws them, and the pieces of shaders that are asked for by their names alone. */
const kShaders = ["basic"];
const kPieces = ["meshbasic_vert", "meshbasic_frag", "colorspace_pars_fragment", "normal_fragment_maps"];

const kInclude = /#include <(\w+)>/g;
const kLicence = "/** @license Copyright 2010-2026 Three.js Authors, SPDX-License-Identifier: MIT */\n";

/** The packages' file that a module is, from the package's name on. */
const inPackage = (id: string): string =>
  id.slice(id.lastIndexOf("/node_modules/") + "/node_modules/".length);

/** As three.js's own build has it: without comments, blank lines and indentation. */
function stripShader(code: string): string {
  return code.replace(/\/\* glsl \*\/\s*`([^`]*)`/g, (_, shader: string) => {
    const lines = shader
      .replace(/\/\*[^]*?\*\//g, "")
      .split("\n")
      .map((line) => line.replace(/\/\/.*$/, "").trim());
    return `\`${lines.filter((line) => line !== "").join("\n")}\``;
  });
}

/** ShaderLib.js with the shaders that are wanted alone: its properties that are others, within it and set later, go. */
function someShaders(code: string): string {
  const isWanted = (whole: string, name: string) => (kShaders.includes(name) ? whole : "");
  return code
    .replace(/^\t(\w+): \{\n[^]*?\n\t\},?\n/gm, isWanted)
    .replace(/^ShaderLib\.(\w+) = \{\n[^]*?\n\};\n/gm, isWanted);
}

/** ShaderChunk.js with those of its pieces alone that others include, or that are asked for. */
class Pieces {
  readonly names = new Set<string>();
  readonly code: string;

  constructor(file: string) {
    const code = readFileSync(file, "utf8");
    const sources = new Map<string, string>();
    for (const [, name, path] of code.matchAll(/^import (?:\* as )?(\w+) from '(.+)';$/gm)) {
      sources.set(name!, readFileSync(resolve(file, "..", path!), "utf8"));
    }
    const values = new Map<string, string>();
    for (const [, name, value] of code.matchAll(/^\t(\w+): ([\w.]+),?$/gm)) {
      values.set(name!, value!);
    }
    const take = (name: string): void => {
      const source = sources.get(values.get(name)?.split(".")[0] ?? "");
      if (source === undefined) {
        throw new Error(`three.js has no piece of shaders "${name}"`);
      }
      if (!this.names.has(name)) {
        this.names.add(name);
        [...source.matchAll(kInclude)].forEach(([, other]) => take(other!));
      }
    };
    kPieces.forEach(take);
    const taken = new Set([...this.names].map((name) => values.get(name)!.split(".")[0]));
    this.code = code
      .replace(/^import (?:\* as )?(\w+) from .+;\n/gm, (line, name: string) => (taken.has(name) ? line : ""))
      .replace(/^\t(\w+): [\w.]+,?\n/gm, (_, name: string) =>
        this.names.has(name) ? `\t${name}: ${values.get(name)},\n` : "",
      );
  }
}

/**
 * Of three.js the bundle has what the viewer draws with: module by module, so that each chunk has what it needs, with
 * stand-ins for what nothing uses, and the shaders of the materials that there are. What is missing is not found out in
 * a headset: the build fails where a material is used that is not drawn, where a shader includes what is not there, and
 * where three.js has changed.
 */
export function threeParts(): Plugin {
  const leftOut = new Set<string>();
  let pieces: Pieces | null = null;
  return {
    name: "three-parts",
    apply: "build",
    enforce: "pre",
    resolveId(source, importer) {
      return source === "three" ? this.resolve("three/src/Three.js", importer, { skipSelf: true }) : null;
    },
    load(id) {
      const file = inPackage(id);
      const names = kLeftOut[file];
      if (names) {
        leftOut.add(file);
        return `export { ${names.join(", ")} } from ${JSON.stringify(resolve("vite/stand_ins.ts"))};`;
      }
      if (file === "three/src/renderers/shaders/ShaderChunk.js") {
        pieces = new Pieces(id);
        return pieces.code;
      }
      return null;
    },
    transform(code, id) {
      const file = inPackage(id);
      if (file === "three/src/renderers/shaders/ShaderLib.js") {
        return someShaders(code);
      }
      if (file === "three/src/constants.js") {
        return kLicence + code;
      }
      return file.endsWith(".glsl.js") ? stripShader(code) : null;
    },
    generateBundle(_options, bundle) {
      for (const [id, code] of modulesOf(bundle)) {
        const material = /^three\/src\/materials\/(\w+Material)\.js$/.exec(inPackage(id))?.[1];
        if (material && material !== "Material" && !kMaterials.includes(material)) {
          this.error(`${material} is used, whose shader vite/three_parts.ts leaves out`);
        }
        for (const [, name] of code.matchAll(kInclude)) {
          if (!pieces!.names.has(name!)) {
            this.error(`${id} includes <${name!}>, which vite/three_parts.ts leaves out`);
          }
        }
      }
      const missed = Object.keys(kLeftOut).filter((file) => !leftOut.has(file));
      if (missed.length > 0) {
        this.error(`nothing asks for ${missed.join(", ")} any more; look at vite/three_parts.ts`);
      }
    },
  };
}

/** What is left of modules, by their files. */
function modulesOf(bundle: Rollup.OutputBundle): [string, string][] {
  return Object.values(bundle)
    .filter((part) => part.type === "chunk")
    .flatMap(({ modules }) =>
      Object.entries(modules).map(([id, { code }]): [string, string] => [id, code ?? ""]),
    );
}
