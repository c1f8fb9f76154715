// Replaces sources by bytecode in the archives of the playground.
//
// Usage: node bytecode.mjs FOLDER PROGRAM
// FOLDER has the files of Pyodide and distal.zip; two archives are replaced. PROGRAM is
// bytecode_program.py, which Pyodide itself runs: bytecode is of one version of Python.

import { readFileSync, writeFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

process.on("uncaughtException", (error) => {
  // Without the line of Pyodide's own text, which has a megabyte.
  console.error(String(error?.message ?? error));
  process.exit(1);
});

const [folder, program] = process.argv.slice(2);
const { loadPyodide } = await import(pathToFileURL(`${folder}/pyodide.mjs`).href);
const python = await loadPyodide({ indexURL: `${folder}/`, stdout: () => {}, stderr: () => {} });
const files = ["python_stdlib.zip", "distal.zip"].map((name) => `${folder}/${name}`);
const [stdlib, distal] = files.map((file) => new Uint8Array(readFileSync(file)));
python.unpackArchive(distal.slice().buffer, "zip", { extractDir: "/lib/distal" });
python.FS.writeFile("/lib/bytecode_program.py", readFileSync(program));
python.globals.set("archives", python.toPy([stdlib, distal]));
const made = python.runPython(`
import sys
sys.dont_write_bytecode = True
sys.path[:0] = ["/lib/distal", "/lib"]
import bytecode_program
bytecode_program.compiled([bytes(data) for data in archives])
`);
made.toJs().forEach((data, i) => writeFileSync(files[i], data));
