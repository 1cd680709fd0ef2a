import * as THREE from "three";
import { bodyColour, markColour, toLinear } from "./fields";

/// A plane that cuts the bodies open, and caps that fill the cut.
///
/// For each body, back faces behind the plane add one to the stencil and front faces take one away: what is left counts
/// how many times a ray from the plane is inside the body. A cap fills where it is not zero. Where it is more than one
/// (the body overlaps itself) or negative (it is inside out), the cap has the colour of what is marked.
export class Cut {
  readonly group = new THREE.Group();
  readonly plane = new THREE.Plane(new THREE.Vector3(-1, 0, 0), 0);
  private caps: THREE.Mesh[] = [];

  /// @param bodies  geometry of each body; null: surfaces that enclose nothing, which have no caps
  constructor(bodies: THREE.BufferGeometry[] | null, size: number) {
    this.group.visible = false;
    bodies?.forEach((geometry, body) => {
      const order = 4 * body + 1;
      this.group.add(this.counter(geometry, THREE.BackSide, THREE.IncrementWrapStencilOp, order));
      this.group.add(this.counter(geometry, THREE.FrontSide, THREE.DecrementWrapStencilOp, order + 1));
      const colour = new THREE.Color(...toLinear(bodyColour(body))).multiplyScalar(0.75);
      // Less: the reference 1 is less than the count.
      this.addCap(size, new THREE.Color(markColour), THREE.LessStencilFunc, 1, order + 2);
      this.addCap(size, colour, THREE.NotEqualStencilFunc, 0, order + 3);
    });
  }

  private counter(geometry: THREE.BufferGeometry, side: THREE.Side, op: THREE.StencilOp, order: number): THREE.Mesh {
    const always = { stencilWrite: true, stencilFunc: THREE.AlwaysStencilFunc, stencilFail: op, stencilZFail: op, stencilZPass: op };
    const unseen = { depthWrite: false, depthTest: false, colorWrite: false };
    const material = new THREE.MeshBasicMaterial({ side, ...unseen, ...always, clippingPlanes: [this.plane] });
    const mesh = new THREE.Mesh(geometry, material);
    mesh.renderOrder = order;
    mesh.frustumCulled = false;
    return mesh;
  }

  private addCap(size: number, color: THREE.Color, stencilFunc: THREE.StencilFunc, stencilRef: number, order: number) {
    const zero = THREE.ZeroStencilOp;
    const where = { stencilWrite: true, stencilRef, stencilFunc, stencilZFail: zero, stencilZPass: zero };
    const material = new THREE.MeshBasicMaterial({ color, side: THREE.DoubleSide, ...where });
    const cap = new THREE.Mesh(new THREE.PlaneGeometry(size, size), material);
    cap.renderOrder = order;
    this.caps.push(cap);
    this.group.add(cap);
  }

  /// Puts the plane through a point; what lies where the normal points to is cut away.
  moveTo(normal: THREE.Vector3, point: THREE.Vector3): void {
    this.plane.setFromNormalAndCoplanarPoint(normal.clone().negate(), point);
    for (const cap of this.caps) {
      cap.position.copy(point);
      cap.lookAt(point.clone().add(normal));
    }
  }
}
