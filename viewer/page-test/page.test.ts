// The page in Chromium, as the program writes it.
import { readFileSync, writeFileSync } from "node:fs";
import type { Page } from "playwright-core";
import { describe, expect, it } from "vitest";
import { path, usePages } from "./pages";

const browser = usePages();
let page: Page;
const complaints: string[] = [];

async function open(name: string, options: { width?: number; script?: string } = {}): Promise<Page> {
  page = await browser().newPage({ viewport: { width: options.width ?? 1000, height: 700 } });
  page.on("console", (message) => complaints.push(`console: ${message.text()}`));
  page.on("pageerror", (error) => complaints.push(`error: ${error.message}`));
  page.on("request", (request) => {
    if (!/^(file|data|blob):/.test(request.url())) complaints.push(`request: ${request.url()}`);
  });
  if (options.script) await page.addInitScript(options.script);
  await page.goto(`file://${path(name)}`);
  await page.waitForFunction(() => document.documentElement.dataset.state, null, { timeout: 40000 });
  return page;
}

const state = (): Promise<Record<string, string>> => page.evaluate(() => ({ ...document.documentElement.dataset }) as Record<string, string>);
const until = (name: string, value: string) =>
  page.waitForFunction(([n, v]) => document.documentElement.dataset[n] === v, [name, value], { timeout: 20000 });

/// Pixels of a picture, and the picture itself, made smaller.
function decode(png: string, shrink: number): Promise<{ pixels: number[]; png: string }> {
  return page.evaluate(
    async ([text, factor]) => {
      const image = new Image();
      image.src = `data:image/png;base64,${text}`;
      await image.decode();
      const canvas = document.createElement("canvas");
      canvas.width = Math.round(image.width / Number(factor));
      canvas.height = Math.round(image.height / Number(factor));
      const context = canvas.getContext("2d")!;
      context.drawImage(image, 0, 0, canvas.width, canvas.height);
      const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
      return { pixels: [...data], png: canvas.toDataURL().split(",")[1] };
    },
    [png, shrink],
  );
}

/// The picture as it is on the screen, at a quarter of the size.
async function look(): Promise<{ pixels: number[]; png: string }> {
  await page.waitForTimeout(300);
  return decode((await page.locator("#picture").screenshot()).toString("base64"), 4);
}

const pixels = async () => (await look()).pixels;

/// Share of the pixels of which a channel differs by more than a fifth of its range.
function difference(a: number[], b: number[]): number {
  expect(a.length).toBe(b.length);
  let count = 0;
  for (let i = 0; i < a.length; i += 4) if ([0, 1, 2].some((c) => Math.abs(a[i + c] - b[i + c]) > 51)) ++count;
  return (4 * count) / a.length;
}

