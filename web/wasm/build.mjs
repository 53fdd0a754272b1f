// Compiles splat_order.cpp and cut_light.cpp to WebAssembly, where they are newer than what was made of them.
// Usage: node wasm/build.mjs [FOLDER]; the compiler is $CLIPGS_WASM_CXX or clang++-19.
import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync, readdirSync, statSync } from "node:fs";
import { dirname, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const folder = dirname(fileURLToPath(import.meta.url));
const program = resolve(folder, "../../src");
const output = resolve(process.argv[2] ?? process.env.CLIPGS_WEB_OUT ?? resolve(folder, "../build"));

const kFlags = [
  "--target=wasm32-wasi",
  "-mexec-model=reactor",
  "-std=c++20",
  "-Os",
  "-msimd128",
  "-flto",
  "-fno-rtti",
  "-Wall",
  "-Wextra",
  "-Werror",
  "-fno-math-errno",
  "-Wl,--strip-all",
];

/** Sources of the program itself; `headers` are the folders that they include. */
const kModules = [
  { name: "splat_order", flags: ["-fno-exceptions"], sources: [], headers: [] },
  {
    name: "cut_light",
    // What stands in wasm/core comes before the program's own; GLM is headers alone, after those of the target.
    flags: ["-I", folder, "-I", program, "-idirafter", "/usr/include"],
    sources: [
      ...["openings", "section_light", "section", "material_table", "value_curve"].map(
        (file) => `section/${file}.cpp`,
      ),
      ...["cut_light", "empty_space", "occluders", "patches"].map((file) => `light/${file}.cpp`),
      ...["geometry", "srgb"].map((file) => `core/${file}.cpp`),
    ],
    headers: ["section", "light", "core", "volume"],
  },
];

/** When the newest of some files was written. */
const newest = (files) => Math.max(...files.map((file) => statSync(file).mtimeMs));

mkdirSync(output, { recursive: true });
for (const { name, flags, sources, headers } of kModules) {
  const module = resolve(output, `${name}.wasm`);
  const files = [resolve(folder, `${name}.cpp`), ...sources.map((file) => resolve(program, file))];
  const included = headers.flatMap((room) =>
    readdirSync(resolve(program, room))
      .filter((file) => file.endsWith(".h"))
      .map((file) => resolve(program, room, file)),
  );
  if (!existsSync(module) || statSync(module).mtimeMs < newest([...files, ...included])) {
    execFileSync(process.env.CLIPGS_WASM_CXX ?? "clang++-19", [...kFlags, ...flags, "-o", module, ...files], {
      stdio: "inherit",
    });
  }
}
