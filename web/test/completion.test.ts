import { CompletionContext } from "@codemirror/autocomplete";
import { pythonLanguage } from "@codemirror/lang-python";
import { ensureSyntaxTree } from "@codemirror/language";
import { EditorState } from "@codemirror/state";
import assert from "node:assert/strict";
import { test } from "node:test";
import { complete } from "../src/studio/completion";

/** The list at the place of "|". */
function list(text: string, explicit = false): string[] {
  const at = text.indexOf("|");
  const doc = text.slice(0, at) + text.slice(at + 1);
  const fresh = EditorState.create({ doc, extensions: [pythonLanguage] });
  // The first parse has 20 ms, which a busy machine may take away; a view goes on by itself.
  ensureSyntaxTree(fresh, doc.length, 10_000);
  const { state } = fresh.update({});
  return complete(new CompletionContext(state, at, explicit))?.options.map(({ label }) => label) ?? [];
}

const has = (text: string, name: string) =>
  assert.ok(list(text).includes(name), `${name} is not in ${JSON.stringify(list(text))} of ${JSON.stringify(text)}`);
const none = (text: string, explicit = false) => assert.deepEqual(list(text, explicit), [], JSON.stringify(text));

test("the list has what begins with the word, its own case first", () => {
  assert.deepEqual(list("pri|"), ["print", "Prism"]);
  assert.equal(list("x = Tor|")[0], "Torus");
  assert.ok(list("sphe|").includes("Sphere"));
  const both = list("bo|");
  assert.ok(both.includes("Box"), "a class is found by lower case");
  const cases = both.map((name) => name.startsWith("bo"));
  assert.deepEqual(cases, [...cases].sort().reverse(), "its own case first");
  for (const word of ["pri", "ma", "math", "sp", "SP", "co", "in", "fo"]) {
    for (const name of list(`${word}|`)) {
      assert.ok(name.toLowerCase().startsWith(word.toLowerCase()), `${name} does not begin with ${word}`);
      assert.notEqual(name, word);
    }
  }
  assert.equal(new Set(list("sp|")).size, list("sp|").length, "no name twice");
});

test("it opens at two letters by itself, and anywhere when it is asked for", () => {
  for (const text of ["|", "S|", "x = S|", "s.|", "s.u|", "x = 1 |"]) none(text);
  assert.ok(list("x = |", true).includes("Sphere"));
  assert.ok(list("S|", true).includes("Sphere"));
  assert.ok(list("s.|", true).includes("union"));
  assert.ok(!list("s.|", true).includes("Sphere"));
});

test("the word that is being typed is never in it", () => {
  none("import math\nmath|");
  none("sizes = 1\nsizes|");
  none("sizes| = 1");
  none("abc|");
  none("size|s = 1");
  for (const word of ["print", "Sphere", "in", "not"]) assert.ok(!list(`${word}|`).includes(word));
});

test("names of the file are in it, those of modules too", () => {
  has("import math\nwidth = 2\nx = wi|", "width");
  has("import math\nx = ma|", "math");
  has("def helper(a):\n    return a\nx = he|", "helper");
  has("def f(amount):\n    return am|", "amount");
});

test("imports of other modules have none, those of distal its names", () => {
  for (const text of [
    ...["import ma|", "import math, ra|", "import numpy as nu|", "from ma|", "from math im|", "from math import si|"],
    ...["from math import (\n    si|", "from dis|", "from distal import Sphere as Sp|", "from .parts import Sp|"],
    ...["x = (\nimport ma|", "    import ma|", "from math import sin, co|"],
  ]) {
    none(text);
    none(text, true);
  }
  has("from distal import Sp|", "Sphere");
  has("from distal import Box, Sp|", "Sphere");
  has("from distal import (\n    Box,\n    Sp|\n)", "Sphere");
  has("from distal.lang import sli|", "slider");
  assert.ok(!list("from distal import pr|").includes("print"));
});

test("where a name is new there is none", () => {
  for (const text of [
    ...["def sp|", "def sp|(a):", "class Sp|", "class Sp|:", "for in|", "for sp|", "for i, sp|", "for (i, sp|"],
    ...["[x for sp|", "def f(sp|", "def f(a, sp|", "def f(*sp|", "def f(a, **sp|", "def f(\n    a,\n    sp|"],
    ...["f = lambda sp|", "f = lambda a, sp|", "with open(p) as sp|", "try:\n    x\nexcept E as sp|"],
    ...["global sp|", "sp| = 1", "f(sp|=1)", "f(a, sp| = 1)", "if (sp| := 1):", "case sp|"],
  ]) {
    none(text);
    none(text, true);
  }
  has("def f(a=Sp|", "Sphere");
  has("def f(a: Sha|", "Shape");
  has("f = lambda a: Sp|", "Sphere");
  has("for i in ra|", "range");
  has("class A(Sp|", "Sphere");
  has("x = f(sp|)", "Sphere");
  has("if sp| == 1:", "Sphere");
  has("case = Sp|", "Sphere");
  has("@fu|", "func");
});

test("strings, comments and numbers have none", () => {
  for (const text of [
    ...['"sp|"', '"sp|', "'sp|'", "'sp|", '"""sp|', '"""\na\nsp|', '"""\na\nsp|\n"""', 'f"{sp|}"', 'x = "a" + "sp|'],
    ...["# sp|", "x = 1  # sp|", '# "a" sp|', '# "sp"|', "0x|", "0xff|", "12|", "1e|", "1.e|", "1.5.un|", "x = 1.|"],
    ...["(1).2.un|", "1_0.un|"],
  ]) {
    none(text);
    none(text, true);
  }
  has("x1.un|", "union");
  has('x = "a"; pri|', "print");
  has("f(  # why\n    Sp|", "Sphere");
});

test("after a point are methods, but not of modules", () => {
  has("s.un|", "union");
  has("s.union(b).tw|", "twist");
  has("(\n    s\n    .un|", "union");
  has("s.parts[0].un|", "union");
  none("import math\nmath.si|");
  none("import numpy as np\nx = np.linalg.no|");
});
