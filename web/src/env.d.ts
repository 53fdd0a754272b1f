declare module "@wasm/*.wasm?url" {
  const url: string;
  export default url;
}

declare module "*.glb?url" {
  const url: string;
  export default url;
}
