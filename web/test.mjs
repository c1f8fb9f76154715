// Bundles test/*.test.ts and runs them with Node's own test runner.

import { spawnSync } from "node:child_process";
import { readdirSync, rmSync } from "node:fs";
import { dirname, join } from "node:path";
import { execPath, exit } from "node:process";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const folder = join(here, ".test");
rmSync(folder, { recursive: true, force: true });
await build({
  absWorkingDir: here,
  entryPoints: readdirSync(join(here, "test"))
    .filter((name) => name.endsWith(".test.ts"))
    .map((name) => `test/${name}`),
  outdir: folder,
  outExtension: { ".js": ".mjs" },
  bundle: true,
  define: { PATHS: "true", EDITED: "true", FRAMES: "true" },
  platform: "node",
  format: "esm",
  target: "node20",
  logLevel: "warning",
});
const files = readdirSync(folder).map((name) => join(folder, name));
exit(spawnSync(execPath, ["--test", ...files], { stdio: "inherit" }).status ?? 1);
