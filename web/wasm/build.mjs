// Compiles splat_order.cpp to WebAssembly, unless it is newer already.
// Usage: node wasm/build.mjs [OUTPUT]; the compiler is $CLIPGS_WASM_CXX or clang++-19.
import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync, statSync } from "node:fs";
import { dirname, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const folder = dirname(fileURLToPath(import.meta.url));
const source = resolve(folder, "splat_order.cpp");
const output =
  process.argv[2] ?? resolve(process.env.CLIPGS_WEB_OUT ?? resolve(folder, "../build"), "splat_order.wasm");

if (!existsSync(output) || statSync(output).mtimeMs < statSync(source).mtimeMs) {
  mkdirSync(dirname(output), { recursive: true });
  execFileSync(
    process.env.CLIPGS_WASM_CXX ?? "clang++-19",
    [
      "--target=wasm32-wasi",
      "-mexec-model=reactor",
      "-std=c++20",
      "-O3",
      "-msimd128",
      "-flto",
      "-fno-exceptions",
      "-fno-rtti",
      "-Wall",
      "-Wextra",
      "-Werror",
      "-fno-math-errno",
      "-Wl,--strip-all",
      "-o",
      output,
      source,
    ],
    { stdio: "inherit" },
  );
}
