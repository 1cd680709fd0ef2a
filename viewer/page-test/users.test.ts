// The page for fingers, for screen readers, and in Firefox. FIREFOX names that browser.
import { existsSync } from "node:fs";
import playwright, { type BrowserType, type Page } from "playwright-core";
import { describe, expect, it } from "vitest";
import { path, usePages } from "./pages";

const browser = usePages();
let page: Page;

const until = (name: string, value: string) =>
  page.waitForFunction(([n, v]) => document.documentElement.dataset[n] === v, [name, value], { timeout: 20000 });

describe("the page for fingers and for screen readers", () => {
  it("tells the values of a vertex that is tapped on", async () => {
    page = await browser().newPage({ viewport: { width: 400, height: 760 }, hasTouch: true });
    await page.goto(`file://${path("run.html")}`);
    await until("state", "ready");
    const box = (await page.locator("#picture").boundingBox())!;
    await page.touchscreen.tap(box.x + box.width / 2, box.y + box.height / 2);
    await page.waitForFunction(() => document.documentElement.dataset.picked);
    expect(await page.textContent("#pick")).toMatch(/^vertex \d+ of block/);
  });

  it("has a name for every control and says what is in the picture", async () => {
    const nameless = await page.locator("button, input, select, canvas#picture, output").evaluateAll((parts) =>
      parts
        .filter((part) => {
          const ids = part.getAttribute("aria-labelledby")?.split(" ") ?? [];
          const names = [part.ariaLabel, part.getAttribute("title"), part.closest("label")?.textContent, ...ids.map((id) => document.getElementById(id)?.textContent)];
          return part.tagName !== "OUTPUT" && !part.textContent?.trim() && !names.some((name) => name?.trim());
        })
        .map((part) => part.outerHTML),
    );
    expect(nameless).toEqual([]);
    expect(await page.getAttribute("#picture", "aria-label")).toMatch(/^Picture of blocks: \d+ triangles, 21 poses/);
    // Numbers that change all the time are not read out.
    expect(await page.getAttribute("#clock", "aria-live")).toBe("off");
    await page.close();
  });
});

describe("the page in another browser", () => {
  const complaints: string[] = [];

  // Firefox draws only where there is a screen: xvfb-run.
  const firefox = process.env.FIREFOX ?? "/usr/bin/firefox-esr";
  it.skipIf(!process.env.DISPLAY || !existsSync(firefox))("open in Firefox too", async () => {
    const firefoxUserPrefs = { "webgl.force-enabled": true };
    const other = await (playwright as unknown as { _bidiFirefox: BrowserType })._bidiFirefox.launch({ executablePath: firefox, headless: false, firefoxUserPrefs });
    for (const name of ["run", "check", "step", "paths", "resolve"]) {
      page = await other.newPage({ viewport: { width: 1000, height: 700 } });
      page.on("console", (message) => complaints.push(`console of Firefox: ${message.text()}`));
      page.on("pageerror", (error) => complaints.push(`error in Firefox: ${error.message}`));
      await page.goto(`file://${path(`${name}.html`)}`);
      await until("state", "ready");
      await page.keyboard.press("c");
      await until("cut", "y");
      if (name !== "check" && name !== "paths") await page.keyboard.press("End");
      if (name === "run") await until("frame", "20");
      await page.close();
    }
    await other.close();
    expect(complaints).toEqual([]);
  });
});
