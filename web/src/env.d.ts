declare module "@wasm/*.wasm?url" {
  const url: string;
  export default url;
}

declare module "*.glb?url" {
  const url: string;
  export default url;
}

declare module "ogv/dist/ogv-decoder-video-av1-wasm.wasm?url" {
  const url: string;
  export default url;
}

// What of ogv.js's build of dav1d is used: it brings no types.
declare module "ogv/dist/ogv-decoder-video-av1-wasm.js" {
  interface Frame {
    /** What is shown of it, pixels; planes may be larger. */
    format: { cropWidth: number; cropHeight: number };
    y: { bytes: Uint8Array; stride: number };
  }
  export interface Dav1d {
    init(done: () => void): void;
    /** Decodes one temporal unit into `frameBuffer`. */
    processFrame(unit: Uint8Array, done: (ok: number) => void): void;
    frameBuffer: Frame | null;
    /** Takes a frame's memory for a later one. */
    recycleFrame(frame: Frame): void;
  }
  export default function make(options: {
    videoFormat: object;
    print: (line: string) => void;
    printErr: (line: string) => void;
    instantiateWasm(imports: WebAssembly.Imports, receive: (instance: WebAssembly.Instance) => void): object;
  }): Promise<Dav1d>;
}
