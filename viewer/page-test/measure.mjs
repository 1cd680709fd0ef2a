// Prints how large pages are, how long they take to open, and how many pictures a second they draw by software.
//
//     node page-test/measure.mjs                  Chromium
//     xvfb-run node page-test/measure.mjs         Firefox too, which has WebGL only on a screen
//
// SELVAGE, CHROMIUM and FIREFOX name the programs. Times mean something on a machine that does nothing else.
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { cpus, tmpdir } from "node:os";
import { join, resolve } from "node:path";
import playwright from "playwright-core";

const program = resolve(process.env.SELVAGE ?? "../build/release/selvage");
const folder = mkdtempSync(join(tmpdir(), "selvage-measure-"));
const selvage = (...words) => execFileSync(program, [...words, "--quiet"], { cwd: folder });

/// A ring with a wavy surface, of 2 * across * around triangles, as an OBJ file.
function writeRing(path, around, across) {
  const lines = [];
  for (let i = 0; i < around; ++i)
    for (let k = 0; k < across; ++k) {
      const [u, v] = [(2 * Math.PI * i) / around, (2 * Math.PI * k) / across];
      const radius = 0.3 + 0.03 * Math.sin(24 * u) * Math.sin(12 * v);
      const far = 1 + radius * Math.cos(v);
      lines.push(`v ${far * Math.cos(u)} ${far * Math.sin(u)} ${radius * Math.sin(v)}`);
    }
  const at = (i, k) => 1 + (i % around) * across + (k % across);
  for (let i = 0; i < around; ++i)
    for (let k = 0; k < across; ++k) {
      lines.push(`f ${at(i, k)} ${at(i + 1, k)} ${at(i + 1, k + 1)}`, `f ${at(i, k)} ${at(i + 1, k + 1)} ${at(i, k + 1)}`);
    }
  writeFileSync(path, `${lines.join("\n")}\n`);
}

async function openPage(browser, name) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  page.on("pageerror", (error) => console.log(`  error: ${error.message}`));
  const start = performance.now();
  await page.goto(`file://${join(folder, name)}`);
  await page.waitForFunction(() => document.documentElement.dataset.state, null, { timeout: 120000 });
  const seconds = (performance.now() - start) / 1000;
  const count = (id) => page.evaluate((key) => JSON.parse(document.getElementById("head").textContent)[key], id);
  const size = `${(statSync(join(folder, name)).size / 1e6).toFixed(1)} MB, ${await count("vertices")} vertices, ${await count("triangles")} triangles`;
  console.log(`  ${name}: ${size}: opens in ${seconds.toFixed(2)} s (${await page.evaluate(() => document.documentElement.dataset.state)})`);
  return page;
}

/// Plays a run three times, and counts what is drawn: the first time decodes, too.
async function measurePlaying(page) {
  for (const round of ["first", "second", "third"]) {
    await page.keyboard.press("Home");
    await page.waitForFunction(() => document.documentElement.dataset.frame === "0");
    const rate = await page.evaluate(async () => {
      const state = document.documentElement.dataset;
      const drawn = Number(state.drawn);
      const start = performance.now();
      document.getElementById("play").click();
      while (state.playing === "yes") await new Promise((done) => setTimeout(done, 5));
      return (1000 * (Number(state.drawn) - drawn)) / (performance.now() - start);
    });
    console.log(`  played at full speed, ${round} time: ${rate.toFixed(1)} pictures a second`);
  }
}

async function measure(name, launch) {
  const browser = await launch();
  console.log(`${name} ${browser.version()}`);
  const run = await openPage(browser, "run.html");
  await measurePlaying(run);
  await run.keyboard.press("m");
  await run.keyboard.press("m");
  await run.keyboard.press("m");
  console.log(`  coloured by ${await run.evaluate(() => document.documentElement.dataset.colour)}:`);
  await measurePlaying(run);
  await run.close();
  await (await openPage(browser, "ring.html")).close();
  await browser.close();
}

try {
  console.log(`${cpus()[0].model}, ${cpus().length} cores seen`);
  // The scene with more octopi: 40,770 vertices on the surface.
  const scene = JSON.parse(readFileSync("../scenes/octopi_8_hybrid.json", "utf8"));
  scene.bodies[0].instances.grid.counts = [2, 1, 9];
  writeFileSync(join(folder, "octopi.json"), JSON.stringify(scene));
  selvage("simulate", "octopi.json", "--frames", "60", "-o", "run", "--no-report");
  selvage("view", "run", "-o", "run.html");
  writeRing(join(folder, "ring.obj"), 1000, 350);
  selvage("view", "ring.obj", "-o", "ring.html");
  const executablePath = process.env.CHROMIUM ?? "/usr/bin/chromium";
  const args = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
  await measure("Chromium", () => playwright.chromium.launch({ executablePath, args }));
  const firefox = process.env.FIREFOX ?? "/usr/bin/firefox-esr";
  const firefoxUserPrefs = { "webgl.force-enabled": true };
  if (process.env.DISPLAY && existsSync(firefox))
    await measure("Firefox", () => playwright._bidiFirefox.launch({ executablePath: firefox, headless: false, firefoxUserPrefs }));
} finally {
  rmSync(folder, { recursive: true });
}
