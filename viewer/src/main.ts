import GUI from "lil-gui";
import { Charts } from "./charts";
import { Colouring, type Mode, type Shown } from "./colouring";
import { kindNames, noMarks, readBlock, readIntegers } from "./decode";
import { fillDetails } from "./details";
import { blends, readHead, type Head } from "./head";
import { blend, poseAt, Poses } from "./poses";
import { Stage } from "./stage";
import { findComponents, findOutline, type Outline, type Surface } from "./surface";
import "./style.css";

const element = <T extends HTMLElement = HTMLElement>(id: string) => document.getElementById(id) as T;
const state = document.documentElement.dataset;

function notify(text: string): void {
  element("notice").hidden = false;
  element("notice").textContent = text;
  state.state = "failed";
}

async function readSurface(head: Head): Promise<Surface> {
  const triangles = await readIntegers("triangles", 3);
  const vertexIds = await readIntegers("vertices", 1);
  if (!triangles || !vertexIds) throw new Error("The page is damaged: it has no surface.");
  const vertexCount = head.vertices;
  const bodies = await readIntegers("bodies", 1);
  const parts = bodies ? { of: bodies, count: Math.max(...new Set(bodies)) + 1 } : findComponents(triangles, vertexCount);
  let found: Outline | null = null;
  const outline = () => (found ??= findOutline(triangles, vertexCount));
  return { vertexCount, triangles, outline, bodies: parts.of, bodyCount: parts.count, vertexIds };
}

/// The page: what is shown, and how its parts answer the user.
class Viewer {
  private place = 0; // pose, or the share of the way from the first to the second
  private shown: Shown = { positions: new Float32Array(), before: null, seconds: 0, marks: noMarks };
  private picked = -1;
  private pair = -1;
  private playing = false;
  private timeShown = 0; // when clock, slider and charts were last brought up to date [ms]
  private asked = 0;
  private busy = false;
  private blends: boolean;
  private charts: Charts | null = null;
  private options = {
    ...{ colour: "body" as Mode, smooth: true, edges: true, opacity: 1, triangles: true, ways: true, touches: false },
    ...{ colliders: true, ground: true, cut: false, across: "y" as "x" | "y" | "z", place: 0.5, flip: false },
  };
  private gui = new GUI({ container: element("options"), title: "show" });

  constructor(
    private head: Head,
    private stage: Stage,
    private poses: Poses,
    private colouring: Colouring,
  ) {
    this.blends = blends(head);
    this.options.edges = stage.edgesShown;
    this.options.ground = stage.groundShown;
    // Arrows and marks are what these results are about; of a run they can hide it.
    this.options.ways = head.kind !== "run";
    this.buildOptions();
    this.buildTransport();
    this.bindKeys();
    this.bindPick();
    const dark = window.matchMedia("(prefers-color-scheme: dark)");
    this.setTheme(dark.matches);
    dark.addEventListener("change", () => this.setTheme(dark.matches));
    if (head.statistics && poses.count > 1)
      this.charts = new Charts(element("charts"), head, (pose) => this.goTo(pose));
  }

  private buildOptions(): void {
    const { gui, options, stage } = this;
    const paint = () => this.paint();
    gui.add(options, "colour", this.colouring.modes).name("colour by").onChange(paint);
    gui.add(options, "smooth").onChange((on: boolean) => stage.setSmooth(on));
    gui.add(options, "edges").onChange((on: boolean) => stage.setEdges(on));
    gui.add(options, "opacity", 0.1, 1, 0.05).onChange((value: number) => stage.setOpacity(value));
    if (this.head.marked.length > 0) {
      gui.add(options, "triangles").name("colliding triangles").onChange(() => this.showMarks());
      gui.add(options, "ways").name("ways out").onChange(() => this.showMarks());
      if (this.head.touching_distance) gui.add(options, "touches").name("contacts").onChange(() => this.showMarks());
    }
    if (this.head.scene?.colliders.length)
      gui.add(options, "colliders").onChange((on: boolean) => stage.setShown("colliders", on));
    gui.add(options, "ground").onChange((on: boolean) => stage.setShown("ground", on));
    const cut = gui.addFolder("cut");
    const change = () => this.showCut();
    cut.add(options, "cut").name("cut open").onChange(change);
    cut.add(options, "across", ["x", "y", "z"]).onChange(change);
    cut.add(options, "place", 0, 1, 0.005).onChange(change);
    cut.add(options, "flip").name("other side").onChange(change);
    if (window.innerWidth < 700) gui.close();
  }

