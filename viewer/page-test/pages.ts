// Pages as the program writes them, and the browser. SELVAGE names the program, CHROMIUM the browser.
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { chromium, type Browser } from "playwright-core";
import { afterAll, beforeAll, expect } from "vitest";

const program = resolve(process.env.SELVAGE ?? "../build/release/selvage");
const folder = mkdtempSync(join(tmpdir(), "selvage-page-"));
export const path = (name: string) => join(folder, name);
const selvage = (...words: string[]) => execFileSync(program, [...words, "--quiet"], { cwd: folder });

/// A block that falls on another, which overlaps a third from the start, beside a plate that moves and turns.
const scene = {
  selvage_scene: 1,
  frames: 20,
  substeps: 4,
  bodies: [
    {
      name: "block",
      mesh: { shape: "box", size: [1, 1, 1], cell: 0.25 },
      material: { youngs_modulus: 2e4 },
      translate: [0, 0, 0.05],
      instances: { list: [{}, { translate: [0.3, 0.2, 1.2] }, { translate: [0.9, 0.1, 0] }] },
      velocity: [0, 0, -2],
    },
  ],
  colliders: [
    { plane: { point: [0, 0, 0], normal: [0, 0, 1] } },
    { sphere: { centre: [-2, 0, 1], radius: 0.5 }, motion: { keyframes: [{ time: 0 }, { time: 0.3, translate: [0, 0, 1] }] } },
  ],
};

/// A sheet that falls beside an egg, which grows to twice its height in twelve key frames, and goes up.
const eggScene = {
  selvage_scene: 1,
  frames: 20,
  bodies: [{ mesh: { shape: "cloth", size: [1, 1, 0], cell: 0.125 }, translate: [0.32, -0.5, 1.2], material: { kind: "cloth", density: 0.2, thickness: 0.02 } }],
  colliders: [
    { plane: { point: [0, 0, 0], normal: [0, 0, 1] } },
    { keyframed: { files: "egg_*.obj", frames_per_second: 36 }, translate: [0, 0, 0.4], motion: { keyframes: [{ time: 0 }, { time: 0.3, translate: [0, 0, 0.4] }] } },
  ],
};

/// A sphere of rings, stretched.
function printEgg(height: number): string {
  const [rings, around] = [12, 24];
  const vertices = [[0, 0, -height]];
  for (let r = 1; r < rings; ++r)
    for (let i = 0; i < around; ++i) {
      const [up, turn] = [(Math.PI * r) / rings, (2 * Math.PI * i) / around];
      vertices.push([0.3 * Math.sin(up) * Math.cos(turn), 0.3 * Math.sin(up) * Math.sin(turn), -height * Math.cos(up)]);
    }
  vertices.push([0, 0, height]);
  const at = (r: number, i: number) => (r === 0 ? 0 : r === rings ? vertices.length - 1 : 1 + (r - 1) * around + (i % around));
  const triangles: number[][] = [];
  for (let r = 0; r < rings; ++r)
    for (let i = 0; i < around; ++i) {
      if (r > 0) triangles.push([at(r, i), at(r, i + 1), at(r + 1, i)]);
      if (r < rings - 1) triangles.push([at(r, i + 1), at(r + 1, i + 1), at(r + 1, i)]);
    }
  return [...vertices.map((v) => `v ${v.join(" ")}`), ...triangles.map((t) => `f ${t.map((v) => v + 1).join(" ")}`)].join("\n");
}

/// Writes run.html, egg.html and check.html, step.html, paths.html and resolve.html, with the JSON that they are of.
function writePages(): void {
  writeFileSync(path("blocks.json"), JSON.stringify(scene));
  selvage("simulate", "blocks.json", "-o", "run");
  selvage("view", "run", "-o", "run.html");
  for (let k = 0; k < 12; ++k) writeFileSync(path(`egg_${k}.obj`), printEgg(0.2 + (0.2 * k) / 11));
  writeFileSync(path("egg.json"), JSON.stringify(eggScene));
  selvage("simulate", "egg.json", "-o", "egg");
  selvage("view", "egg", "-o", "egg.html");
  selvage("make", "rod", "--length", "8", "--radius", "0.2", "--pose", "self-crossing", "-o", "rod.vtu");
  selvage("resolve", "rod.vtu", "-o", "free.vtu", "--json", "resolve.json");
  selvage("paths", "rod.vtu", "--json", "paths.json");
  for (const words of [["check", "rod.vtu", "--json", "check.json"], ["check", "free.vtu", "--to", "rod.vtu", "--json", "step.json"]]) {
    try {
      selvage(...words);
    } catch (error) {
      expect((error as { status: number }).status).toBe(1); // there are pairs
    }
  }
  for (const name of ["check", "step", "paths", "resolve"]) selvage("view", `${name}.json`, "-o", `${name}.html`);
}

function removePages(): void {
  rmSync(folder, { recursive: true });
}

function launchChromium(): Promise<Browser> {
  const executablePath = process.env.CHROMIUM ?? "/usr/bin/chromium";
  const args = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
  return chromium.launch({ executablePath, args });
}

/// Writes the pages before the tests of a file, opens a browser for them, and hands it out.
export function usePages(): () => Browser {
  let browser: Browser;
  beforeAll(async () => {
    writePages();
    browser = await launchChromium();
  });
  afterAll(async () => {
    await browser?.close();
    removePages();
  });
  return () => browser;
}