describe("the page of a run", () => {
  it("opens without a word and shows the first frame", async () => {
    await open("run.html");
    expect((await state()).state).toBe("ready");
    expect(await page.textContent("#title")).toBe("blocks");
    expect(await page.textContent("#warnings")).toContain("Before the first frame");
    expect(await page.textContent("#clock")).toBe("frame 0, 0.000 s");
    expect(await page.locator("#charts .uplot").count()).toBe(4);
  });

  it("looks as it did", async () => {
    const { pixels: shot, png } = await look();
    const kept = "page-test/run.png";
    if (process.env.KEEP) writeFileSync(kept, Buffer.from(png, "base64"));
    const { pixels: before } = await decode(readFileSync(kept).toString("base64"), 1);
    expect(difference(shot, before)).toBeLessThan(0.03);
    // The bodies are there, in their colours.
    const has = (r: number, g: number, b: number) => {
      let count = 0;
      for (let i = 0; i < shot.length; i += 4) {
        const [x, y, z] = shot.slice(i, i + 3);
        const size = Math.hypot(x, y, z);
        if (size > 60 && (x * r + y * g + z * b) / size / Math.hypot(r, g, b) > 0.985) ++count;
      }
      return count;
    };
    expect(has(0, 114, 178)).toBeGreaterThan(100);
    expect(has(230, 159, 0)).toBeGreaterThan(100);
  });

  it("goes to a frame by the slider, by keys and by a click on a chart", async () => {
    const first = await pixels();
    await page.locator("#scrub").fill("12");
    await until("frame", "12");
    expect(await page.textContent("#clock")).toBe("frame 12, 0.200 s");
    expect(difference(first, await pixels())).toBeGreaterThan(0.01);
    await page.keyboard.press("ArrowRight");
    await until("frame", "13");
    await page.keyboard.press("End");
    await until("frame", "20");
    await page.keyboard.press("Home");
    await until("frame", "0");
    // Keys that come faster than poses are decoded count all the same.
    await page.evaluate(() => {
      for (let i = 0; i < 9; ++i) document.body.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight", bubbles: true }));
    });
    await until("frame", "9");
    await page.locator("#charts .u-over").first().click({ position: { x: 100, y: 20 } });
    await page.waitForFunction(() => Number(document.documentElement.dataset.frame) > 3);
    await page.keyboard.press("Home");
    await until("frame", "0");
  });

  it("plays to the end and stops", async () => {
    // Slowly, so that it can be seen.
    await page.locator("#speed").selectOption("0.1");
    await page.locator("#scrub").focus();
    await page.keyboard.press(" ");
    await until("playing", "yes");
    await until("frame", "20");
    await until("playing", "");
    expect(Number((await state()).drawn)).toBeGreaterThan(3);
  });

  it("shows contacts as arrows, and keys work after a click on a box", async () => {
    await page.keyboard.press("End");
    await until("frame", "20");
    const before = await pixels();
    const box = page.locator("#options").getByText("contacts", { exact: true }).locator("..").locator("input");
    await box.click();
    expect(difference(before, await pixels())).toBeGreaterThan(0.0005);
    await page.keyboard.press(" ");
    expect(await box.isChecked()).toBe(false);
    await page.keyboard.press("m");
    await page.keyboard.press("m");
    expect((await state()).colour).toBe("contact");
    expect(await page.textContent("#legend")).toMatch(/collider: \d+/);
    for (let i = 0; i < 3; ++i) await page.keyboard.press("m");
  });

  it("knows speeds of a pose that stands still, and after a change of colours", async () => {
    await page.locator("#scrub").fill("12");
    await until("frame", "12");
    while ((await state()).colour !== "speed") await page.keyboard.press("m");
    const bright = (shot: number[]) => shot.filter((c, i) => i % 4 === 0 && c > 150 && shot[i + 2] < 0.7 * c).length;
    expect(bright(await pixels())).toBeGreaterThan(50);
    await page.keyboard.press("m");
    await page.keyboard.press("m");
  });

  it("colours by all that it knows", async () => {
    await page.keyboard.press("Home");
    await until("frame", "0");
    const seen = [(await state()).colour];
    for (let i = 0; i < 4; ++i) {
      await page.keyboard.press("m");
      seen.push((await state()).colour);
    }
    expect(seen).toEqual(["body", "depth", "contact", "speed", "strain"]);
    expect(await page.textContent("#legend")).toContain("largest strain");
    await page.keyboard.press("m");
    expect(await page.locator("#legend .swatch").count()).toBe(3);
  });

  it("cuts the bodies open, with caps", async () => {
    await page.keyboard.press("e");
    const whole = await pixels();
    await page.keyboard.press("c");
    await until("cut", "y");
    const cut = await pixels();
    expect(difference(whole, cut)).toBeGreaterThan(0.02);
    // Caps have one colour: that of their body, darker. Many pixels are equal.
    const counts = new Map<string, number>();
    for (let i = 0; i < cut.length; i += 4) {
      const name = cut.slice(i, i + 3).join();
      counts.set(name, (counts.get(name) ?? 0) + 1);
    }
    const caps = [...counts].filter(([name, count]) => {
      const [r, , b] = name.split(",").map(Number);
      return count > 60 && Math.abs(r - b) > 80;
    });
    expect(caps.length).toBeGreaterThanOrEqual(2);
    await page.keyboard.press("]");
    await page.keyboard.press("c");
    await until("cut", "");
    await page.keyboard.press("e");
  });

  it("tells the values of a vertex that is clicked on", async () => {
    await page.keyboard.press("f");
    await page.waitForTimeout(200);
    const box = (await page.locator("#picture").boundingBox())!;
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
    const text = (await page.textContent("#pick"))!;
    expect(text).toMatch(/^vertex \d+ of block/);
    expect(text).toContain("m/s");
    expect(text).toContain("strained by");
    await page.mouse.click(box.x + 5, box.y + box.height - 5);
    expect(await page.locator("#pick").isHidden()).toBe(true);
  });

  it("turns under the mouse", async () => {
    const before = await pixels();
    const box = (await page.locator("#picture").boundingBox())!;
    await page.mouse.move(box.x + 500, box.y + 200);
    await page.mouse.down();
    await page.mouse.move(box.x + 700, box.y + 250, { steps: 5 });
    await page.mouse.up();
    expect(difference(before, await pixels())).toBeGreaterThan(0.02);
    expect(await page.locator("#pick").isHidden()).toBe(true);
    await page.keyboard.press("f");
  });

  it("is dark or light, and tells its numbers and its keys", async () => {
    const { theme } = await state();
    await page.keyboard.press("d");
    expect((await state()).theme).not.toBe(theme);
    await page.keyboard.press("i");
    const details = await page.textContent("#details");
    for (const word of ["outcome", "finished", "youngs modulus", "gravity", "frames per second"]) expect(details?.replaceAll("_", " ")).toContain(word);
    await page.keyboard.press("i");
    expect(await page.locator("#details").isHidden()).toBe(true);
    await page.keyboard.press("h");
    expect(await page.locator("#keys").isVisible()).toBe(true);
    await page.keyboard.press("Escape");
    await page.close();
  });

  it("is written by simulate too, with the machine", async () => {
    await open("run/report.html", { width: 400 });
    expect((await state()).state).toBe("ready");
    expect(await page.textContent("#details")).toContain("processor");
    // On a narrow screen nothing is wider than the screen.
    expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(400);
    await page.close();
  });

  it("has numbers and charts where there is no WebGL", async () => {
    const script = "HTMLCanvasElement.prototype.getContext = ((get) => function (kind, ...rest) { return /webgl/.test(kind) ? null : get.call(this, kind, ...rest); })(HTMLCanvasElement.prototype.getContext);";
    await open("run.html", { script });
    expect((await state()).state).toBe("failed");
    expect(await page.textContent("#notice")).toContain("WebGL");
    expect(await page.locator("#charts .uplot").count()).toBe(4);
    expect(await page.locator("#details").isVisible()).toBe(true);
    await page.close();
    // three.js tells why on the console.
    const told = complaints.splice(0).filter((line) => !/WebGL/.test(line));
    expect(told).toEqual([]);
  });
});

