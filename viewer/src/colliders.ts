import * as THREE from "three";
import { readBlock, readIntegers, type Reader } from "./decode";
import type { Collider, Head, Triple } from "./head";
import { rigidMap } from "./motion";
import { Poses } from "./poses";

type Timeline = Pick<Head, "times" | "key_interval">;

const vector = (v: Triple) => new THREE.Vector3(...v);

/// Turns and shifts a shape made around the z axis at the origin.
function place(geometry: THREE.BufferGeometry, axis: THREE.Vector3, centre: THREE.Vector3): THREE.BufferGeometry {
  geometry.applyQuaternion(new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 0, 1), axis.clone().normalize()));
  return geometry.translate(centre.x, centre.y, centre.z);
}

function shapeOf(collider: Exclude<Collider, { kind: "keyframed" }>, size: number, focus: THREE.Vector3): THREE.BufferGeometry {
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
      const positions = new THREE.Float32BufferAttribute(collider.positions.flat(), 3);
      return new THREE.BufferGeometry().setAttribute("position", positions).setIndex(collider.triangles.flat());
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
  const flatShading = collider.kind === "mesh" || collider.kind === "keyframed";
  return new THREE.MeshLambertMaterial({ ...settings, opacity: 1, transparent: false, flatShading });
}

/// A collider that changes its form: its surface in each pose of the page.
class Form {
  readonly geometry = new THREE.BufferGeometry();
  private poses: Poses;
  private attribute: THREE.BufferAttribute;
  private positions: Float32Array = new Float32Array();

  constructor(
    { vertices, box }: Collider & { kind: "keyframed" },
    timeline: Timeline,
    private read: Reader,
  ) {
    this.attribute = new THREE.BufferAttribute(new Float32Array(3 * vertices), 3);
    this.geometry.setAttribute("position", this.attribute);
    this.poses = new Poses({ ...timeline, vertices, box, marked: [] }, read, 100e6);
  }

  async decode(pose: number): Promise<void> {
    if (!this.geometry.index) {
      const triangles = await readIntegers("triangles", 3, this.read);
      if (!triangles) throw new Error("The page is damaged: a collider has no surface.");
      this.geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(triangles), 1));
    }
    this.positions = await this.poses.positions(pose);
  }

  take(): void {
    this.attribute.set(this.positions).needsUpdate = true;
  }
}

/// All colliders of a scene, where they are at a time.
export class Colliders {
  readonly group = new THREE.Group();
  private forms: Form[] = [];

  /// @param size   of what lies in the scene: planes are drawn as far
  /// @param focus  its middle
  /// @param ground  the one that the stage draws as the ground
  /// @param timeline  times of the poses, for colliders that change their form
  constructor(
    private colliders: Collider[],
    size: number,
    focus: THREE.Vector3,
    ground: Collider | null,
    timeline: Timeline,
    read: Reader = readBlock,
  ) {
    for (const [c, collider] of colliders.entries()) {
      const part = new THREE.Group();
      part.matrixAutoUpdate = false;
      this.group.add(part);
      if (collider === ground) continue;
      if (collider.kind === "keyframed") {
        const form = new Form(collider, timeline, (name) => read(`collider${c}${name}`));
        part.add(new THREE.Mesh(form.geometry, materialOf(collider)));
        part.children[0].frustumCulled = false;
        this.forms.push(form);
        continue;
      }
      const geometry = shapeOf(collider, size, focus);
      part.add(new THREE.Mesh(geometry, materialOf(collider)));
      const angle = collider.kind === "mesh" || collider.kind === "box" ? 20 : 80;
      const outline = new THREE.LineBasicMaterial({ color: 0x7b848e, transparent: true, opacity: 0.7 });
      if (collider.kind !== "sphere") part.add(new THREE.LineSegments(new THREE.EdgesGeometry(geometry, angle), outline));
    }
  }

  /// Reads the forms that colliders have in a pose; moveTo() shows them.
  async decode(pose: number): Promise<void> {
    for (const form of this.forms) await form.decode(pose);
  }

  moveTo(time: number): void {
    for (const form of this.forms) form.take();
    this.group.children.forEach((part, i) => {
      part.matrix.copy(rigidMap(this.colliders[i].motion, time));
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
