import { deflateSync } from "node:zlib";
import { describe, expect, it } from "vitest";
import { decodeBase64, inflate, readMarks, unpackIntegers, unpackPose } from "../src/decode";

/// Twin of pack_integers() of the program.
function packIntegers(values: number[], stride: number): Uint8Array<ArrayBuffer> {
  const count = values.length;
  const bytes = new Uint8Array(4 * count);
  values.forEach((value, i) => {
    const difference = (value - (i < stride ? 0 : values[i - stride])) | 0;
    const folded = BigInt.asUintN(32, difference >= 0 ? BigInt(difference) * 2n : BigInt(difference) * -2n - 1n);
    for (let byte = 0; byte < 4; ++byte) bytes[byte * count + i] = Number((folded >> BigInt(8 * byte)) & 255n);
  });
  return bytes;
}

/// Twin of pack_differences().
function packPose(values: number[], before: number[]): Uint8Array {
  const count = values.length;
  const bytes = new Uint8Array(2 * count);
  values.forEach((value, i) => {
    const difference = ((value - before[i] + 32768 + 65536) % 65536) - 32768;
    const folded = difference >= 0 ? 2 * difference : -2 * difference - 1;
    bytes[i] = folded & 255;
    bytes[count + i] = folded >> 8;
  });
  return bytes;
}

let seed = 1;
const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;

describe("blocks", () => {
  it("decodes base64 of RFC 4648", () => {
    const text = (s: string) => new TextDecoder().decode(decodeBase64(s));
    expect([text(""), text("Zg=="), text("Zm8="), text("Zm9vYmFy")]).toEqual(["", "f", "fo", "foobar"]);
  });

  it("inflates what zlib deflates", async () => {
    const bytes = Uint8Array.from({ length: 5000 }, () => Math.floor(9 * random()));
    expect(await inflate(new Uint8Array(deflateSync(bytes)))).toEqual(bytes);
    await expect(inflate(new Uint8Array([1, 2, 3]))).rejects.toThrow();
  });

  it("brings integers back, the extremes too", () => {
    for (const stride of [1, 2, 3]) {
      const values = [0, -1, -2147483648, 2147483647, -2147483648, 5, 5, -7];
      for (let i = 0; i < 300; ++i) values.push(Math.floor((random() - 0.5) * (i % 2 ? 4294967295 : 8)));
      expect([...unpackIntegers(packIntegers(values, stride), stride)]).toEqual(values);
    }
  });

  it("brings poses back, by themselves and from the pose before", () => {
    const pose = () => Array.from({ length: 30 }, () => Math.floor(65536 * random()));
    const [first, second] = [pose(), pose()];
    const shifted = first.map((_, i) => (i % 10 === 0 ? 0 : first[i - 1]));
    const read = unpackPose(packPose(first, shifted), null);
    expect([...read]).toEqual(first);
    expect([...unpackPose(packPose(second, first), read)]).toEqual(second);
  });

  it("reads marks of one path to nowhere, one of a free point, two pairs and two touches", () => {
    const counts = new Uint8Array(new Int32Array([2, 2, 1, 2]).buffer);
    const numbers = new Uint8Array(new Float32Array([-1, 1, 2, 3, 1, 2, 3, 0.5, 0, 0, 0, 0, 0, 0.5]).buffer);
    const parts = [counts, packIntegers([7, -1], 1), numbers, packIntegers([0, 9, 4, 5], 2)];
    parts.push(packIntegers([1, 2, -1, -1, 0, 1, 2, 3], 4), new Uint8Array([4, 5]));
    // A vertex on a collider, and the middle of an edge: kinds, places, then x, y and z of the normals.
    parts.push(packIntegers([3, 3, 8, 6], 2), new Uint8Array([6, 5, 0, 51, 0, 127, 0, 0, 129, 0]));
    const bytes = new Uint8Array(parts.flatMap((part) => [...part]));
    const marks = readMarks(bytes);
    expect([...marks.vertices]).toEqual([7, -1]);
    expect([...marks.depths]).toEqual([-1, 0.5]);
    expect([...marks.to]).toEqual([1, 2, 3, 0, 0, 0.5]);
    expect([...marks.pairs]).toEqual([0, 9, 4, 5]);
    expect([...marks.kinds]).toEqual([4, 5]);
    expect([...marks.features]).toEqual([1, 2, -1, -1, 0, 1, 2, 3]);
    expect([...marks.touchVertices]).toEqual([3, 3, 8, 6]);
    expect([...marks.touchKinds]).toEqual([6, 5]);
    expect(marks.touchPlaces[1]).toBeCloseTo(0.2, 6);
    expect([...marks.touchNormals]).toEqual([0, 0, -1, 1, 0, 0]);
    expect(readMarks(new Uint8Array(16)).kinds.length).toBe(0);
  });
});
