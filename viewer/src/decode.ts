// Blocks of numbers of the page: base64, zlib, and the differences that src/page/encoding.h of the program makes.

export function decodeBase64(text: string): Uint8Array<ArrayBuffer> {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

export async function inflate(bytes: Uint8Array<ArrayBuffer>): Promise<Uint8Array<ArrayBuffer>> {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/// The bytes of a block; null where the page has none of that name.
export async function readBlock(name: string): Promise<Uint8Array<ArrayBuffer> | null> {
  const text = document.getElementById(`block-${name}`)?.textContent;
  return text ? inflate(decodeBase64(text)) : null;
}

export type Reader = typeof readBlock;

export async function readIntegers(name: string, stride: number, read: Reader = readBlock): Promise<Int32Array | null> {
  const bytes = await read(name);
  return bytes && unpackIntegers(bytes, stride);
}

/// Reverses pack_integers().
export function unpackIntegers(bytes: Uint8Array, stride: number): Int32Array {
  const count = bytes.length / 4;
  const values = new Int32Array(count);
  for (let i = 0; i < count; ++i) {
    const folded =
      (bytes[i] | (bytes[count + i] << 8) | (bytes[2 * count + i] << 16) | (bytes[3 * count + i] << 24)) >>> 0;
    const difference = (folded >>> 1) ^ -(folded & 1);
    values[i] = (i < stride ? 0 : values[i - stride]) + difference;
  }
  return values;
}

/// Reverses the differences of a pose: all x, then all y, then all z.
/// @param before  the pose before; null: each coordinate follows that of the vertex before
export function unpackPose(bytes: Uint8Array, before: Uint16Array | null): Uint16Array<ArrayBuffer> {
  const count = bytes.length / 2;
  const places = new Uint16Array(count);
  const perAxis = count / 3;
  for (let i = 0; i < count; ++i) {
    const folded = bytes[i] | (bytes[count + i] << 8);
    const difference = (folded >>> 1) ^ -(folded & 1);
    const reference = before ? before[i] : i % perAxis === 0 ? 0 : places[i - 1];
    places[i] = reference + difference;
  }
  return places;
}

export const kindNames = ["near", "touching", "crossing", "coplanar overlap", "vertex and face", "edge and edge", "collider"];

/// Points inside with their ways out, and pairs of triangles, of one pose.
export interface Marks {
  vertices: Int32Array; // shown vertex of each path, or -1
  depths: Float32Array; // negative: no way out
  from: Float32Array;
  to: Float32Array;
  pairs: Int32Array; // two triangles each
  kinds: Int32Array;
  features: Int32Array; // four each
  touchVertices: Int32Array; // of each touch two: the ends of an edge, or twice a vertex
  touchKinds: Int32Array;
  touchPlaces: Float32Array; // from 0 to 1, between the two
  touchNormals: Float32Array; // three each
}

export const noMarks: Marks = readMarks(new Uint8Array(16));

/// Reverses add_marks() of src/page/marks.h.
export function readMarks(bytes: Uint8Array<ArrayBuffer>): Marks {
  let at = 0;
  const take = (count: number) => bytes.slice(at, (at += count));
  const [paths, count, hasFeatures, touches] = new Int32Array(take(16).buffer);
  const vertices = unpackIntegers(take(4 * paths), 1);
  const numbers = new Float32Array(take(28 * paths).buffer);
  const pairs = unpackIntegers(take(8 * count), 2);
  const features = hasFeatures ? unpackIntegers(take(16 * count), 4) : new Int32Array(4 * count).fill(-1);
  const kinds = Int32Array.from(take(count));
  const touchVertices = unpackIntegers(take(8 * touches), 2);
  const touchKinds = Int32Array.from(take(touches));
  const touchPlaces = Float32Array.from(take(touches), (place) => place / 255);
  const normals = new Int8Array(take(3 * touches).buffer);
  const touchNormals = Float32Array.from({ length: 3 * touches }, (_, i) => normals[(i % 3) * touches + Math.floor(i / 3)] / 127);
  const met = { touchVertices, touchKinds, touchPlaces, touchNormals };
  const marks = { vertices, pairs, kinds, features, ...met, depths: new Float32Array(paths), from: new Float32Array(3 * paths), to: new Float32Array(3 * paths) };
  for (let i = 0; i < paths; ++i) {
    marks.depths[i] = numbers[7 * i];
    marks.from.set(numbers.subarray(7 * i + 1, 7 * i + 4), 3 * i);
    marks.to.set(numbers.subarray(7 * i + 4, 7 * i + 7), 3 * i);
  }
  return marks;
}
