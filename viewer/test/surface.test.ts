import { describe, expect, it } from "vitest";
import { noMarks } from "../src/decode";
import { bodyColour, contacts, depths, lightColours, markColour, parseColour, rampColour, shortNumber, speeds, strains, toLinear } from "../src/fields";
import { findComponents, findNormals, findOutline, sortByBody, type Surface } from "../src/surface";

const tetrahedron = Int32Array.from([0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3]);
const two = Int32Array.from([...tetrahedron, ...tetrahedron.map((v) => v + 4)]);

function surfaceOf(triangles: Int32Array, vertexCount: number, bodies: number[]): Surface {
  const outline = () => findOutline(triangles, vertexCount);
  return { vertexCount, triangles, outline, bodies: Int32Array.from(bodies), bodyCount: Math.max(...bodies) + 1, vertexIds: new Int32Array(vertexCount) };
}

describe("surface", () => {
  it("has each edge once, and knows whether it is closed", () => {
    const { edges, closed } = findOutline(two, 8);
    expect(closed).toBe(true);
    expect(edges.length).toBe(2 * 12);
    const names = new Set(Array.from({ length: 12 }, (_, e) => `${edges[2 * e]} ${edges[2 * e + 1]}`));
    expect(names.size).toBe(12);
    expect(names.has("1 3") && names.has("5 7")).toBe(true);
    expect(findOutline(two.slice(3), 8).closed).toBe(false);
  });

  it("falls into components, numbered from their first vertices, vertices without triangles too", () => {
    expect(findComponents(two, 9)).toEqual({ of: Int32Array.from([0, 0, 0, 0, 1, 1, 1, 1, 2]), count: 3 });
    const chain = Int32Array.from([4, 3, 5, 1, 0, 2, 2, 3, 0]);
    expect(findComponents(chain, 6)).toEqual({ of: new Int32Array(6), count: 1 });
  });

  it("sorts triangles by body", () => {
    const mixed = Int32Array.from([...two.slice(12, 15), ...two.slice(0, 3), ...two.slice(15, 18)]);
    const { corners, first } = sortByBody(surfaceOf(mixed, 8, [0, 0, 0, 0, 1, 1, 1, 1]));
    expect(first).toEqual([0, 3, 9]);
    expect([...corners]).toEqual([...two.slice(0, 3), ...two.slice(12, 18)]);
  });

  it("has outward normals of length 1", () => {
    const positions = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]);
    const normals = new Float32Array(12);
    findNormals(positions, tetrahedron, normals);
    for (let v = 0; v < 4; ++v) expect(Math.hypot(...normals.slice(3 * v, 3 * v + 3))).toBeCloseTo(1, 6);
    expect(normals[0] + normals[1] + normals[2]).toBeLessThan(-1);
  });
});

