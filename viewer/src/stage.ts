import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { MeshBVH } from "three-mesh-bvh";
import { Arrows } from "./arrows";
import { Colliders, findGround } from "./colliders";
import { Cut } from "./cut";
import type { Marks } from "./decode";
import { lightColours, markColour } from "./fields";
import { blends, type Head } from "./head";
import { findNormals, sortByBody, type Surface } from "./surface";

/// Bodies that have caps of their own colour; more share one.
const maxCaps = 48;

/// Whether there is no graphics card: each sample of a pixel then costs time.
function drawsBySoftware(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return false;
  const names = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

/// The picture: bodies, colliders, ground, marks, and the camera.
export class Stage {
  private renderer: THREE.WebGLRenderer;
  private scene = new THREE.Scene();
  private camera = new THREE.PerspectiveCamera(35, 1, 0.001, 1000);
  private controls: OrbitControls;
  private positions: THREE.BufferAttribute;
  private normals: THREE.BufferAttribute;
  private colours: THREE.BufferAttribute;
  private lit: THREE.BufferAttribute;
  private baked: THREE.Mesh;
  private sun = new THREE.DirectionalLight(0xffffff, 2.1);
  private geometry = new THREE.BufferGeometry();
  private bodies: THREE.Mesh<THREE.BufferGeometry, THREE.MeshLambertMaterial>;
  private edges: THREE.LineSegments<THREE.BufferGeometry, THREE.LineBasicMaterial>;
  private marked: THREE.Mesh;
  private chosen: THREE.Mesh[];
  private arrows: Arrows;
  private pickDot: THREE.Points;
  private shadow: THREE.Mesh;
  private ground: THREE.Group;
  readonly colliders: Colliders;
  private cut: Cut | null = null;
  private bvh: MeshBVH | null = null;
  private bvhIsOld = true;
  private dirty = true;
  readonly software: boolean;
  private solid: boolean;
  private moving = 0; // reasons for which the picture changes all the time: playing, turning
  private box: THREE.Box3;
  private up: THREE.Vector3;
  private groundHeight: number;
  onDrawn: () => void = () => {};

  constructor(
    private canvas: HTMLCanvasElement,
    private surface: Surface,
    head: Head,
  ) {
    this.software = drawsBySoftware();
    this.solid = head.kind === "run";
    // Opaque: what lies beneath the picture need not be drawn, nor blended with it.
    const context = canvas.getContext("webgl2", { alpha: false, antialias: !this.software, stencil: true });
    if (!context) throw new Error("There is no WebGL.");
    this.renderer = new THREE.WebGLRenderer({ canvas, context });
    this.renderer.localClippingEnabled = true;
    const lower = new THREE.Vector3(...head.box.lower);
    this.box = new THREE.Box3(lower, new THREE.Vector3(...head.box.step).multiplyScalar(65535).add(lower));
    const gravity = new THREE.Vector3(...(head.scene?.gravity ?? [0, 0, 0]));
    this.up = gravity.lengthSq() > 0 ? gravity.negate().normalize() : new THREE.Vector3(0, 0, 1);
    this.camera.up.copy(this.up);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.draw());
    this.controls.addEventListener("start", () => this.setMoving(true));
    this.controls.addEventListener("end", () => this.setMoving(false));

    const attribute = (size: number) => new THREE.BufferAttribute(new Float32Array(size * surface.vertexCount), size);
    this.positions = attribute(3);
    this.normals = attribute(3);
    this.colours = attribute(3);
    this.lit = attribute(3);
    const index = new THREE.BufferAttribute(new Uint32Array(surface.triangles), 1);
    this.share(this.geometry).setIndex(index);
    const settings = { vertexColors: true, side: THREE.DoubleSide };
    this.bodies = new THREE.Mesh(this.geometry, new THREE.MeshLambertMaterial(settings));
    this.bodies.renderOrder = 1000;
    // Without normals, which would be sent to be drawn although nobody asks for them.
    const bakedGeometry = new THREE.BufferGeometry().setIndex(index);
    bakedGeometry.setAttribute("position", this.positions).setAttribute("color", this.lit);
    this.baked = new THREE.Mesh(bakedGeometry, new THREE.MeshBasicMaterial({ vertexColors: true }));
    const ink = new THREE.LineBasicMaterial({ color: 0x101418, transparent: true, opacity: 0.28 });
    this.edges = new THREE.LineSegments(new THREE.BufferGeometry(), ink);
    this.edges.renderOrder = 1001;
    this.setEdges(surface.triangles.length < 3 * 30000);

    this.marked = this.addMarked(markColour, true);
    this.chosen = [this.addMarked("#ffd400", false), this.addMarked("#1f9bff", false)];
    const dot = new THREE.BufferGeometry().setAttribute("position", new THREE.Float32BufferAttribute([0, 0, 0], 3));
    const dotInk = new THREE.PointsMaterial({ color: 0xff2040, size: 11, sizeAttenuation: false, depthTest: false });
    this.pickDot = new THREE.Points(dot, dotInk);
    this.pickDot.visible = false;
    this.pickDot.renderOrder = 2000;

    const size = this.box.getSize(new THREE.Vector3()).length() || 1;
    this.arrows = new Arrows(size);
    const focus = this.box.getCenter(new THREE.Vector3());
    const shown = head.scene?.colliders ?? [];
    const corners = [this.box.min, this.box.max].map((corner) => corner.dot(this.up));
    const ground = findGround(shown, this.up, Math.min(...corners), Math.max(...corners));
    this.groundHeight = ground.height;
    this.colliders = new Colliders(shown, 1.2 * size, focus, ground.plane, head);
    this.shadow = new THREE.Mesh(this.geometry, new THREE.MeshBasicMaterial({ side: THREE.DoubleSide }));
    this.shadow.matrixAutoUpdate = false;
    this.shadow.frustumCulled = false;
    this.ground = this.makeGround(size, focus);
    const hasFloor = head.kind === "run" && (head.scene?.gravity ?? [0, 0, 0]).some((g) => g !== 0);
    this.ground.visible = this.shadow.visible = hasFloor || blends(head) || head.kind === "mesh";

    for (const part of [this.bodies, this.edges]) part.material.clippingPlanes = [];
    for (const part of [this.bodies, this.baked, this.edges, this.shadow, this.marked, ...this.chosen]) part.frustumCulled = false;
    this.sun.position.copy(this.up).multiplyScalar(2).add(new THREE.Vector3(0.7, -1.1, 0.5));
    const sky = new THREE.HemisphereLight(0xffffff, 0x8c8880, 1.5);
    sky.position.copy(this.up);
    const parts = [this.bodies, this.baked, this.edges, this.marked, ...this.chosen, this.arrows.group, this.pickDot, this.shadow];
    this.scene.add(...parts, this.ground, this.colliders.group, this.sun, sky);
    this.fit(this.box);
  }

  private share(geometry: THREE.BufferGeometry): THREE.BufferGeometry {
    geometry.setAttribute("position", this.positions);
    geometry.setAttribute("normal", this.normals);
    return geometry.setAttribute("color", this.colours);
  }

  private addMarked(color: string, hidden: boolean): THREE.Mesh {
    const geometry = new THREE.BufferGeometry().setAttribute("position", this.positions);
    const settings = { color, side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -1 };
    const material = new THREE.MeshBasicMaterial({ ...settings, depthTest: hidden });
    if (!hidden) Object.assign(material, { transparent: true, opacity: 0.85 });
    const mesh = new THREE.Mesh(geometry, material);
    mesh.renderOrder = hidden ? 1002 : 1990;
    mesh.visible = false;
    return mesh;
  }

  private bodyGeometries(): THREE.BufferGeometry[] {
    const { corners, first } = sortByBody(this.surface);
    const index = new THREE.BufferAttribute(corners, 1);
    const one = this.surface.bodyCount > maxCaps;
    const ranges = one ? [[0, corners.length]] : first.slice(1).map((end, b) => [first[b], end]);
    return ranges.map(([start, end]) => {
      const geometry = new THREE.BufferGeometry().setAttribute("position", this.positions).setIndex(index);
      geometry.setDrawRange(start, end - start);
      return geometry;
    });
  }

  /// The ground is a disc with rings of a round length apart; the shadow is the bodies flattened onto it.
  private makeGround(size: number, focus: THREE.Vector3): THREE.Group {
    const group = new THREE.Group();
    const radius = 1.1 * size;
    const disc = new THREE.Mesh(
      new THREE.CircleGeometry(radius, 64),
      new THREE.MeshBasicMaterial({ polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 2, depthWrite: false }),
    );
    disc.renderOrder = -3;
    const spacing = 10 ** Math.floor(Math.log10(size / 3));
    const divisions = Math.max(2, 2 * Math.floor(radius / Math.SQRT2 / spacing));
    const grid = new THREE.GridHelper(divisions * spacing, divisions).rotateX(Math.PI / 2);
    grid.renderOrder = -2;
    this.shadow.renderOrder = -1;
    (this.shadow.material as THREE.Material).depthWrite = false;
    group.add(disc, grid);
    group.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), this.up);
    const below = this.groundHeight - focus.dot(this.up);
    group.position.copy(focus).addScaledVector(this.up, below);
    this.shadow.matrix.copy(this.flatten(1e-4 * size));
    return group;
  }

  private flatten(lift: number): THREE.Matrix4 {
    const n = this.up;
    const light = n.clone().multiplyScalar(-2.2).add(new THREE.Vector3(-0.35, 0.5, -0.2)).normalize();
    const along = light.clone().divideScalar(light.dot(n));
    const h = this.groundHeight + lift;
    // p - along * (n . p - h)
    const row = (i: number, k: number) => (i === k ? 1 : 0) - along.getComponent(i) * n.getComponent(k);
    const rows = [0, 1, 2].flatMap((i) => [row(i, 0), row(i, 1), row(i, 2), along.getComponent(i) * h]);
    return new THREE.Matrix4().set(...(rows as [number, number, number, number, number, number, number, number, number, number, number, number]), 0, 0, 0, 1);
  }

  setPose(positions: Float32Array, time: number): void {
    (this.positions.array as Float32Array).set(positions);
    findNormals(positions, this.surface.triangles, this.normals.array as Float32Array);
    this.positions.needsUpdate = true;
    this.normals.needsUpdate = true;
    this.bvhIsOld = true;
    this.colliders.moveTo(time);
    this.draw();
  }

  setColours(rgb: Float32Array): void {
    (this.colours.array as Float32Array).set(rgb);
    this.colours.needsUpdate = true;
    this.draw();
  }

  setMarks(marks: Marks, showTriangles: boolean, showPaths: boolean, showTouches: boolean): void {
    this.marked.visible = showTriangles && marks.pairs.length > 0;
    this.setTriangles(this.marked, [...new Set(marks.pairs)]);
    this.arrows.show(marks, showPaths, showTouches, (vertex) => this.positionOf(vertex));
    this.draw();
  }

  private setTriangles(mesh: THREE.Mesh, triangles: number[]): void {
    const corners = new Uint32Array(3 * triangles.length);
    triangles.forEach((t, i) => corners.set(this.surface.triangles.subarray(3 * t, 3 * t + 3), 3 * i));
    mesh.geometry.dispose();
    mesh.geometry.setIndex(new THREE.BufferAttribute(corners, 1));
  }

  /// Shows two triangles through everything; and brings them near where `focus`.
  choosePair(pair: number[] | null, focus = true): void {
    this.chosen.forEach((mesh, i) => {
      mesh.visible = pair !== null;
      if (pair) this.setTriangles(mesh, [pair[i]]);
    });
    if (pair && focus) {
      const box = new THREE.Box3();
      for (const triangle of pair) for (let i = 0; i < 3; ++i) box.expandByPoint(this.positionOf(this.surface.triangles[3 * triangle + i]));
      this.lookAt(box, 6);
    }
    this.draw();
  }

  positionOf(vertex: number): THREE.Vector3 {
    return new THREE.Vector3().fromBufferAttribute(this.positions, vertex);
  }

  /// Puts a box in the middle, with room for `margin` times its size, without turning.
  private lookAt(box: THREE.Box3, margin: number, direction?: THREE.Vector3): void {
    const centre = box.getCenter(new THREE.Vector3());
    const radius = 0.5 * box.getSize(new THREE.Vector3()).length() * margin || 1;
    const away = direction ?? this.camera.position.clone().sub(this.controls.target);
    const narrow = Math.min(1, this.camera.aspect);
    const distance = radius / Math.sin(THREE.MathUtils.degToRad(this.camera.fov / 2)) / narrow;
    this.camera.position.copy(centre).addScaledVector(away.normalize(), distance);
    this.controls.target.copy(centre);
    const whole = this.box.getSize(new THREE.Vector3()).length() || 1;
    this.camera.near = Math.min(distance, whole) / 500;
    this.camera.far = distance + 30 * whole;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }

  /// Shows the pose, or at first all poses.
  fit(box = new THREE.Box3().setFromBufferAttribute(this.positions)): void {
    const across = new THREE.Vector3(0.55, -1, 0);
    if (Math.abs(across.dot(this.up)) > 0.5) across.set(1, 0, 0.5);
    this.lookAt(box, 0.86, across.addScaledVector(this.up, 0.55));
  }

  setSmooth(smooth: boolean): void {
    this.bodies.material.flatShading = !smooth;
    this.bodies.material.needsUpdate = true;
    this.draw();
  }

  setEdges(shown: boolean): void {
    const { geometry } = this.edges;
    if (shown && !geometry.index)
      this.share(geometry).setIndex(new THREE.BufferAttribute(this.surface.outline().edges, 1));
    this.edges.visible = shown;
    this.draw();
  }

  get edgesShown(): boolean { return this.edges.visible; }

  setOpacity(opacity: number): void {
    Object.assign(this.bodies.material, { opacity, transparent: opacity < 1, depthWrite: opacity === 1, needsUpdate: true });
    this.draw();
  }

  setShown(what: "colliders" | "ground", shown: boolean): void {
    if (what === "colliders") this.colliders.group.visible = shown;
    else this.ground.visible = this.shadow.visible = shown;
    this.draw();
  }

  get groundShown(): boolean { return this.ground.visible; }

  /// @param axis   "x", "y", "z"; null: no cut
  /// @param place  from 0 to 1 across the box
  setCut(axis: "x" | "y" | "z" | null, place: number, flip: boolean): void {
    const isCut = axis !== null;
    if (isCut && !this.cut) {
      const size = this.box.getSize(new THREE.Vector3()).length();
      this.cut = new Cut(this.surface.outline().closed ? this.bodyGeometries() : null, 3 * size);
      this.scene.add(this.cut.group);
    }
    if (this.cut) this.cut.group.visible = isCut;
    if (isCut && this.cut) {
      const normal = new THREE.Vector3();
      // At first what is nearer to the camera of fit() is cut away.
      normal[axis] = (axis === "y") !== flip ? -1 : 1;
      const point = this.box.getCenter(new THREE.Vector3());
      point[axis] = this.box.min[axis] + (this.box.max[axis] - this.box.min[axis]) * place;
      this.cut.moveTo(normal, point);
    }
    const clipped = [this.bodies, this.edges, this.marked] as { material: THREE.Material }[];
    for (const part of clipped) {
      part.material.clippingPlanes = isCut ? [this.cut!.plane] : [];
      part.material.needsUpdate = true;
    }
    this.draw();
  }

  /// The vertex nearest to what is seen at a point of the canvas; -1: nothing there.
  pick(x: number, y: number): number {
    if (!this.bvh) this.bvh = new MeshBVH(this.geometry, { indirect: true });
    else if (this.bvhIsOld) this.bvh.refit();
    this.bvhIsOld = false;
    const at = new THREE.Vector2((2 * x) / this.canvas.clientWidth - 1, 1 - (2 * y) / this.canvas.clientHeight);
    const caster = new THREE.Raycaster();
    caster.setFromCamera(at, this.camera);
    const hits = this.bvh.raycast(caster.ray, THREE.DoubleSide).sort((a, b) => a.distance - b.distance);
    const hit = hits.find((h) => !this.cut?.group.visible || this.cut.plane.distanceToPoint(h.point) >= 0);
    if (!hit) return -1;
    const corners = [hit.face!.a, hit.face!.b, hit.face!.c];
    const distances = corners.map((v) => this.positionOf(v).distanceTo(hit.point));
    return corners[distances.indexOf(Math.min(...distances))];
  }

  /// Marks a vertex; -1: none.
  showPick(vertex: number): void {
    this.pickDot.visible = vertex >= 0;
    if (vertex >= 0) this.pickDot.position.copy(this.positionOf(vertex));
    this.draw();
  }

  setTheme(dark: boolean): void {
    this.scene.background = new THREE.Color(dark ? 0x171a1e : 0xf4f5f6);
    const [disc, grid] = this.ground.children as [THREE.Mesh, THREE.GridHelper];
    (disc.material as THREE.MeshBasicMaterial).color.set(dark ? 0x23272c : 0xe7e9eb);
    (this.shadow.material as THREE.MeshBasicMaterial).color.set(dark ? 0x101215 : 0xc3c7cb);
    const ink = grid.material as THREE.LineBasicMaterial;
    ink.vertexColors = false;
    ink.color.set(dark ? 0x363b42 : 0xcfd3d7);
    ink.needsUpdate = true;
    this.draw();
  }

  /// Draws bodies with light found once a vertex, without their backs: much cheaper without a graphics card.
  private bakeLight(on: boolean): void {
    this.baked.visible = on;
    this.bodies.visible = !on;
    if (!on) return;
    const [normals, colours, lit] = [this.normals, this.colours, this.lit].map((a) => a.array as Float32Array);
    lightColours(normals, colours, this.up.toArray(), this.sun.position.clone().normalize().toArray(), lit);
    this.lit.needsUpdate = true;
  }

  setMoving(moves: boolean): void {
    this.moving += moves ? 1 : -1;
    this.draw();
  }

  /// Draws before the next refresh of the screen.
  draw(): void {
    this.dirty = true;
  }

  drawIfNeeded(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    // Without a graphics card, what moves is drawn coarser, and sharp as soon as it stands still.
    const hurry = this.software && this.moving > 0;
    const ratio = this.software ? (hurry ? 0.5 : 1) : Math.min(window.devicePixelRatio, 2);
    // Smoothing between its coarse pixels would cost a sixth of the pictures a second.
    this.canvas.style.imageRendering = hurry ? "pixelated" : "auto";
    const buffer = this.renderer.getSize(new THREE.Vector2());
    if (buffer.x !== width || buffer.y !== height || this.renderer.getPixelRatio() !== ratio) {
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(width, height, false);
      this.camera.aspect = width / Math.max(height, 1);
      this.camera.updateProjectionMatrix();
      this.dirty = true;
    }
    if (!this.dirty) return;
    this.dirty = false;
    const { opacity, flatShading } = this.bodies.material;
    this.bakeLight(hurry && this.solid && !this.cut?.group.visible && opacity === 1 && !flatShading);
    const seenFromAbove = this.camera.position.dot(this.up) > this.groundHeight;
    const shadowShown = this.shadow.visible;
    this.shadow.visible = shadowShown && seenFromAbove && !(hurry && this.surface.triangles.length > 3 * 20000);
    this.renderer.render(this.scene, this.camera);
    this.shadow.visible = shadowShown;
    this.onDrawn();
  }
}