  private set(name: keyof Viewer["options"], value: unknown): void {
    this.gui.controllersRecursive().find((controller) => controller.property === name)?.setValue(value);
  }

  private showCut(): void {
    const { cut, across, place, flip } = this.options;
    this.stage.setCut(cut ? across : null, place, flip);
    state.cut = cut ? across : "";
  }

  private showMarks(): void {
    const { triangles, ways, touches } = this.options;
    this.stage.setMarks(this.shown.marks, triangles, ways, touches);
  }

  private paint(): void {
    const { rgb, legend } = this.colouring.paint(this.options.colour, this.shown);
    this.stage.setColours(rgb);
    element("legend").replaceChildren(...legend);
    state.colour = this.options.colour;
  }

  private setTheme(dark: boolean): void {
    state.theme = dark ? "dark" : "light";
    this.stage.setTheme(dark);
    this.charts?.build();
  }

  private buildTransport(): void {
    const scrub = element<HTMLInputElement>("scrub");
    scrub.max = String(this.poses.count - 1);
    scrub.step = this.blends ? "0.01" : "1";
    scrub.addEventListener("input", () => this.goTo(Number(scrub.value)));
    element("transport").hidden = this.poses.count < 2;
    for (const id of ["before", "after"]) element(id).hidden = !this.blends;
    if (this.head.kind === "continuous") element("before").textContent = "start";
    if (this.head.kind === "continuous") element("after").textContent = "end";
    const bind = (id: string, act: () => void) => element(id).addEventListener("click", act);
    bind("play", () => this.play(!this.playing));
    bind("fit", () => this.stage.fit());
    bind("show-details", () => this.toggleDetails());
    bind("theme", () => this.setTheme(state.theme !== "dark"));
    bind("help", () => element<HTMLDialogElement>("keys").showModal());
    bind("pair-previous", () => this.choosePair(-1));
    bind("pair-next", () => this.choosePair(1));
  }

  private toggleDetails(): void {
    const hidden = (element("details").hidden = !element("details").hidden);
    element("show-details").setAttribute("aria-expanded", String(!hidden));
  }

  private bindKeys(): void {
    const { options } = this;
    const step = (by: number) => this.goTo(this.asked + by * (this.blends ? 0.05 : 1));
    const shift = (by: number) => this.set("place", Math.min(1, Math.max(0, Math.round(500 * (options.place + by)) / 500)));
    const keys: Record<string, () => void> = {
      " ": () => this.play(!this.playing),
      ArrowLeft: () => step(-1),
      ArrowRight: () => step(1),
      Home: () => this.goTo(0),
      End: () => this.goTo(this.poses.count - 1),
      f: () => this.stage.fit(),
      s: () => this.set("smooth", !options.smooth),
      e: () => this.set("edges", !options.edges),
      c: () => this.set("cut", !options.cut),
      "[": () => shift(-0.02),
      "]": () => shift(0.02),
      m: () => {
        const { modes } = this.colouring;
        this.set("colour", modes[(modes.indexOf(options.colour) + 1) % modes.length]);
      },
      n: () => this.choosePair(1),
      p: () => this.choosePair(-1),
      i: () => this.toggleDetails(),
      d: () => this.setTheme(state.theme !== "dark"),
      h: () => element<HTMLDialogElement>("keys").showModal(),
    };
    const answer = (event: KeyboardEvent) => {
      const target = event.target as HTMLElement;
      if (event.ctrlKey || event.metaKey || event.altKey || element<HTMLDialogElement>("keys").open) return;
      // Where keys have a meaning of their own they keep it.
      const own = target.matches("select, input:not([type=range], [type=checkbox])") || (event.key === " " && target.matches("button, [type=checkbox]"));
      const act = keys[event.key];
      if (own || !act) return;
      event.preventDefault();
      act();
    };
    // Before the panel gets them, which lets none through.
    document.addEventListener("keydown", answer, true);
  }

