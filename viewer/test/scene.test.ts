import * as THREE from "three";
import { describe, expect, it } from "vitest";
import { chartsOf, column, stack } from "../src/charts";
import { Colliders, findGround } from "../src/colliders";
import { detailRows, flatten } from "../src/details";
import type { Collider, Head, Motion, Triple } from "../src/head";
import { interpolate, rigidMap } from "../src/motion";

const key = (time: number, z: number, angle: number) => ({ time, translate: [0, 0, z] as [number, number, number], angle });
const apply = (m: THREE.Matrix4, p: [number, number, number]) => new THREE.Vector3(...p).applyMatrix4(m).toArray();

describe("motion", () => {
  it("is linear between key-frames and constant outside", () => {
    const keys = [key(1, 0, 0), key(2, 4, 2), key(2.5, 4, 2)];
    expect([0, 1, 1.25, 2, 2.2, 9].map((t) => interpolate(keys, t).translate[2])).toEqual([0, 0, 1, 4, 4, 4]);
    expect(interpolate(keys, 1.5).angle).toBe(1);
    expect(interpolate([], 1).translate).toEqual([0, 0, 0]);
  });

  it("turns about the axis through the centre, then shifts", () => {
    const motion: Motion = { axis: [0, 0, 5], centre: [1, 0, 0], keyframes: [key(0, 0, 0), key(1, 3, Math.PI / 2)] };
    const moved = apply(rigidMap(motion, 1), [2, 0, 0]);
    [1, 1, 3].forEach((x, i) => expect(moved[i]).toBeCloseTo(x, 12));
    expect(apply(rigidMap(motion, 0), [2, 0, 0])).toEqual([2, 0, 0]);
    expect(apply(rigidMap(undefined, 7), [1, 2, 3])).toEqual([1, 2, 3]);
  });

  it("agrees with a turn about a skew axis", () => {
    const motion: Motion = { axis: [1, 2, -2], centre: [0.5, -1, 2], keyframes: [key(0, 1, 0.7)] };
    const turn = new THREE.Quaternion().setFromAxisAngle(new THREE.Vector3(1, 2, -2).divideScalar(3), 0.7);
    const centre = new THREE.Vector3(0.5, -1, 2);
    const p = new THREE.Vector3(3, 1, -4).sub(centre).applyQuaternion(turn).add(centre).add(new THREE.Vector3(0, 0, 1));
    apply(rigidMap(motion, 0), [3, 1, -4]).forEach((x, i) => expect(x).toBeCloseTo(p.getComponent(i), 12));
  });
});

