import assert from "node:assert/strict";
import { test } from "node:test";
import type { SourceLiteral } from "../src/generated/messages";
import { moved } from "../src/studio/edits";
import { Turning } from "../src/studio/turning";

test("edits of an earlier text are at their place in the one that is there now, or nowhere", () => {
  const edit = { file: "a.py", start: 4, end: 5, text: "7" };
  const places = (now: string) => moved([edit], "x = 1\ny = 2\n", now)?.map(({ start }) => start) ?? null;
  assert.deepEqual(places("x = 1\ny = 2\n"), [4]);
  assert.deepEqual(places("x = 1\ny = 25\n"), [4]);
  assert.deepEqual(places("# new\nx = 1\ny = 2\n"), [10]);
  for (const now of ["x = 12\ny = 2\n", "x = \ny = 2\n", "other", "", "z = 3\ny = 1\n"]) assert.equal(places(now), null, now);
});

/** A studio whose worker answers when a test says so. */
class World {
  files: Record<string, string> = { "a.py": "x = 1\ny = 2\n" };
  readonly waiting: (() => void)[] = [];
  readonly asked: { files: Record<string, string>; value: unknown }[] = [];
  told = "";
  readonly turning: Turning;

  constructor() {
    const ask = (request: { files: Record<string, string>; changes: { start: number; end: number; value: unknown }[] }) => {
      const [{ start, end, value }] = request.changes as [{ start: number; end: number; value: unknown }];
      this.asked.push({ files: request.files, value });
      const answer = { kind: "mistakes", mistakes: [], edits: [{ file: "a.py", start, end, text: String(value) }] };
      return new Promise((resolve) => this.waiting.push(() => resolve(answer)));
    };
    const apply = (edits: { start: number; end: number; text: string }[]) => {
      let text = this.files["a.py"]!;
      for (const { start, end, text: by } of edits) text = text.slice(0, start) + by + text.slice(end);
      this.files = { "a.py": text };
    };
    const world = this;
    const looking = { source: {}, key: null, settle() {}, look() {}, take: async () => {}, apply };
    const page = { tell: (text: string) => (this.told = text) };
    const texts = { get files() { return world.files; } };
    this.turning = new Turning({ client: { ask }, looking, page, texts, picture: {}, costs: { changed() {} } } as never);
  }

  turn(start: number, value: number): void {
    this.turning.turned({ file: "a.py", start, end: start + 1, type: "number", way: "look" } as unknown as SourceLiteral, value);
    this.turning.released();
  }

  /** Answers all that is asked, also then. */
  async answer(): Promise<void> {
    for (let i = 0; i < 20; i++) {
      this.waiting.shift()?.();
      await new Promise((resolve) => setTimeout(resolve));
    }
  }
}

test("what is typed before a turn is written stays, and so does what was turned", async () => {
  const world = new World();
  world.turn(10, 7);
  world.files = { "a.py": "# typed\nx = 1\ny = 2\n" };
  await world.answer();
  assert.equal(world.files["a.py"], "# typed\nx = 1\ny = 7\n");
  world.turn(18, 9);
  world.files = { "a.py": "" };
  await world.answer();
  assert.equal(world.files["a.py"], "");
  assert.match(world.told, /not written/);
  assert.equal(world.turning.isOn, false);
});

test("a literal that is turned while another one waits for its answer is another one", async () => {
  const world = new World();
  world.turn(4, 5);
  world.turn(10, 8);
  await world.answer();
  assert.equal(world.files["a.py"], "x = 5\ny = 8\n");
  assert.equal(world.turning.isOn, false);
});

test("another scene gets nothing of what was turned in the one before", async () => {
  const world = new World();
  world.turn(4, 5);
  world.turning.drop();
  world.files = { "a.py": "x = 1\nz = 3\n" };
  await world.answer();
  assert.equal(world.files["a.py"], "x = 1\nz = 3\n");
});
