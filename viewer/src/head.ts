// What a page says of itself; written by src/page/ of the program.

export type Triple = [number, number, number];

export interface Keyframe {
  time: number;
  translate: Triple;
  angle: number;
}

export interface Motion {
  axis: Triple;
  centre: Triple;
  keyframes: Keyframe[];
}

/// Of 65535 steps a side; positions are counted in them.
export interface Box {
  lower: Triple;
  step: Triple;
}

export type Collider = { motion?: Motion } & (
  | { kind: "plane"; point: Triple; normal: Triple }
  | { kind: "box"; min: Triple; max: Triple }
  | { kind: "bowl"; centre: Triple; axis: Triple; radius: number }
  | { kind: "sphere"; centre: Triple; radius: number }
  | { kind: "cylinder"; centre: Triple; axis: Triple; radius: number; length: number }
  | { kind: "mesh"; positions: Triple[]; triangles: Triple[] }
  | { kind: "keyframed"; vertices: number; box: Box }
);

export interface Scene {
  gravity: Triple;
  bodies: { name: string }[];
  colliders: Collider[];
  [other: string]: unknown;
}

export interface Head {
  schema: number;
  kind: "run" | "mesh" | "discrete" | "continuous" | "paths" | "resolve";
  title: string;
  version: string;
  facts: [string, string, string][];
  warnings: string[];
  vertices: number;
  vertices_of_mesh: number;
  triangles: number;
  box: Box;
  times: number[];
  key_interval: number;
  marked: number[];
  touching_distance?: number; // what is nearer touches [m]
  frames?: number[];
  scene?: Scene;
  summary?: Record<string, unknown>;
  statistics?: { columns: string[]; rows: (number | null)[][] };
}

/// Whether two poses are blended by the slider, not played.
export function blends(head: Head): boolean {
  return head.kind === "continuous" || head.kind === "resolve";
}

export function readHead(): Head {
  const text = document.getElementById("head")?.textContent;
  if (!text) throw new Error("This page holds no result. Write one with `selvage view RESULT -o page.html`.");
  const head = JSON.parse(text) as Head;
  if (head.schema !== 1) throw new Error(`This page has schema ${head.schema}, and 1 is known.`);
  return head;
}
