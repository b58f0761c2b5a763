/** Colours for numbers: palettes for points and for the cells of maps. */

/** A colour as red, green and blue from 0 to 1, and how opaque it is. */
export type Color = readonly [red: number, green: number, blue: number, alpha: number];

export const PALETTES = ["turbo", "viridis", "grey", "map", "costmap", "raw"] as const;
export type Palette = (typeof PALETTES)[number];

/** Polynomials for turbo and viridis, from the lowest power on: red, green, blue. */
const TURBO = [
  [0.13572, 4.61539, -42.66032, 132.13108, -152.94239, 59.28638],
  [0.0914, 2.19419, 4.84297, -14.18503, 4.2773, 2.82957],
  [0.10667, 12.64195, -60.58205, 110.36277, -89.9031, 27.34825],
] as const;
const VIRIDIS = [
  [0.27773, 0.10509, -0.33086, -4.63423, 6.22827, 4.77638, -5.43546],
  [0.00541, 1.40461, 0.21485, -5.7991, 14.17993, -13.74515, 4.64585],
  [0.3341, 1.38459, 0.09509, -19.33244, 56.69055, -65.35303, 26.31244],
] as const;

/** The colours of all palettes: a row of 256 for each, as bytes. */
export function paletteBytes(): Uint8Array {
  const bytes = new Uint8Array(PALETTES.length * 1024);
  for (const [row, palette] of PALETTES.entries()) {
    for (let value = 0; value < 256; value += 1) {
      bytes.set(colorOf(palette, value), row * 1024 + value * 4);
    }
  }
  return bytes;
}

function colorOf(palette: Palette, value: number): readonly number[] {
  switch (palette) {
    case "turbo":
      return [...TURBO.map((each) => polynomial(each, value / 255)), 255];
    case "viridis":
      return [...VIRIDIS.map((each) => polynomial(each, value / 255)), 255];
    case "grey":
    case "raw":
      return [value, value, value, 255];
    case "map":
      return mapColor(value);
    case "costmap":
      return costColor(value);
  }
}

function polynomial(factors: readonly number[], x: number): number {
  const sum = factors.reduceRight((value, factor) => value * x + factor, 0);
  return Math.round(255 * Math.min(1, Math.max(0, sum)));
}

/** RViz's palette "map": free is white, occupied black; values that no cell should have stand out. */
function mapColor(value: number): readonly number[] {
  if (value === 255) return [0x70, 0x89, 0x86, 255];
  if (value > 127) return [255, Math.round((255 * (value - 128)) / 126), 0, 255];
  if (value > 100) return [0, 255, 0, 255];
  const shade = 255 - Math.round((255 * value) / 100);
  return [shade, shade, shade, 255];
}

/** RViz's palette "costmap": free is clear, then blue to red; inscribed is cyan, lethal magenta. */
function costColor(value: number): readonly number[] {
  if (value === 0) return [0, 0, 0, 0];
  if (value === 99) return [0, 255, 255, 255];
  if (value === 100) return [255, 0, 255, 255];
  if (value > 100) return mapColor(value);
  const red = Math.round((255 * value) / 100);
  return [red, 0, 255 - red, 255];
}

/** Parse `#rrggbb`. */
export function parseColor(text: string, alpha = 1): Color {
  const number = Number.parseInt(text.slice(1), 16);
  return [((number >> 16) & 255) / 255, ((number >> 8) & 255) / 255, (number & 255) / 255, alpha];
}

/** The 1st and the 99th percentile of some numbers, of which many are skipped; NaN counts not. */
export function percentiles(count: number, at: (index: number) => number): [number, number] {
  const step = Math.max(1, Math.floor(count / 2000));
  const found: number[] = [];
  for (let index = 0; index < count; index += step) {
    const value = at(index);
    if (Number.isFinite(value)) found.push(value);
  }
  found.sort((a, b) => a - b);
  const low = found[Math.floor(found.length * 0.01)] ?? 0;
  const high = found[Math.ceil(found.length * 0.99) - 1] ?? 1;
  return [low, high > low ? high : low + 1];
}
