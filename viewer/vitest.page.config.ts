import { defineConfig } from "vitest/config";

// The page in a browser: one after the other, for a picture that is drawn by software takes all cores.
export default defineConfig({
  test: { include: ["page-test/**/*.test.ts"], fileParallelism: false, testTimeout: 60000, hookTimeout: 60000 },
});
