declare module "@wasm/splat_order.wasm?url" {
  const url: string;
  export default url;
}
