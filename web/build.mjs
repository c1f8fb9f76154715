// Builds the player: src/main.ts -> one minified ES module, and another one that also traces paths;
// and the scripts and style sheets of a lesson's page and of the studio, which have the player inside.
//
//   node build.mjs [FOLDER]     default: export, lessons and editor/app of ../src/distal
//
// The output is committed, so that nobody needs Node to export a page; a test builds it again and
// compares the bytes. Nothing of this machine goes in: no paths, no dates, no source map.

import { copyFile, mkdir, readFile, writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { argv } from "node:process";
import { fileURLToPath } from "node:url";
import { build, transform } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));

// Properties of our own get one letter, but those that the player sets: 170 bytes of each page.
function shortened(sheet) {
  const names = [...new Set(sheet.match(/--[a-z]+(?=:)/g))].filter((name) => name !== "--part");
  const letters = new Map(names.map((name, i) => [name, `--${String.fromCharCode(97 + i)}`]));
  return sheet.replace(/--[a-z]+\b(?!-)/g, (name) => letters.get(name) ?? name);
}

// A style sheet becomes a text, without its white space.
const styles = {
  name: "styles",
  setup(builder) {
    builder.onLoad({ filter: /\.css$/ }, async ({ path }) => {
      const source = await readFile(path, "utf8");
      const { code } = await transform(source, { loader: "css", minify: true, target: "chrome123" });
      return { contents: shortened(code.trim()), loader: "text" };
    });
  },
};

// The cell of the playground: a page whose script has the worker's script as a text.
async function cell(file) {
  const script = async (source, define) => {
    const options = { bundle: true, minify: true, format: "iife", target: "es2022", write: false };
    const made = await build({ absWorkingDir: here, entryPoints: [source], define, ...options });
    return made.outputFiles[0].text;
  };
  const worker = await script("src/cell/worker.ts", {});
  const frame = await script("src/cell/cell.ts", { WORKER: JSON.stringify(worker) });
  const page = await readFile(join(here, "src/cell/cell.html"), "utf8");
  await writeFile(file, page.replace("{script}", () => frame.trim().replaceAll("</script", "<\\/script")));
}

const folder = argv[2] ?? join(here, "../src/distal/export");
const lessons = argv[2] ?? join(here, "../src/distal/lessons");
const studio = argv[2] ?? join(here, "../src/distal/editor/app");
await mkdir(studio, { recursive: true });
for (const [source, file, paths, edited] of [
  ["src/main.ts", join(folder, "player.js"), "false", "false"],
  ["src/main.ts", join(folder, "path_player.js"), "true", "false"],
  ["src/lesson/main.ts", join(lessons, "lesson.js"), "false", "false"],
  ["src/studio/main.ts", join(studio, "studio.js"), "true", "true"],
]) {
  await build({
    absWorkingDir: here,
    entryPoints: [source],
    outfile: file,
    define: { PATHS: paths, EDITED: edited },
    bundle: true,
    minify: true,
    format: "esm",
    target: "es2022",
    charset: "utf8",
    legalComments: "none",
    plugins: [styles],
    logLevel: "warning",
  });
}
for (const [source, file] of [
  ["src/lesson/lesson.css", join(lessons, "lesson.css")],
  ["src/studio/studio.css", join(studio, "studio.css")],
]) {
  const sheet = await readFile(join(here, source), "utf8");
  const { code } = await transform(sheet, { loader: "css", minify: true, target: "chrome123" });
  await writeFile(file, code);
}
await cell(join(studio, "cell.html"));
await copyFile(join(here, "src/studio/studio.html"), join(studio, "studio.html"));
