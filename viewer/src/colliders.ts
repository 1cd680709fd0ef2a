import * as THREE from "three";
import type { Collider, Triple } from "./head";
import { rigidMap } from "./motion";

const vector = (v: Triple) => new THREE.Vector3(...v);

/// Turns and shifts a shape made around the z axis at the origin.
function place(geometry: THREE.BufferGeometry, axis: THREE.Vector3, centre: THREE.Vector3): THREE.BufferGeometry {
  geometry.applyQuaternion(new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 0, 1), axis.clone().normalize()));
  return geometry.translate(centre.x, centre.y, centre.z);
}

function shapeOf(collider: Collider, size: number, focus: THREE.Vector3): THREE.BufferGeometry {
  switch (collider.kind) {
    case "plane": {
      const normal = vector(collider.normal).normalize();
      const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(normal, vector(collider.point));
      return place(new THREE.PlaneGeometry(size, size), normal, plane.projectPoint(focus, new THREE.Vector3()));
    }
    case "box": {
      // Walls far higher than what they hold would only stand in the way.
      const lower = vector(collider.min).max(focus.clone().subScalar(size));
      const upper = vector(collider.max).min(focus.clone().addScalar(size));
      const side = upper.clone().sub(lower);
      const middle = lower.clone().add(upper).multiplyScalar(0.5);
      return new THREE.BoxGeometry(side.x, side.y, side.z).translate(middle.x, middle.y, middle.z);
    }
    case "bowl": {
      const half = new THREE.SphereGeometry(collider.radius, 64, 32, 0, 2 * Math.PI, Math.PI / 2, Math.PI / 2);
      return place(half.rotateX(Math.PI / 2), vector(collider.axis), vector(collider.centre));
    }
    case "sphere":
      return new THREE.SphereGeometry(collider.radius, 64, 32).translate(...collider.centre);
    case "cylinder": {
      const cylinder = new THREE.CylinderGeometry(collider.radius, collider.radius, collider.length, 64);
      return place(cylinder.rotateX(Math.PI / 2), vector(collider.axis), vector(collider.centre));
    }
    case "mesh": {
      const geometry = new THREE.BufferGeometry();
      const corners = collider.triangles.flatMap((t) => t.flatMap((v) => collider.positions[v]));
      geometry.setAttribute("position", new THREE.Float32BufferAttribute(corners, 3));
      geometry.computeVertexNormals();
      return geometry;
    }
  }
}

/// Whether one looks into the collider or at it: of containers the far walls alone are drawn, so that their contents
/// are seen; a bowl is seen from below too.
function materialOf(collider: Collider): THREE.Material {
  const settings = { color: 0x9aa3ad, transparent: true, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 };
  if (collider.kind === "plane") return new THREE.MeshLambertMaterial({ ...settings, opacity: 0.45, side: THREE.DoubleSide, depthWrite: false });
  if (collider.kind === "box") return new THREE.MeshLambertMaterial({ ...settings, opacity: 0.35, side: THREE.BackSide, depthWrite: false });
  if (collider.kind === "bowl") return new THREE.MeshLambertMaterial({ ...settings, opacity: 0.8, side: THREE.BackSide });
  return new THREE.MeshLambertMaterial({ ...settings, opacity: 1, transparent: false });
}

/// All colliders of a scene, where they are at a time.
export class Colliders {
  readonly group = new THREE.Group();

  /// @param size   of what lies in the scene: planes are drawn as far
  /// @param focus  its middle
  /// @param ground  the one that the stage draws as the ground
  constructor(
    private colliders: Collider[],
    size: number,
    focus: THREE.Vector3,
    ground: Collider | null,
  ) {
    for (const collider of colliders) {
      const part = new THREE.Group();
      part.matrixAutoUpdate = false;
      this.group.add(part);
      if (collider === ground) continue;
      const geometry = shapeOf(collider, size, focus);
      part.add(new THREE.Mesh(geometry, materialOf(collider)));
      const angle = collider.kind === "mesh" || collider.kind === "box" ? 20 : 80;
      const outline = new THREE.LineBasicMaterial({ color: 0x7b848e, transparent: true, opacity: 0.7 });
      if (collider.kind !== "sphere") part.add(new THREE.LineSegments(new THREE.EdgesGeometry(geometry, angle), outline));
    }
  }

  moveTo(time: number): void {
    this.group.children.forEach((part, i) => {
      const m = rigidMap(this.colliders[i].motion, time);
      part.matrix.set(m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8], m[9], m[10], m[11], 0, 0, 0, 1);
      part.matrixWorldNeedsUpdate = true;
    });
  }
}

/// The ground: the highest of the planes that face up and stand still, and of the floors of boxes, unless everything
/// lies below it; else the lowest point that anything reaches.
export function findGround(colliders: Collider[], up: THREE.Vector3, lowest: number, highest: number): { height: number; plane: Collider | null } {
  let ground: { height: number; plane: Collider | null } | null = null;
  for (const collider of colliders) {
    if (collider.motion) continue;
    let height: number;
    if (collider.kind === "plane" && vector(collider.normal).normalize().dot(up) > 0.999)
      height = vector(collider.point).dot(up);
    else if (collider.kind === "box") height = Math.min(vector(collider.min).dot(up), vector(collider.max).dot(up));
    else continue;
    if (height < highest && (!ground || height > ground.height))
      ground = { height, plane: collider.kind === "plane" ? collider : null };
  }
  return ground ?? { height: lowest, plane: null };
}