describe("a collider that changes its form", () => {
  /// Rows of the picture in which it is seen: those that change when colliders are hidden.
  const rowsOfColliders = async () => {
    const box = page.locator("#options").getByText("colliders", { exact: true }).locator("..").locator("input");
    const shown = await pixels();
    await box.click();
    const hidden = await pixels();
    await box.click();
    const width = Math.round((await page.locator("#picture").boundingBox())!.width / 4);
    // Left of the panel, in which the box changes too.
    const changed = shown.flatMap((c, i) => (Math.abs(c - hidden[i]) > 20 && (i / 4) % width < 0.75 * width ? [Math.floor(i / 4 / width)] : []));
    return { top: Math.min(...changed), bottom: Math.max(...changed) };
  };

  it("has in each frame its own, and goes up by its motion", async () => {
    await open("egg.html");
    expect(await page.textContent("#warnings")).toBe("");
    const seen: { top: number; bottom: number }[] = [];
    for (const frame of [0, 10, 20]) {
      await page.locator("#scrub").fill(String(frame));
      await until("frame", String(frame));
      seen.push(await rowsOfColliders());
    }
    const heights = seen.map(({ top, bottom }) => bottom - top);
    expect(heights[0]).toBeGreaterThan(10);
    expect(heights[1]).toBeGreaterThan(1.15 * heights[0]);
    expect(heights[2]).toBeGreaterThan(1.15 * heights[1]);
    expect(seen[2].bottom).toBeLessThan(seen[0].bottom - 3);
    await page.close();
  });

  it("is told of when a form is missing", async () => {
    const text = readFileSync(path("egg.html"), "utf8");
    writeFileSync(path("lost.html"), text.replace(/id="block-collider1pose0"/, 'id="block-lost"'));
    await open("lost.html").catch(() => {});
    await page.waitForFunction(() => document.documentElement.dataset.state === "failed");
    expect(await page.textContent("#notice")).toContain("pose 0 is missing");
    await page.close();
  });
});