describe("colliders", () => {
  const all: Collider[] = [
    { kind: "plane", point: [0, 0, -1], normal: [0, 0, 2] },
    { kind: "box", min: [-1, -1, -1], max: [1, 1, 50] },
    { kind: "bowl", centre: [0, 0, 2], axis: [0, 0, 1], radius: 1.5 },
    { kind: "sphere", centre: [1, 2, 3], radius: 0.5 },
    { kind: "cylinder", centre: [0, 0, 0], axis: [1, 0, 0], radius: 0.25, length: 4, motion: { axis: [0, 0, 1], centre: [0, 0, 0], keyframes: [key(0, 0, 0), key(1, 1, Math.PI)] } },
    { kind: "mesh", positions: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], triangles: [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] },
  ];
  const boxOf = (collider: Collider, time = 0) => {
    const colliders = new Colliders([collider], 10, new THREE.Vector3(), null, { times: [0], key_interval: 16 });
    colliders.moveTo(time);
    colliders.group.updateMatrixWorld(true);
    return new THREE.Box3().setFromObject(colliders.group, true);
  };
  const close = (v: THREE.Vector3, expected: number[]) => expected.forEach((x, i) => expect(v.getComponent(i)).toBeCloseTo(x, 3));

  it("are where the scene has them", () => {
    const boxes = all.map((collider) => boxOf(collider));
    close(boxes[0].min, [-5, -5, -1]);
    close(boxes[1].max, [1, 1, 10]); // walls end where nothing is
    close(boxes[2].min, [-1.5, -1.5, 0.5]);
    close(boxes[2].max, [1.5, 1.5, 2]);
    close(boxes[3].max, [1.5, 2.5, 3.5]);
    close(boxes[4].min, [-2, -0.25, -0.25]);
    close(boxes[5].max, [1, 1, 1]);
    close(boxOf(all[4], 1).max, [2, 0.25, 1.25]);
  });

  it("that change their form have that of the pose, moved by their motion", async () => {
    const box = { lower: [-1, 0, 0] as Triple, step: [1, 1, 1] as Triple };
    const still: Collider = { kind: "keyframed", vertices: 3, box };
    const moving: Collider = { ...still, motion: { axis: [0, 0, 1], centre: [0, 0, 0], keyframes: [key(0, 0, 0), key(1, 8, 0)] } };
    // The triangle 0 1 2 with corners at 0, x and y; in pose k all of them are 2 k further along x.
    const first = [0, 3, -3, 0, 0, 1, 0, 0, 0];
    const asked: string[] = [];
    const read = async (name: string) => {
      asked.push(name);
      const folded = (values: number[], size: number) => {
        const bytes = new Uint8Array(size * values.length);
        values.forEach((d, i) => (bytes[i] = d < 0 ? -2 * d - 1 : 2 * d));
        return bytes;
      };
      if (name.endsWith("triangles")) return folded([0, 1, 2], 4);
      return name.endsWith("pose0") ? folded(first, 2) : folded([2, 2, 2, 0, 0, 0, 0, 0, 0], 2);
    };
    const colliders = new Colliders([all[0], still, moving], 10, new THREE.Vector3(), all[0], { times: [0, 0.5, 1], key_interval: 16 }, read);
    const boxes = async (pose: number, time: number) => {
      await colliders.decode(pose);
      colliders.moveTo(time);
      colliders.group.updateMatrixWorld(true);
      return [1, 2].map((c) => new THREE.Box3().setFromObject(colliders.group.children[c], true));
    };
    const [a, b] = await boxes(0, 0);
    close(a.min, [-1, 0, 0]);
    close(a.max, [2, 1, 0]);
    expect(b.equals(a)).toBe(true);
    const [c, d] = await boxes(2, 1);
    close(c.min, [3, 0, 0]);
    close(c.max, [6, 1, 0]);
    close(d.min, [3, 0, 8]);
    // Back again, from what is held: each block has been read once.
    close((await boxes(1, 0.5))[0].min, [1, 0, 0]);
    expect(asked.sort()).toEqual([1, 2].flatMap((c) => ["pose0", "pose1", "pose2", "triangles"].map((name) => `collider${c}${name}`)));
  });

  it("say so where their form is missing", async () => {
    const form: Collider = { kind: "keyframed", vertices: 3, box: { lower: [0, 0, 0], step: [1, 1, 1] } };
    const colliders = new Colliders([form], 10, new THREE.Vector3(), null, { times: [0], key_interval: 16 }, async () => null);
    await expect(colliders.decode(0)).rejects.toThrow("a collider has no surface");
  });

  it("give the ground", () => {
    const up = new THREE.Vector3(0, 0, 1);
    expect(findGround(all, up, 0, 5)).toEqual({ height: -1, plane: all[0] });
    expect(findGround([all[1]], up, 0, 5)).toEqual({ height: -1, plane: null });
    expect(findGround([all[2]], up, 0.5, 5)).toEqual({ height: 0.5, plane: null });
    expect(findGround([all[0]], up, -9, -5).height).toBe(-9);
    expect(findGround([{ ...all[0], motion: all[4].motion } as Collider], up, 0, 5).height).toBe(0);
  });
});

describe("charts and details", () => {
  const columns = ["frame", "seconds_material", "seconds_dcd", "seconds_frame", "deepest_penetration"];
  const head = {
    facts: [["machine", "threads", "2 of 2"]],
    kind: "run",
    version: "1",
    times: [0, 1],
    frames: [0, 2],
    statistics: { columns, rows: [[0, 0, 0, 0, 0.001], [1, 9, 9, 9, 9], [2, 0.25, 0.5, 1, 0.002]] },
    summary: { schema: 1, kind: "simulation", outcome: "finished", at_end: { fastest: 0.5 }, list: [{}] },
    scene: { scene: "noodle", gravity: [0, 0, -9.81], bodies: [{ name: "a", vertices: 3, elements: 1, material: { density: 1000 } }], colliders: [] },
  } as unknown as Head;

  it("show the frames of the page, and what is left of a frame's time", () => {
    expect(column(head, "frame")).toEqual([0, 2]);
    const [time, inside] = chartsOf(head);
    expect(time.lines.map((line) => line.values[1])).toEqual([250, 0, 500, 0, 0, 250]);
    expect(inside.lines[0].values).toEqual([1, 2]);
    expect(chartsOf({ ...head, statistics: undefined })).toEqual([]);
  });

  it("stack lines", () => {
    const lines = [[1, 2], [3, 4], [5, 6]].map((values) => ({ label: "", colour: "", values }));
    expect(stack(lines)).toEqual([[1, 2], [4, 6], [9, 12]]);
  });

  it("list numbers by group, each once", () => {
    const rows = detailRows(head);
    expect(rows).toContainEqual(["machine", "threads", "2 of 2"]);
    expect(rows).toContainEqual(["run", "outcome", "finished"]);
    expect(rows).toContainEqual(["at_end", "fastest", "0.5"]);
    expect(rows).toContainEqual(["scene", "gravity", "0, 0, -9.81"]);
    expect(rows).toContainEqual(["bodies", "a", "3 vertices, 1 elements; density 1000"]);
    expect(rows.some(([, name]) => name === "schema")).toBe(false);
    expect(flatten({ on: true, none: null, text: "" }, "g")).toEqual([["g", "on", "yes"]]);
  });
});
