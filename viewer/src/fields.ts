// Values of vertices and the colours that show them.

import { kindNames, type Marks } from "./decode";
import type { Surface } from "./surface";

/// Speed of each vertex between two poses [m/s].
export function speeds(before: Float32Array, after: Float32Array, seconds: number): Float32Array {
  const values = new Float32Array(after.length / 3);
  if (!(seconds > 0)) return values;
  for (let v = 0; v < values.length; ++v) {
    const i = 3 * v;
    values[v] =
      Math.hypot(after[i] - before[i], after[i + 1] - before[i + 1], after[i + 2] - before[i + 2]) / seconds;
  }
  return values;
}

/// Largest strain of the triangles around each vertex: the part by which a length in a triangle has grown or shrunk.
/// It comes from the singular values of the map from the triangle at rest to the triangle as it is.
export function strains(rest: Float32Array, positions: Float32Array, triangles: Int32Array): Float32Array {
  const values = new Float32Array(positions.length / 3);
  for (let t = 0; t < triangles.length; t += 3) {
    const strain = strainOf(rest, positions, triangles[t], triangles[t + 1], triangles[t + 2]);
    for (let i = 0; i < 3; ++i) values[triangles[t + i]] = Math.max(values[triangles[t + i]], strain);
  }
  return values;
}

function strainOf(rest: Float32Array, now: Float32Array, a: number, b: number, c: number): number {
  // Products of the edges at rest (R) and now (N): the squared stretches are the eigenvalues of R^-1 N.
  const [r11, r12, r22] = edgeProducts(rest, a, b, c);
  const [n11, n12, n22] = edgeProducts(now, a, b, c);
  const determinant = r11 * r22 - r12 * r12;
  if (!(determinant > 0)) return 0;
  const trace = (r22 * n11 - 2 * r12 * n12 + r11 * n22) / determinant;
  const product = (n11 * n22 - n12 * n12) / determinant;
  const largest = trace / 2 + Math.sqrt(Math.max(0, (trace * trace) / 4 - product));
  const smallest = largest > 0 ? product / largest : 0;
  return Math.max(Math.sqrt(Math.max(0, largest)) - 1, 1 - Math.sqrt(Math.max(0, smallest)));
}

function edgeProducts(p: Float32Array, a: number, b: number, c: number): [number, number, number] {
  const ux = p[3 * b] - p[3 * a];
  const uy = p[3 * b + 1] - p[3 * a + 1];
  const uz = p[3 * b + 2] - p[3 * a + 2];
  const vx = p[3 * c] - p[3 * a];
  const vy = p[3 * c + 1] - p[3 * a + 1];
  const vz = p[3 * c + 2] - p[3 * a + 2];
  return [ux * ux + uy * uy + uz * uz, ux * vx + uy * vy + uz * vz, vx * vx + vy * vy + vz * vz];
}

/// How deep each vertex is inside; 0: not inside.
export function depths(surface: Surface, marks: Marks): Float32Array {
  const values = new Float32Array(surface.vertexCount);
  marks.vertices.forEach((v, i) => {
    if (v >= 0) values[v] = Math.max(values[v], marks.depths[i]);
  });
  return values;
}

export const contactNames = ["free", "inside", ...kindNames];

/// How each vertex meets others, as a number of contactNames. Inside stands above what its triangles do, and that above
/// what it touches.
export function contacts(surface: Surface, marks: Marks): Uint8Array {
  const values = new Uint8Array(surface.vertexCount);
  marks.kinds.forEach((kind, pair) => {
    for (const triangle of [marks.pairs[2 * pair], marks.pairs[2 * pair + 1]])
      for (let i = 0; i < 3; ++i) {
        const v = surface.triangles[3 * triangle + i];
        values[v] = Math.max(values[v], kind + 2);
      }
  });
  marks.touchVertices.forEach((v, i) => (values[v] ||= marks.touchKinds[i >> 1] + 2));
  for (const v of marks.vertices) if (v >= 0) values[v] = 1;
  return values;
}

// Colours of Okabe and Ito (2008), which people with any kind of colour blindness tell apart; vermilion is left to what
// is marked.
const palette = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#f0e442", "#3c3c3c", "#b8b8b8"];
export const markColour = "#d55e00";
const contactPalette = ["#c8c8c8", "#d55e00", "#e0e0b0", "#f0e442", "#cc79a7", "#0072b2", "#009e73", "#56b4e9", "#3c3c3c"];

export type Rgb = [number, number, number];

export function parseColour(text: string): Rgb {
  return [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16) / 255) as Rgb;
}

/// Colour of a body: the palette, and the same lighter and darker where there are more bodies than colours.
export function bodyColour(body: number): Rgb {
  const colour = parseColour(palette[body % palette.length]);
  const round = Math.floor(body / palette.length) % 3;
  if (round === 0) return colour;
  return colour.map((c) => (round === 1 ? c + 0.45 * (1 - c) : 0.62 * c)) as Rgb;
}

export function contactColour(contact: number): Rgb {
  return parseColour(contactPalette[contact]);
}

// From dark to light, so that order can be seen without hue.
const ramp = ["#00224e", "#3b4d6e", "#7c7b78", "#bcae6c", "#fee838"].map(parseColour);

/// Colour of a value from 0 to 1.
export function rampColour(value: number): Rgb {
  const at = Math.min(Math.max(value, 0), 1) * (ramp.length - 1);
  const low = Math.min(Math.floor(at), ramp.length - 2);
  const share = at - low;
  return ramp[low].map((c, i) => c + share * (ramp[low + 1][i] - c)) as Rgb;
}

/// Light in proportion to energy, as shading needs it, of a colour of sRGB.
export function toLinear(colour: Rgb): Rgb {
  return colour.map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4)) as Rgb;
}

/// Colours in the light of the stage: a sun, and a sky that is dimmer from below.
export function lightColours(normals: Float32Array, colours: Float32Array, up: number[], sun: number[], lit: Float32Array): void {
  for (let i = 0; i < lit.length; i += 3) {
    const along = (way: number[]) => normals[i] * way[0] + normals[i + 1] * way[1] + normals[i + 2] * way[2];
    const sky = 0.5 + 0.5 * along(up);
    const light = (2.1 * Math.max(0, along(sun)) + 1.5 * (sky + 0.27 * (1 - sky))) / Math.PI;
    for (let k = i; k < i + 3; ++k) lit[k] = colours[k] * light;
  }
}

/// A number in few digits.
export function shortNumber(value: number): string {
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size >= 1e5 || size < 1e-3 ? value.toExponential(2) : String(Number(value.toPrecision(4)));
}
