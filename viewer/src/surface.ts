// Topology of the surface that is drawn.

export interface Surface {
  vertexCount: number;
  triangles: Int32Array;
  outline: () => Outline; // found when it is first asked for: most of the time that a large surface takes
  bodies: Int32Array; // of each vertex
  bodyCount: number;
  vertexIds: Int32Array; // numbers in the mesh
}

export interface Outline {
  edges: Uint32Array; // two vertices each, each edge once
  closed: boolean; // each edge has two triangles, or another even number
}

export function findOutline(triangles: Int32Array, vertexCount: number): Outline {
  const keys = new Float64Array(triangles.length);
  for (let i = 0; i < triangles.length; ++i) {
    const a = triangles[i];
    const b = triangles[i % 3 === 2 ? i - 2 : i + 1];
    keys[i] = Math.min(a, b) * vertexCount + Math.max(a, b);
  }
  keys.sort();
  const edges = new Uint32Array(2 * keys.length);
  let count = 0;
  let closed = true;
  for (let i = 0; i < keys.length; ) {
    let end = i + 1;
    while (end < keys.length && keys[end] === keys[i]) ++end;
    if ((end - i) % 2 !== 0) closed = false;
    edges[2 * count] = Math.floor(keys[i] / vertexCount);
    edges[2 * count + 1] = keys[i] % vertexCount;
    ++count;
    i = end;
  }
  return { edges: edges.slice(0, 2 * count), closed };
}

/// Connected components, numbered by their first vertex.
export function findComponents(triangles: Int32Array, vertexCount: number): { of: Int32Array; count: number } {
  const parent = Int32Array.from({ length: vertexCount }, (_, v) => v);
  const root = (v: number) => {
    while (parent[v] !== v) {
      parent[v] = parent[parent[v]];
      v = parent[v];
    }
    return v;
  };
  for (let t = 0; t < triangles.length; t += 3) {
    for (let i = 1; i < 3; ++i) {
      const a = root(triangles[t]);
      const b = root(triangles[t + i]);
      parent[Math.max(a, b)] = Math.min(a, b);
    }
  }
  const of = new Int32Array(vertexCount);
  let count = 0;
  for (let v = 0; v < vertexCount; ++v) of[v] = root(v) === v ? count++ : of[root(v)];
  return { of, count };
}

/// Normals of vertices, weighted by area.
export function findNormals(positions: Float32Array, triangles: Int32Array, normals: Float32Array): void {
  normals.fill(0);
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t];
    const b = 3 * triangles[t + 1];
    const c = 3 * triangles[t + 2];
    const ux = positions[b] - positions[a];
    const uy = positions[b + 1] - positions[a + 1];
    const uz = positions[b + 2] - positions[a + 2];
    const vx = positions[c] - positions[a];
    const vy = positions[c + 1] - positions[a + 1];
    const vz = positions[c + 2] - positions[a + 2];
    const x = uy * vz - uz * vy;
    const y = uz * vx - ux * vz;
    const z = ux * vy - uy * vx;
    for (const v of [a, b, c]) {
      normals[v] += x;
      normals[v + 1] += y;
      normals[v + 2] += z;
    }
  }
  for (let i = 0; i < normals.length; i += 3) {
    const length = Math.hypot(normals[i], normals[i + 1], normals[i + 2]) || 1;
    normals[i] /= length;
    normals[i + 1] /= length;
    normals[i + 2] /= length;
  }
}

/// Triangles body by body: their corners, and where each body begins.
export function sortByBody(surface: Surface): { corners: Uint32Array; first: number[] } {
  const first = new Array<number>(surface.bodyCount + 1).fill(0);
  const body = (t: number) => surface.bodies[surface.triangles[3 * t]];
  const count = surface.triangles.length / 3;
  for (let t = 0; t < count; ++t) first[body(t) + 1] += 3;
  for (let b = 0; b < surface.bodyCount; ++b) first[b + 1] += first[b];
  const next = first.slice();
  const corners = new Uint32Array(surface.triangles.length);
  for (let t = 0; t < count; ++t) {
    const at = next[body(t)];
    corners.set(surface.triangles.subarray(3 * t, 3 * t + 3), at);
    next[body(t)] += 3;
  }
  return { corners, first };
}