  private bindPick(): void {
    const canvas = element<HTMLCanvasElement>("picture");
    let down: [number, number] = [0, 0];
    canvas.addEventListener("pointerdown", (event) => (down = [event.offsetX, event.offsetY]));
    canvas.addEventListener("pointerup", (event) => {
      const still = event.pointerType === "mouse" ? 4 : 12; // fingers tremble
      if (Math.hypot(event.offsetX - down[0], event.offsetY - down[1]) > still || event.button !== 0 || !event.isPrimary) return;
      this.picked = this.stage.pick(event.offsetX, event.offsetY);
      this.showPick();
    });
  }

  private showPick(): void {
    this.stage.showPick(this.picked);
    const box = element("pick");
    box.hidden = this.picked < 0;
    box.textContent = this.picked < 0 ? "" : this.colouring.describe(this.picked, this.shown).join("\n");
    state.picked = this.picked < 0 ? "" : box.textContent!.split("\n")[0];
  }

  private choosePair(by: number): void {
    const { pairs, kinds, features } = this.shown.marks;
    const count = kinds.length;
    element("pairs").hidden = count === 0;
    if (count === 0) return;
    if (by !== 0) this.pair = (this.pair + by + (this.pair < 0 && by < 0 ? 1 : 0) + count) % count;
    const label = element("pair-label");
    if (this.pair < 0) {
      label.textContent = `${count} colliding ${count === 1 ? "pair" : "pairs"}`;
      return;
    }
    const two = [...pairs.subarray(2 * this.pair, 2 * this.pair + 2)];
    const [a, b, c, d] = features.subarray(4 * this.pair, 4 * this.pair + 4);
    const kind = kinds[this.pair];
    const names = [`triangles ${two.join(" and ")}, ${kindNames[kind]}`, `vertex ${a}, face ${b}`, `edges ${a} ${b} and ${c} ${d}`];
    label.textContent = `pair ${this.pair + 1} of ${count}: ${names[Math.max(0, kind - 3)]}`;
    state.pair = String(this.pair);
    this.stage.choosePair(two);
  }

