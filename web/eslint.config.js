import eslint from "@eslint/js";
import tseslint from "typescript-eslint";

// How code is laid out is prettier's; what it means is looked at here, with its types.
export default tseslint.config(
  { ignores: ["bench/peers", "src/**/*.d.ts"] },
  eslint.configs.recommended,
  tseslint.configs.strictTypeChecked,
  tseslint.configs.stylisticTypeChecked,
  {
    languageOptions: { parserOptions: { project: true, tsconfigRootDir: import.meta.dirname } },
    linterOptions: { reportUnusedDisableDirectives: "error" },
    rules: {
      "@typescript-eslint/dot-notation": "off", // of what has an index signature, names in quotes are the honest ones
      "@typescript-eslint/no-confusing-void-expression": ["error", { ignoreArrowShorthand: true }],
      "@typescript-eslint/no-dynamic-delete": "off",
      "@typescript-eslint/no-empty-function": "off", // a callback that does nothing until it is given
      "@typescript-eslint/no-non-null-assertion": "off", // indices are checked by noUncheckedIndexedAccess
      "@typescript-eslint/no-misused-promises": ["error", { checksVoidReturn: { arguments: false } }],
      "@typescript-eslint/no-misused-spread": "off", // characters are what is wanted of texts
      "@typescript-eslint/no-meaningless-void-operator": "off", // `void signal.value` follows it
      "@typescript-eslint/no-unnecessary-condition": "off", // types of browsers say more than old ones have
      "@typescript-eslint/no-unsafe-class-instance-assignment": "off", // three.js's callbacks tell of less than is given
      "@typescript-eslint/prefer-nullish-coalescing": "off", // of texts, none and an empty one are the same
      "@typescript-eslint/require-await": "off", // what may be awaited elsewhere
      "@typescript-eslint/use-unknown-in-catch-callback-variable": "off", // all that is thrown here is an Error
      "@typescript-eslint/unbound-method": "off", // closures that interfaces write as methods
      "@typescript-eslint/restrict-template-expressions": [
        "error",
        { allowNumber: true, allowBoolean: true, allowArray: true },
      ],
    },
  },
);
