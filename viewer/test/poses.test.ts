import { describe, expect, it } from "vitest";
import type { Head } from "../src/head";
import { blend, poseAt, Poses } from "../src/poses";

const count = 4;
const interval = 4;
const poses = 11;

/// Pose k has all places at k, so that every pose but the keys is a difference of one, folded to two.
function headOf(): Head {
  const box = { lower: [10, 20, 30], step: [1, 2, 3] };
  return { vertices: count, times: Array.from({ length: poses }, (_, k) => k / 10), key_interval: interval, marked: [2], box } as unknown as Head;
}

function makeReader() {
  const asked: string[] = [];
  const read = async (name: string) => {
    asked.push(name);
    const k = Number(name.slice(4));
    if (name.startsWith("marks")) return new Uint8Array(16);
    if (!(k < poses)) return null;
    const bytes = new Uint8Array(6 * count);
    for (let i = 0; i < 3 * count; ++i) bytes[i] = k % interval !== 0 ? 2 : i % count === 0 ? 2 * k : 0;
    return bytes;
  };
  return { asked, read };
}

describe("poses", () => {
  it("are right in whatever order they are asked for", async () => {
    const { read } = makeReader();
    for (const bytes of [400e6, 1]) {
      const held = new Poses(headOf(), read, bytes);
      for (const k of [10, 0, 3, 7, 2, 8, 5, 5, 1, 9, 6, 4])
        expect([...(await held.positions(k))].slice(3, 6)).toEqual([10 + k, 20 + 2 * k, 30 + 3 * k]);
    }
  });

  it("are decoded from the nearest key, and once", async () => {
    const { read, asked } = makeReader();
    const held = new Poses(headOf(), read);
    await held.positions(6);
    expect(asked).toEqual(["pose4", "pose5", "pose6"]);
    await held.positions(7);
    await held.positions(5);
    expect(asked).toEqual(["pose4", "pose5", "pose6", "pose7"]);
  });

  it("are decoded ahead as far as they are held, also while one is asked for", async () => {
    for (const [bytes, room] of [[400e6, poses], [3 * 6 * count, 3]]) {
      const { read, asked } = makeReader();
      const held = new Poses(headOf(), read, bytes);
      const [, late] = await Promise.all([held.decodeAhead(async () => {}), held.positions(9)]);
      expect(late[0]).toBe(10 + 9);
      const before = asked.length;
      for (const pose of room === poses ? [0, 5, 10] : []) await held.positions(pose);
      expect(asked.length).toBe(before);
      expect(new Set(asked.filter((name) => Number(name.slice(4)) < room)).size).toBe(room);
    }
  });

  it("say so when one is missing", async () => {
    await expect(new Poses(headOf(), async () => null).positions(0)).rejects.toThrow("pose 0 is missing");
  });

  it("have marks only where the page says so", async () => {
    const { read, asked } = makeReader();
    const held = new Poses(headOf(), read);
    await held.marksOf(1);
    await held.marksOf(2);
    await held.marksOf(2);
    expect(asked).toEqual(["marks2"]);
  });

  it("are found by time", () => {
    const times = [0, 0.1, 0.2, 0.5];
    expect([-1, 0, 0.05, 0.1, 0.19, 0.3, 0.5, 9].map((t) => poseAt(times, t))).toEqual([0, 0, 0, 1, 1, 2, 3, 3]);
    expect(poseAt([0], 3)).toBe(0);
  });

  it("blend", () => {
    expect([...blend(new Float32Array([0, 1]), new Float32Array([4, 3]), 0.25)]).toEqual([1, 1.5]);
  });
});
