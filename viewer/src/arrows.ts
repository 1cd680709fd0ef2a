import * as THREE from "three";
import type { Marks } from "./decode";
import { contactColour, parseColour, toLinear, type Rgb } from "./fields";

const pathColour = toLinear(parseColour("#cc2fa0"));
const up = new THREE.Vector3(0, 1, 0);

/// Arrows that are seen through everything: lines with tips.
export class Arrows {
  readonly group = new THREE.Group();
  private ends: number[] = [];
  private colours: Rgb[] = [];

  /// @param size  of all that is shown: no tip is longer than a small part of it
  constructor(private size: number) {}

  private add(from: THREE.Vector3, to: THREE.Vector3, colour: Rgb): void {
    this.ends.push(...from.toArray(), ...to.toArray());
    this.colours.push(colour);
  }

  /// @param positionOf  a vertex of the pose
  show(marks: Marks, paths: boolean, touches: boolean, positionOf: (vertex: number) => THREE.Vector3): void {
    for (const old of this.group.children) (old as THREE.Mesh).geometry.dispose();
    this.group.clear();
    this.ends = [];
    this.colours = [];
    marks.depths.forEach((depth, i) => {
      const [from, to] = [marks.from, marks.to].map((ends) => new THREE.Vector3().fromArray(ends, 3 * i));
      if (paths && depth >= 0) this.add(from, to, pathColour);
    });
    marks.touchKinds.forEach((kind, i) => {
      if (!touches) return;
      const [a, b] = marks.touchVertices.subarray(2 * i, 2 * i + 2);
      const place = positionOf(a).lerp(positionOf(b), marks.touchPlaces[i]);
      const normal = new THREE.Vector3().fromArray(marks.touchNormals, 3 * i).normalize();
      this.add(place, normal.multiplyScalar(0.025 * this.size).add(place), toLinear(contactColour(kind + 2)));
    });
    if (this.colours.length > 0) this.build();
  }

  private build(): void {
    const { ends, colours } = this;
    const lines = new THREE.BufferGeometry().setAttribute("position", new THREE.Float32BufferAttribute(ends, 3));
    lines.setAttribute("color", new THREE.Float32BufferAttribute(colours.flatMap((c) => [...c, ...c]), 3));
    const settings = { depthTest: false, transparent: true };
    const shafts = new THREE.LineSegments(lines, new THREE.LineBasicMaterial({ ...settings, vertexColors: true }));
    const tip = new THREE.ConeGeometry(0.12, 0.4, 8).translate(0, -0.2, 0);
    const tips = new THREE.InstancedMesh(tip, new THREE.MeshBasicMaterial(settings), colours.length);
    colours.forEach((colour, i) => {
      const [from, to] = [6 * i, 6 * i + 3].map((at) => new THREE.Vector3().fromArray(ends, at));
      const way = to.clone().sub(from);
      const length = Math.min(way.length(), 0.02 * this.size) || 1e-9;
      const turn = new THREE.Quaternion().setFromUnitVectors(up, way.normalize());
      tips.setMatrixAt(i, new THREE.Matrix4().compose(to, turn, new THREE.Vector3().setScalar(length)));
      tips.setColorAt(i, new THREE.Color(...colour));
    });
    for (const part of [shafts, tips]) Object.assign(part, { renderOrder: 1995, frustumCulled: false });
    this.group.add(shafts, tips);
  }
}
