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

/// Writes run.html and check.html, step.html, paths.html and resolve.html, with the JSON that they are of.
function writePages(): void {
  writeFileSync(path("blocks.json"), JSON.stringify(scene));
  selvage("simulate", "blocks.json", "-o", "run");
  selvage("view", "run", "-o", "run.html");
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
