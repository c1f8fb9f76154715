import assert from "node:assert/strict";
import { test } from "node:test";
import { linkOf, sharedOf, type Shared } from "../src/studio/links";

const of = async (shared: unknown): Promise<Shared | null> => sharedOf(await linkOf(shared as Shared));
const named = (...names: string[]) => ({ main: names[0], files: Object.fromEntries(names.map((name) => [name, ""])) });

test("a link brings what was shared", async () => {
  for (const shared of [named("a.py"), named("半径 Ø.py", "b.py"), named("__proto__.py", "constructor.py", "toString.py")]) {
    assert.deepEqual(await of(shared), shared);
  }
});

test("names that are paths, not printed or not Python, and thousands of files are no link", async () => {
  const names = ["../a.py", "a/b.py", "a\\b.py", ".py", "a.txt", "a\nb.py", "a\u202eb.py", "a\u0000.py", "a\u2028.py", `${"a".repeat(300)}.py`];
  for (const name of names) assert.equal(await of(named(name)), null, JSON.stringify(name));
  const numbered = (count: number) => named(...Array.from({ length: count }, (_, i) => `a${i}.py`));
  assert.notEqual(await of(numbered(100)), null);
  assert.equal(await of(numbered(10_000)), null);
});

test("what has another form is no link", async () => {
  const wrong = [null, [], 1, {}, { main: "a.py" }, { main: "b.py", files: { "a.py": "" } }, { main: "toString", files: {} }];
  for (const shared of wrong) assert.equal(await of(shared), null, JSON.stringify(shared));
  assert.equal(await of({ main: "a.py", files: ["a.py"] }), null);
  assert.equal(await of({ main: "a.py", files: { "a.py": 1 } }), null);
  assert.equal(await of(JSON.parse('{"main": "a.py", "files": {"a.py": "", "__proto__": {}}}')), null);
});