describe("pages of other results", () => {
  it("go from pair to pair of check", async () => {
    await open("check.html");
    expect(await page.textContent("#pair-label")).toMatch(/^\d+ colliding pairs$/);
    await page.keyboard.press("n");
    const { triangle_pairs } = JSON.parse(readFileSync(path("check.json"), "utf8"));
    const label = (i: number) => `pair ${i + 1} of ${triangle_pairs.length}: triangles ${triangle_pairs[i].join(" and ")}`;
    expect(await page.textContent("#pair-label")).toContain(label(0));
    await page.keyboard.press("p");
    expect(await page.textContent("#pair-label")).toContain(label(triangle_pairs.length - 1));
    await page.click("#pair-next");
    expect(await page.textContent("#pair-label")).toContain(label(0));
    await page.close();
  });

  it("blend the start and the end of a step", async () => {
    await open("step.html");
    expect(await page.textContent("#before")).toBe("start");
    const { vertex_face } = JSON.parse(readFileSync(path("step.json"), "utf8"));
    await page.keyboard.press("n");
    expect(await page.textContent("#pair-label")).toContain(`vertex ${vertex_face[0][0]}, face ${vertex_face[0][1]}`);
    const first = await pixels();
    await page.locator("#scrub").fill("0.5");
    await until("frame", "0.5");
    expect(difference(first, await pixels())).toBeGreaterThan(0.005);
    await page.close();
  });

  it("have the ways out of paths as arrows", async () => {
    await open("paths.html");
    const pink = (shot: number[]) => {
      let count = 0;
      for (let i = 0; i < shot.length; i += 4) if (shot[i] > 130 && shot[i + 1] < 0.7 * shot[i] && shot[i + 2] > 1.2 * shot[i + 1] && shot[i + 2] > 100) ++count;
      return count;
    };
    const shown = pink(await pixels());
    expect(shown).toBeGreaterThan(10);
    await page.getByText("ways out", { exact: true }).locator("..").locator("input").click();
    expect(pink(await pixels())).toBeLessThan(shown / 2);
    await page.close();
  });

  it("show the mesh before and after resolve", async () => {
    await open("resolve.html");
    const before = await pixels();
    expect(await page.textContent("#pair-label")).toContain("colliding pairs");
    await page.keyboard.press("End");
    await until("frame", "1");
    expect(await page.locator("#pairs").isHidden()).toBe(true);
    expect(difference(before, await pixels())).toBeGreaterThan(0.005);
    await page.keyboard.press(" ");
    expect((await state()).playing).toBe("yes");
    await page.close();
  });

  it("say what is wrong where there is no result", async () => {
    const text = readFileSync(path("check.html"), "utf8");
    writeFileSync(path("empty.html"), text.replace(/<script type="application\/json" id="head">.*<\/script>/, ""));
    await open("empty.html");
    expect(await page.textContent("#notice")).toContain("selvage view RESULT");
    await page.close();
    writeFileSync(path("damaged.html"), text.replace(/id="block-pose0"/, 'id="block-lost"'));
    await open("damaged.html").catch(() => {});
    await page.waitForFunction(() => document.documentElement.dataset.state === "failed");
    expect(await page.textContent("#notice")).toContain("pose 0 is missing");
    await page.close();
  });

  it("asked for nothing from outside, and complained of nothing", () => {
    expect(complaints).toEqual([]);
  });
});
