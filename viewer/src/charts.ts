import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Head } from "./head";

export interface Line {
  label: string;
  values: number[];
  colour: string;
}

export interface Chart {
  title: string;
  stacked: boolean;
  lines: Line[];
}

/// Values of a column of the statistics in the frames that are shown.
export function column(head: Head, name: string): number[] {
  const at = head.statistics!.columns.indexOf(name);
  const rows = head.statistics!.rows;
  return (head.frames ?? []).map((frame) => (at < 0 ? 0 : (rows[frame][at] ?? 0)));
}

/// What the charts show of a run.
export function chartsOf(head: Head): Chart[] {
  if (!head.statistics || !head.frames) return [];
  const line = (label: string, name: string, colour: string, scale = 1): Line => ({ label, colour, values: column(head, name).map((x) => scale * x) });
  const times = [
    line("material", "seconds_material", "#0072b2", 1e3),
    line("projection", "seconds_projection", "#56b4e9", 1e3),
    line("DCD", "seconds_dcd", "#009e73", 1e3),
    line("paths", "seconds_paths", "#cc79a7", 1e3),
    line("CCD", "seconds_ccd", "#e69f00", 1e3),
  ];
  const rest = line("rest", "seconds_frame", "#999999", 1e3);
  rest.values = rest.values.map((all, i) => Math.max(0, all - times.reduce((sum, t) => sum + t.values[i], 0)));
  const inside = [
    line("deepest [mm]", "deepest_penetration", "#d55e00", 1e3),
    line("vertices", "penetrating_vertices", "#0072b2"),
    line("crossing pairs", "triangle_pairs", "#cc79a7"),
  ];
  const contacts = [
    line("vertex paths", "vertex_paths", "#d55e00"),
    line("edge paths", "edge_paths", "#e69f00"),
    line("centroid paths", "centroid_paths", "#f0e442"),
    line("vertex-face", "vertex_faces", "#009e73"),
    line("edge-edge", "edge_edges", "#56b4e9"),
    line("colliders", "collider_contacts", "#999999"),
  ];
  const motion = [line("kinetic [J]", "kinetic_energy", "#009e73"), line("elastic [J]", "elastic_energy", "#0072b2"), line("fastest [m/s]", "fastest", "#e69f00")];
  return [
    { title: "time of a frame [ms]", stacked: true, lines: [...times, rest] },
    { title: "inside", stacked: false, lines: inside },
    { title: "contacts", stacked: true, lines: contacts },
    { title: "energy, speed", stacked: false, lines: motion },
  ];
}

/// Each line on top of those before it.
export function stack(lines: Line[]): number[][] {
  const sums: number[][] = [];
  for (const line of lines) sums.push(line.values.map((x, i) => x + (sums.length ? sums[sums.length - 1][i] : 0)));
  return sums;
}

function shortTicks(_: uPlot, ticks: number[]): string[] {
  return ticks.map((x) => (x >= 1e6 ? `${x / 1e6}M` : x >= 1e3 ? `${x / 1e3}k` : `${x}`));
}

function fromZero(_: uPlot, __: number, most: number): [number, number] {
  return [0, most > 0 ? 1.05 * most : 1];
}

/// Charts under the picture, with a line at the pose that is shown; a click goes there.
export class Charts {
  private plots: uPlot[] = [];
  private lines: HTMLElement[] = []; // at the pose that is shown
  private timer?: number;
  private pose = 0;

  constructor(
    private parent: HTMLElement,
    private head: Head,
    private goTo: (pose: number) => void,
  ) {
    parent.hidden = false;
    this.build();
    new ResizeObserver(() => this.resize()).observe(parent);
  }

  build(): void {
    for (const plot of this.plots) plot.destroy();
    this.lines = [];
    this.parent.replaceChildren();
    this.plots = chartsOf(this.head).map((chart) => this.plot(chart));
    this.showPose(this.pose);
  }

  private width(): number {
    return Math.max(220, this.parent.clientWidth / Math.max(1, this.plots.length || 4) - 8);
  }

  private resize(): void {
    for (const plot of this.plots) plot.setSize({ width: this.width(), height: 120 });
    this.showPose(this.pose);
  }

  private plot(chart: Chart): uPlot {
    const ink = getComputedStyle(document.documentElement).getPropertyValue("--ink").trim() || "#333333";
    const faint = { stroke: "#88888833", width: 1 };
    const values = chart.stacked ? stack(chart.lines) : chart.lines.map((line) => line.values);
    const series = chart.lines.map((line, i) => ({
      label: line.label,
      stroke: line.colour,
      fill: chart.stacked ? line.colour : undefined,
      width: chart.stacked ? 0 : 1.5,
      scale: chart.stacked || i === 0 ? "y" : `y${i}`,
      points: { show: false },
      // The value of the line, not of the stack.
      value: (_: uPlot, __: number, ___: number, at: number | null) =>
        at === null ? "" : String(Number(line.values[at].toPrecision(4))),
    }));
    // The highest sum is drawn first, so that each band stays to be seen.
    if (chart.stacked) {
      series.reverse();
      values.reverse();
    }
    const options: uPlot.Options = {
      width: this.width(),
      height: 120,
      title: chart.title,
      cursor: { drag: { x: false, y: false }, y: false },
      scales: {
        x: { time: false },
        // From zero, so that heights can be compared.
        ...Object.fromEntries(chart.lines.map((_, i) => [chart.stacked || i === 0 ? "y" : `y${i}`, { range: fromZero }])),
      },
      legend: { live: true },
      axes: [
        { stroke: ink, grid: faint, ticks: faint, size: 30, font: "10px sans-serif", space: 50 },
        { stroke: ink, grid: faint, ticks: faint, size: 42, font: "10px sans-serif", space: 24, values: shortTicks },
      ],
      series: [{ label: "frame" }, ...series],
    };
    const plot = new uPlot(options, [this.head.frames!, ...values] as uPlot.AlignedData, this.parent);
    const line = document.createElement("div");
    line.className = "now";
    plot.over.append(line);
    this.lines.push(line);
    plot.over.addEventListener("click", () => {
      if (plot.cursor.idx !== null && plot.cursor.idx !== undefined) this.goTo(plot.cursor.idx);
    });
    return plot;
  }

  /// The lines move with every pose; the numbers below, which cost more to lay out than the picture, a few times a second.
  showPose(pose: number): void {
    this.pose = pose;
    this.plots.forEach((plot, i) => {
      this.lines[i].style.transform = `translateX(${plot.valToPos(this.head.frames![pose], "x")}px)`;
    });
    this.timer ??= window.setTimeout(() => {
      this.timer = undefined;
      for (const plot of this.plots) plot.setLegend({ idx: this.pose }, false);
    }, 150);
  }
}
