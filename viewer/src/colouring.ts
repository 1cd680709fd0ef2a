import type { Marks } from "./decode";
import { bodyColour, contactColour, contactNames, contacts, depths, rampColour } from "./fields";
import { shortNumber, speeds, strains, toLinear, type Rgb } from "./fields";
import { column } from "./charts";
import type { Head } from "./head";
import type { Surface } from "./surface";

export type Mode = "body" | "depth" | "speed" | "strain" | "contact";

/// A pose and what its values are computed from.
export interface Shown {
  positions: Float32Array;
  before: Float32Array | null;
  seconds: number; // since the pose before
  marks: Marks;
}

const rampColours = Array.from({ length: 256 }, (_, i) => toLinear(rampColour(i / 255)));
const contactColours = contactNames.map((_, i) => toLinear(contactColour(i)));

/// Colours and values of the vertices of a pose.
export class Colouring {
  readonly modes: Mode[];
  private bodies: Rgb[];
  private fastest: number;
  private deepest: number;

  constructor(
    private head: Head,
    private surface: Surface,
    private rest: Float32Array | null,
  ) {
    this.modes = ["body"];
    if (head.marked.length > 0) this.modes.push("depth", "contact");
    if (head.kind === "run" && head.times.length > 1) this.modes.push("speed");
    if (rest) this.modes.push("strain");
    this.bodies = Array.from({ length: surface.bodyCount }, (_, b) => toLinear(bodyColour(b)));
    const largest = (name: string) => (head.statistics ? column(head, name).reduce((a, b) => Math.max(a, b), 0) : 0);
    this.fastest = largest("fastest");
    this.deepest = largest("deepest_penetration");
  }

  /// Values of a mode other than "body" and "contact".
  values(mode: Mode, shown: Shown): Float32Array {
    if (mode === "depth") return depths(this.surface, shown.marks);
    if (mode === "strain") return strains(this.rest!, shown.positions, this.surface.triangles);
    return shown.before ? speeds(shown.before, shown.positions, shown.seconds) : new Float32Array(this.surface.vertexCount);
  }

  /// The value that has the brightest colour.
  private top(mode: Mode, values: Float32Array): number {
    const known = mode === "depth" ? this.deepest : mode === "speed" ? this.fastest : 0.5;
    return known > 0 ? known : values.reduce((a, b) => Math.max(a, b), 0) || 1;
  }

  /// Colour of each vertex, and the legend as HTML.
  paint(mode: Mode, shown: Shown): { rgb: Float32Array; legend: HTMLElement[] } {
    const count = this.surface.vertexCount;
    const rgb = new Float32Array(3 * count);
    if (mode === "body" || mode === "contact") {
      const kinds = mode === "contact" ? contacts(this.surface, shown.marks) : null;
      for (let v = 0; v < count; ++v) rgb.set(kinds ? contactColours[kinds[v]] : this.bodies[this.surface.bodies[v]], 3 * v);
      return { rgb, legend: kinds ? contactLegend(kinds) : this.bodyLegend() };
    }
    const values = this.values(mode, shown);
    const top = this.top(mode, values);
    for (let v = 0; v < count; ++v) {
      const colour = rampColours[Math.max(0, Math.min(255, Math.round((255 * values[v]) / top)))];
      // What is not inside has no depth, and stays apart from what is.
      rgb.set(mode === "depth" && values[v] === 0 ? contactColours[0] : colour, 3 * v);
    }
    return { rgb, legend: [rampLegend(mode, top)] };
  }

  private bodyLegend(): HTMLElement[] {
    const names = this.head.scene?.bodies.map((body) => body.name) ?? [];
    if (this.surface.bodyCount < 2 || this.surface.bodyCount > 12) return [];
    return this.bodies.map((_, b) => swatch(bodyColour(b), names[b] ?? `part ${b + 1}`));
  }

  /// What is known of a vertex in a pose, line by line.
  describe(vertex: number, shown: Shown): string[] {
    const p = shown.positions.subarray(3 * vertex, 3 * vertex + 3);
    const body = this.surface.bodies[vertex];
    const name = this.head.scene?.bodies[body]?.name ?? `part ${body + 1}`;
    const lines = [`vertex ${this.surface.vertexIds[vertex]} of ${name}`];
    lines.push(`at ${[...p].map((x) => shortNumber(x)).join(", ")} m`);
    if (this.modes.includes("speed")) lines.push(`${shortNumber(this.values("speed", shown)[vertex])} m/s`);
    if (this.modes.includes("strain"))
      lines.push(`strained by ${shortNumber(100 * this.values("strain", shown)[vertex])} %`);
    const contact = contacts(this.surface, shown.marks)[vertex];
    if (contact === 1) lines.push(`inside, ${shortNumber(1e3 * this.values("depth", shown)[vertex])} mm deep`);
    else if (this.head.marked.length > 0) lines.push(contactNames[contact]);
    return lines;
  }
}

function swatch(colour: Rgb, name: string): HTMLElement {
  const line = document.createElement("span");
  line.className = "swatch";
  const box = document.createElement("i");
  box.style.background = `rgb(${colour.map((c) => Math.round(255 * c)).join()})`;
  line.append(box, name);
  return line;
}

function contactLegend(kinds: Uint8Array): HTMLElement[] {
  const counts = new Array<number>(contactNames.length).fill(0);
  for (const kind of kinds) ++counts[kind];
  return contactNames.flatMap((name, i) => (counts[i] > 0 ? [swatch(contactColour(i), `${name}: ${counts[i]}`)] : []));
}

const rampTitles: Record<string, (top: number) => [string, string]> = {
  depth: (top) => ["depth inside", `${shortNumber(1e3 * top)} mm`],
  speed: (top) => ["speed", `${shortNumber(top)} m/s`],
  strain: (top) => ["largest strain", `${shortNumber(100 * top)} % and more`],
};

function rampLegend(mode: Mode, top: number): HTMLElement {
  const [title, most] = rampTitles[mode](top);
  const line = document.createElement("span");
  line.className = "ramp";
  const bar = document.createElement("i");
  const stops = [0, 0.25, 0.5, 0.75, 1].map((x) => `rgb(${rampColour(x).map((c) => Math.round(255 * c)).join()})`);
  bar.style.background = `linear-gradient(to right, ${stops.join()})`;
  line.append(`${title}: 0 `, bar, ` ${most}`);
  return line;
}
