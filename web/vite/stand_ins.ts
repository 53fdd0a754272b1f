// In place of what three_parts.ts leaves out of three.js and uikit: as they are where nothing uses them, and who does is
// told so.

function missing(what: string): never {
  throw new Error(`this viewer is built without ${what} (vite/three_parts.ts)`);
}

/** It is asked for by plain materials, too, whose shaders do not read it. */
export function getDFGLUT(): null {
  return null;
}

export class WebGLEnvironments {
  get(texture: object | null | undefined): null {
    return texture ? missing("environments") : null;
  }

  dispose(): void {}
}

/** Materials that are lit have shaders of their own. */
export class WebGLLights {
  readonly state = {
    version: 0,
    sun: [],
    directional: [],
    point: [],
    spot: [],
    spotLightMap: [],
    rectArea: [],
    hemi: [],
    sunShadowMap: [],
    directionalShadowMap: [],
    pointShadowMap: [],
    spotShadowMap: [],
    numSpotLightShadowsWithMaps: 0,
    numLightProbes: 0,
  };

  setup(lights: readonly object[]): void {
    if (lights.length > 0) {
      missing("lights");
    }
  }

  setupView(): void {}
}

export class WebGLMorphtargets {
  update(): never {
    missing("morph targets");
  }
}

/** Constructed where pictures go through effects. */
export function WebGLOutput(): never {
  missing("effects");
}

export class WebGLShadowMap {
  enabled = false;
  autoUpdate = true;
  needsUpdate = false;
  type = 1; // PCFShadowMap

  render(): void {
    if (this.enabled) {
      missing("shadows");
    }
  }
}

export class WebGLUniformsGroups {
  bind(): never {
    missing("groups of uniforms");
  }

  update(): never {
    missing("groups of uniforms");
  }

  dispose(): void {}
}

export class WebXRDepthSensing {
  readonly texture = null;

  init(): never {
    missing("depth sensing");
  }

  getMesh(): null {
    return null;
  }

  getDepthTexture(): null {
    return null;
  }

  reset(): void {}
}

/** What a panel of uikit casts a shadow by. */
export class PanelDepthMaterial {
  clippingPlanes: unknown = null;
}
export class PanelDistanceMaterial extends PanelDepthMaterial {}
export const instancedPanelDepthMaterial = undefined;
export const instancedPanelDistanceMaterial = undefined;

/** uikit's own materials by their names: the panel gives its materials as classes. */
export const materialClasses = {};

export function resolvePanelMaterialClassProperty<T>(input: T): T {
  return typeof input === "string" ? missing(`the material ${input}`) : input;
}
