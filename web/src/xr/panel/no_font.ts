// In place of fonts that come with uikit (vite.config.ts): see sdf_font.ts.
throw new Error("the panel has a font of its own");
