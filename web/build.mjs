// Builds the player: src/main.ts -> one minified ES module, another one that also traces paths, one for
// pictures that keep frames, and one that also cuts scenes open and measures them;
// the scripts and style sheets of a lesson's page and of the studio, which have the player inside; the
// script of a mesh in a notebook; and that of posters made of triangles.
//
//   node build.mjs [FOLDER]     default: export, lessons, notebook and editor/app of ../src/distal
//
// The output is committed, so that nobody needs Node to export a page; a test builds it again and
// compares the bytes. Nothing of this machine goes in: no paths, no dates, no source map.

import { copyFile, mkdir, readdir, readFile, writeFile } from "node:fs/promises";
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

// WebGL's constants become numbers, which TypeScript's own declarations give: names of methods and
// properties are not shortened, and those of constants are long.
const constants = {
  name: "constants",
  async setup(builder) {
    const found = new Map();
    const packages = join(here, "node_modules/@typescript");
    for (const name of await readdir(packages)) {
      const text = await readFile(join(packages, name, "lib/lib.dom.d.ts"), "utf8");
      for (const [, key, value] of text.matchAll(/readonly ([A-Z][A-Z0-9_]+): (0x[0-9A-F]+);/g)) {
        // Other interfaces have constants of the same names, with other numbers.
        found.set(key, found.has(key) && found.get(key) !== +value ? NaN : +value);
      }
    }
    builder.onLoad({ filter: /[\\/]src[\\/].*\.ts$/ }, async ({ path }) => {
      const source = await readFile(path, "utf8");
      const contents = source.replace(/\b(?:this\.)?gl\.([A-Z][A-Z0-9_]+)\b/g, (name, key) =>
        found.get(key) ? String(found.get(key)) : name,
      );
      return { contents, loader: "ts" };
    });
  },
};

// A script that can stand anywhere in a page, as a text.
async function script(source, define) {
  const options = { bundle: true, minify: true, format: "iife", target: "es2022", write: false };
  const made = await build({ absWorkingDir: here, entryPoints: [source], define, charset: "utf8", plugins: [constants], ...options });
  return made.outputFiles[0].text;
}

// What saves a part from a page: it stands behind the player, and uses its functions.
async function printing(file) {
  await writeFile(file, await script("src/print/main.ts", {}));
}

// What shows a mesh in a notebook.
async function meshes(file) {
  await writeFile(file, await script("src/mesh/main.ts", { PATHS: "false", FRAMES: "false" }));
}

// What draws a page's poster of triangles: it stands before the player.
async function posters(file) {
  await writeFile(file, await script("src/triangles/main.ts", {}));
}

// The cell of the playground: a page whose script has the worker's script as a text.
async function cell(file) {
  const worker = await script("src/cell/worker.ts", {});
  const frame = await script("src/cell/cell.ts", { WORKER: JSON.stringify(worker) });
  const page = await readFile(join(here, "src/cell/cell.html"), "utf8");
  await writeFile(file, page.replace("{script}", () => frame.trim().replaceAll("</script", "<\\/script")));
}

const folder = argv[2] ?? join(here, "../src/distal/export");
const lessons = argv[2] ?? join(here, "../src/distal/lessons");
const notebook = argv[2] ?? join(here, "../src/distal/notebook");
const studio = argv[2] ?? join(here, "../src/distal/editor/app");
await mkdir(studio, { recursive: true });
for (const [source, file, paths, edited, frames] of [
  ["src/main.ts", join(folder, "player.js"), "false", "false", "false"],
  ["src/main.ts", join(folder, "path_player.js"), "true", "false", "false"],
  ["src/main.ts", join(folder, "frame_player.js"), "false", "false", "true"],
  ["src/inspect/main.ts", join(folder, "inspect_player.js"), "true", "true", "false"],
  ["src/lesson/main.ts", join(lessons, "lesson.js"), "false", "false", "false"],
  ["src/studio/main.ts", join(studio, "studio.js"), "true", "true", "true"],
  ["src/studio/lesson_page.ts", join(studio, "lesson_page.js"), "false", "false", "false"],
]) {
  await build({
    absWorkingDir: here,
    entryPoints: [source],
    outfile: file,
    define: { PATHS: paths, EDITED: edited, FRAMES: frames },
    bundle: true,
    minify: true,
    format: "esm",
    target: "es2022",
    charset: "utf8",
    legalComments: "none",
    plugins: [styles, constants],
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
await printing(join(folder, "print.js"));
await posters(join(folder, "triangle_poster.js"));
await meshes(join(notebook, "mesh_viewer.js"));
await cell(join(studio, "cell.html"));
await copyFile(join(here, "src/studio/studio.html"), join(studio, "studio.html"));
