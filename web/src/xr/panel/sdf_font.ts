import TinySDF from "@mapbox/tiny-sdf";
import type { FontFamilies } from "@pmndrs/uikit";

/** px of an em in the atlas, and over how many px around an edge its distance is told. */
const kEm = 40;
const kRange = 8;
const kAtlasWidth = 1024;
/** Glyphs are drawn for so long before the page may go on, ms. */
const kSliceMs = 6;
const kFamily = "system-ui, sans-serif";
const kUsual =
  [...Array(95).keys()].map((i) => String.fromCharCode(32 + i)).join("") + "°·×±−–…σ\u202fÄÖÜäöüß";

interface Glyph {
  char: string;
  drawn: ReturnType<TinySDF["draw"]>;
  x: number;
  y: number;
}

/** Sets glyphs in rows; returns their height together. */
function place(glyphs: Glyph[]): number {
  let [x, y, row] = [0, 0, 0];
  for (const glyph of glyphs) {
    const { width, height } = glyph.drawn;
    if (x + width > kAtlasWidth) {
      [x, y, row] = [0, y + row + 1, 0];
    }
    [glyph.x, glyph.y] = [x, y];
    x += width + 1;
    row = Math.max(row, height);
  }
  return y + row;
}

/** The atlas as a picture; its address is good for this page. */
async function atlas(glyphs: Glyph[], height: number): Promise<string> {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [kAtlasWidth, height];
  const context = canvas.getContext("2d")!;
  context.fillRect(0, 0, kAtlasWidth, height);
  for (const { drawn, x, y } of glyphs.filter((glyph) => glyph.drawn.data.length > 0)) {
    const picture = new ImageData(drawn.width, drawn.height);
    drawn.data.forEach((value, i) => picture.data.set([value, value, value, 255], 4 * i));
    context.putImageData(picture, x, y);
  }
  const blob = await new Promise<Blob | null>((resolve) => canvas.toBlob(resolve));
  return URL.createObjectURL(blob!);
}

/** uikit's description of a font that has `characters`: drawn by the browser, so that it knows every script. */
async function makeFont(characters: string) {
  const buffer = kRange / 2;
  const pen = new TinySDF({
    fontSize: kEm,
    buffer,
    radius: kRange,
    cutoff: 0.5,
    fontFamily: kFamily,
    fontWeight: "500",
  });
  const glyphs: Glyph[] = [];
  let since = performance.now();
  for (const char of characters) {
    glyphs.push({ char, drawn: pen.draw(char), x: 0, y: 0 });
    if (performance.now() - since > kSliceMs) {
      await new Promise((resolve) => setTimeout(resolve));
      since = performance.now();
    }
  }
  const height = place(glyphs);
  // From the top of the em to the baseline, with capitals in its middle.
  const capital = glyphs.find(({ char }) => char === "H")!.drawn.glyphHeight;
  const base = 0.5 * (kEm + capital);
  return {
    pages: [await atlas(glyphs, height)],
    chars: glyphs.map(({ char, drawn, x, y }, index) => ({
      id: char.codePointAt(0)!,
      index,
      char,
      x,
      y,
      width: drawn.width,
      height: drawn.height,
      xoffset: drawn.glyphLeft - buffer,
      yoffset: base - drawn.glyphTop - buffer,
      xadvance: drawn.glyphAdvance,
      chnl: 15,
      page: 0,
    })),
    info: {
      face: kFamily,
      size: kEm,
      bold: 0,
      italic: 0,
      charset: [...characters],
      unicode: 1,
      stretchH: 100,
      smooth: 1,
      aa: 1,
      padding: [0, 0, 0, 0],
      spacing: [0, 0],
      outline: 0,
    },
    common: {
      lineHeight: kEm,
      base,
      scaleW: kAtlasWidth,
      scaleH: height,
      pages: 1,
      packed: 0,
      alphaChnl: 0,
      redChnl: 0,
      greenChnl: 0,
      blueChnl: 0,
    },
    distanceField: { fieldType: "sdf", distanceRange: kRange },
    kernings: [],
  };
}

/**
 * The browser's own font, as distances that uikit draws at any size: nothing has to be loaded, and titles may be in any
 * script.
 */
export class SdfFont {
  #characters = kUsual;
  #made = makeFont(this.#characters);
  #families = this.#make();

  /** What was asked for is drawn. */
  get ready(): Promise<unknown> {
    return this.#made;
  }

  /** With what `text` needs, too: another object than before where that is new. */
  families(text = ""): FontFamilies {
    const missing = new Set([...text].filter((char) => char >= " " && !this.#characters.includes(char)));
    if (missing.size > 0) {
      this.#characters += [...missing].join("");
      this.#made = makeFont(this.#characters);
      this.#families = this.#make();
    }
    return this.#families;
  }

  #make(): FontFamilies {
    const made = this.#made;
    return { system: { normal: () => made } };
  }
}
