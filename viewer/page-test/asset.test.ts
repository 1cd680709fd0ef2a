// The built file that is committed is the one that the sources give.
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { build } from "vite";
import { expect, it } from "vitest";

it("dist/index.html is what `npm run build` makes", async () => {
  const outDir = mkdtempSync(join(tmpdir(), "selvage-asset-"));
  try {
    await build({ logLevel: "error", build: { outDir, emptyOutDir: true } });
    const made = readFileSync(join(outDir, "index.html"), "utf8");
    const kept = readFileSync("dist/index.html", "utf8");
    expect(made === kept, "run `npm run build` in viewer/ and commit dist/index.html").toBe(true);
    expect(made.match(/<!--data-->/g)?.length).toBe(1);
    expect(made).not.toMatch(/(src|href)="(https?:|\/)/);
  } finally {
    rmSync(outDir, { recursive: true });
  }
});