  private play(playing: boolean): void {
    if (this.poses.count < 2) return;
    if (playing && this.place >= this.poses.count - 1) this.goTo(0);
    if (playing !== this.playing) this.stage.setMoving(playing);
    this.playing = playing;
    element("play").textContent = playing ? "\u275a\u275a" : "\u25b6";
    element("play").setAttribute("aria-pressed", String(playing));
    state.playing = playing ? "yes" : "";
    if (!playing) return this.showTime(this.place, Math.floor(this.place));
    const { times } = this.head;
    const start = performance.now();
    const from = this.blends || this.place >= this.poses.count - 1 ? 0 : times[this.place];
    const tick = () => {
      if (!this.playing) return;
      const speed = Number(element<HTMLSelectElement>("speed").value);
      const time = from + ((performance.now() - start) / 1000) * speed;
      const end = times[times.length - 1];
      this.goTo(this.blends ? Math.min(time / 2, 1) : poseAt(times, time));
      if (this.blends ? time >= 2 : time >= end) this.play(false);
      else requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  /// Shows a pose, or a blend of two, when it has been decoded; only the last of those asked for meanwhile.
  goTo(place: number): void {
    this.asked = Math.min(Math.max(place, 0), this.poses.count - 1);
    if (!this.busy) this.follow().catch((error: Error) => notify(error.message));
  }

  private async follow(): Promise<void> {
    this.busy = true;
    try {
      while (this.asked !== this.place || this.shown.positions.length === 0) await this.show(this.asked);
    } finally {
      this.busy = false;
    }
  }

  private async show(place: number): Promise<void> {
    const pose = Math.floor(place);
    const { times } = this.head;
    const first = await this.poses.positions(pose);
    const positions = place > pose ? blend(first, await this.poses.positions(pose + 1), place - pose) : first;
    const neighbour = pose > 0 ? pose - 1 : Math.min(1, this.poses.count - 1);
    const isNext = neighbour === this.place && this.shown.positions.length > 0;
    const before = isNext ? this.shown.positions : await this.poses.positions(neighbour);
    this.shown = {
      positions,
      before: this.head.kind === "run" ? before : null,
      seconds: Math.abs(times[pose] - times[neighbour]),
      // Marks are those of a pose itself: between two there are none.
      marks: place > pose ? noMarks : await this.poses.marksOf(pose),
    };
    await this.stage.colliders.decode(pose);
    this.place = place;
    this.stage.setPose(positions, times[pose]);
    if (this.options.colour !== "body" || state.state !== "ready") this.paint();
    this.showMarks();
    this.showTime(place, pose);
  }

  private showTime(place: number, pose: number): void {
    const frame = this.head.frames?.[pose] ?? pose;
    state.frame = String(this.blends ? place : frame);
    // Without a graphics card the page around the picture costs as much as the picture: it follows some times a second.
    const now = performance.now();
    if (this.playing && this.stage.software && now - this.timeShown < 120) return;
    this.timeShown = now;
    element<HTMLInputElement>("scrub").value = String(place);
    const text = this.blends ? place.toFixed(2) : `frame ${frame}, ${this.head.times[pose].toFixed(3)} s`;
    element("clock").textContent = text;
    element("scrub").setAttribute("aria-valuetext", text);
    this.charts?.showPose(pose);
    if (this.picked >= 0) this.showPick();
    this.pair = -1;
    this.stage.choosePair(null);
    this.choosePair(0);
  }
}

function describeHead(head: Head): void {
  element("title").textContent = head.title;
  const lines = head.warnings.map((textContent) => Object.assign(document.createElement("p"), { textContent }));
  element("warnings").replaceChildren(...lines);
  const poses = head.times.length > 1 ? `, ${head.times.length} poses` : "";
  element("picture").setAttribute("aria-label", `Picture of ${head.title}: ${head.triangles} triangles${poses}. Press h for keys, i for numbers.`);
  fillDetails(element("details"), head);
}

async function start(): Promise<void> {
  const head = readHead();
  describeHead(head);
  if (!("DecompressionStream" in window)) throw new Error("This browser is too old for the picture: take a newer one.");
  const surface = await readSurface(head);
  const restBytes = await readBlock("rest");
  const rest = restBytes ? new Float32Array(restBytes.buffer) : null;
  let stage: Stage;
  try {
    stage = new Stage(element<HTMLCanvasElement>("picture"), surface, head);
  } catch {
    // Charts and numbers need no WebGL.
    if (head.statistics) new Charts(element("charts"), head, () => {});
    element("transport").hidden = true;
    element("details").hidden = false;
    throw new Error("The picture needs WebGL, which this browser does not offer or has switched off. Numbers and charts are below.");
  }
  const poses = new Poses(head);
  const viewer = new Viewer(head, stage, poses, new Colouring(head, surface, rest));
  let frames = 0;
  stage.onDrawn = () => (state.drawn = String(++frames));
  viewer.goTo(0);
  const loop = () => {
    stage.drawIfNeeded();
    if (frames > 0 && state.frame !== undefined) state.state = "ready";
    requestAnimationFrame(loop);
  };
  requestAnimationFrame(loop);
  // The first play is then as smooth as the second. A damaged pose is told when somebody wants to see it.
  const idle = () => new Promise((done) => (window.requestIdleCallback ?? window.setTimeout)(done));
  poses.decodeAhead(idle).catch(() => {});
}

start().catch((error: Error) => notify(error.message));