describe("values", () => {
  it("speed is the way over the time", () => {
    const before = new Float32Array([0, 0, 0, 1, 1, 1]);
    const after = new Float32Array([3, 4, 0, 1, 1, 1]);
    expect([...speeds(before, after, 0.5)]).toEqual([10, 0]);
    expect([...speeds(before, after, 0)]).toEqual([0, 0]);
  });

  it("strain is that of the direction that is strained most, and does not feel turns", () => {
    const rest = new Float32Array([0, 0, 0, 1, 0, 0, 0.3, 1, 0]);
    const triangle = Int32Array.from([0, 1, 2]);
    // Twice as long in x, half in y, then turned by a quarter about y: x to -z.
    const now = new Float32Array([5, 0, 0, 5, 0, -2, 5, 0.5, -0.6]);
    for (const value of strains(rest, now, triangle)) expect(value).toBeCloseTo(1, 5);
    // A shear of 1: the golden ratio.
    const sheared = new Float32Array([0, 0, 0, 1, 0, 0, 1.3, 1, 0]);
    expect(strains(rest, sheared, triangle)[0]).toBeCloseTo((1 + Math.sqrt(5)) / 2 - 1, 5);
    expect(strains(rest, rest.map((x) => 0.25 * x), triangle)[0]).toBeCloseTo(0.75, 6);
    expect(strains(rest, rest, triangle)[0]).toBeCloseTo(0, 6);
    // Flat against a line: all is lost in one direction.
    expect(strains(rest, rest.map((x, i) => (i % 3 === 1 ? 0 : x)), triangle)[0]).toBeCloseTo(1, 6);
    expect(strains(new Float32Array(9), now, triangle)[0]).toBe(0);
  });

  it("depth is the longest way out, and contact the kind of what meets", () => {
    const surface = surfaceOf(two, 8, [0, 0, 0, 0, 1, 1, 1, 1]);
    const marks = {
      ...noMarks,
      vertices: Int32Array.from([3, -1, 3]),
      depths: Float32Array.from([0.25, 9, -1]),
      pairs: Int32Array.from([0, 4]),
      kinds: Int32Array.from([2]),
      // What is inside or crosses stays so; the others have the first of their touches.
      touchVertices: Int32Array.from([7, 7, 3, 3, 0, 7]),
      touchKinds: Int32Array.from([6, 6, 5]),
    };
    expect([...depths(surface, marks)]).toEqual([0, 0, 0, 0.25, 0, 0, 0, 0]);
    expect([...contacts(surface, marks)]).toEqual([4, 4, 4, 1, 4, 4, 4, 8]);
  });

  it("are lit from the sun's side and from above", () => {
    const normals = new Float32Array([0, 0, 1, 0, 0, -1, 1, 0, 0]);
    const lit = new Float32Array(9);
    lightColours(normals, new Float32Array(9).fill(0.5), [0, 0, 1], [1, 0, 0], lit);
    expect(lit[0]).toBeCloseTo((0.5 * 1.5) / Math.PI, 6);
    expect(lit[3]).toBeCloseTo((0.5 * 1.5 * 0.27) / Math.PI, 6);
    expect(lit[6]).toBeCloseTo((0.5 * (2.1 + 1.5 * 0.635)) / Math.PI, 6);
    expect(lit[8]).toBe(lit[6]);
  });

  it("are written in few digits", () => {
    expect([0, 1, 0.00123456, 123.456, 1e-5, 1234567].map(shortNumber)).toEqual(["0", "1", "0.001235", "123.5", "1.00e-5", "1.23e+6"]);
  });
});

describe("colours", () => {
  /// As dichromats see linear RGB, without the first and without the second kind of cones (Vienot, Brettel, Mollon 1999).
  const fuse = (a: number, c: number) => ([r, g, b]: number[]) => [a * r + (1 - a) * g, a * r + (1 - a) * g, c * (r - g) + b];
  const eyes = [fuse(0.11238, 0.00401), fuse(0.29275, -0.02234), (rgb: number[]) => rgb];
  const lightness = (y: number) => (y > 0.008856 ? 116 * Math.cbrt(y) - 16 : 903.3 * y);

  it("of bodies next to each other differ, for dichromats too", () => {
    const all = Array.from({ length: 16 }, (_, b) => bodyColour(b));
    expect(new Set(all.map(String)).size).toBe(16);
    for (const eye of eyes) {
      const seen = [...all.slice(0, 8), parseColour(markColour)].map((colour) => eye(toLinear(colour)).map(lightness));
      for (let i = 0; i < seen.length; ++i)
        for (let j = 0; j < i; ++j) expect(Math.hypot(...seen[i].map((x, k) => x - seen[j][k])), `${i} ${j}`).toBeGreaterThan(10);
    }
  });

  it("of values grow lighter", () => {
    const light = (x: number) => toLinear(rampColour(x)).reduce((sum, c, i) => sum + [0.2126, 0.7152, 0.0722][i] * c, 0);
    for (let i = 0; i < 100; ++i) expect(light((i + 1) / 100)).toBeGreaterThan(light(i / 100));
    expect(rampColour(-1)).toEqual(rampColour(0));
    expect(rampColour(7)).toEqual(rampColour(1));
  });
});
