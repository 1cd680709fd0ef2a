import { readBlock, readMarks, noMarks, unpackPose, type Marks, type Reader } from "./decode";
import type { Head } from "./head";

/// The poses of a page. Each is decoded when it is asked for, from the nearest pose that stands by itself or is still
/// held; the ones used longest ago are let go.
export class Poses {
  private held = new Map<number, Uint16Array>();
  private marks = new Map<number, Marks>();
  private marked: Set<number>;

  constructor(
    private head: Pick<Head, "times" | "vertices" | "box" | "key_interval" | "marked">,
    private read: Reader = readBlock,
    private maxBytes = 400e6,
  ) {
    this.marked = new Set(head.marked);
  }

  get count(): number {
    return this.head.times.length;
  }

  /// How many are held at most.
  private get room(): number {
    return Math.max(2, Math.floor(this.maxBytes / (6 * this.head.vertices)));
  }

  /// Decodes the first poses, as many as are held, one after the other: between two it waits for a promise of idle().
  async decodeAhead(idle: () => Promise<unknown>): Promise<void> {
    for (let pose = 0; pose < Math.min(this.count, this.room); ++pose) {
      await idle();
      await this.places(pose);
    }
  }

  private hold(pose: number, places: Uint16Array) {
    this.held.delete(pose);
    this.held.set(pose, places);
    for (const oldest of this.held.keys()) {
      if (this.held.size <= this.room) break;
      this.held.delete(oldest);
    }
  }

  /// Places in the box, all x, then all y, then all z.
  private async places(pose: number): Promise<Uint16Array> {
    let start = pose;
    const isKey = () => start % this.head.key_interval === 0;
    while (!this.held.has(start) && !isKey()) --start;
    let places = this.held.get(start) ?? null;
    for (let i = places ? start + 1 : start; i <= pose; ++i) {
      const bytes = await this.read(`pose${i}`);
      if (!bytes) throw new Error(`The page is damaged: pose ${i} is missing.`);
      places = unpackPose(bytes, i % this.head.key_interval === 0 ? null : places);
      this.hold(i, places);
    }
    this.hold(pose, places!);
    return places!;
  }

  /// Positions of a pose, one vertex after the other [m].
  async positions(pose: number): Promise<Float32Array> {
    const places = await this.places(pose);
    const { lower, step } = this.head.box;
    const count = this.head.vertices;
    const positions = new Float32Array(3 * count);
    for (let axis = 0; axis < 3; ++axis)
      for (let i = 0; i < count; ++i) positions[3 * i + axis] = lower[axis] + step[axis] * places[axis * count + i];
    return positions;
  }

  async marksOf(pose: number): Promise<Marks> {
    if (!this.marked.has(pose)) return noMarks;
    let marks = this.marks.get(pose);
    if (!marks) {
      const bytes = await this.read(`marks${pose}`);
      marks = bytes ? readMarks(bytes) : noMarks;
      this.marks.set(pose, marks);
    }
    return marks;
  }
}

/// One pose on the way to another.
export function blend(a: Float32Array, b: Float32Array, share: number): Float32Array {
  const mixed = new Float32Array(a.length);
  for (let i = 0; i < a.length; ++i) mixed[i] = a[i] + share * (b[i] - a[i]);
  return mixed;
}

/// The pose that is shown at a time: the last one that begins by then.
export function poseAt(times: number[], time: number): number {
  let low = 0;
  let high = times.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= time + 1e-9) low = middle;
    else high = middle - 1;
  }
  return low;
}
