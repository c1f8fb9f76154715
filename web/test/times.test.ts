import assert from "node:assert/strict";
import { test } from "node:test";
import type { LineTiming } from "../src/generated/messages";
import type { Program } from "../src/payload";
import type { Player } from "../src/player";
import { workFigures } from "../src/studio/counts";
import { timeFigures, timesOf } from "../src/studio/times";

const program = { fragment: "first\n#define MEASURED_PLACE -1\nlast", uniforms: [], trust: {} };
const timing = {
  program: program as unknown as Program,
  choice: "#define MEASURED_PLACE -1",
  repeats: "Repeats",
  files: ["scene.py"],
  places: [[0, 3], [0, 7]],
  evaluations: [1, 8],
} as LineTiming;

/** A player with an exact clock: a picture takes 5 ms, a round of a loop 1 ms, line 3 2 ms, line 7 0.5 ms. */
function exact(noise = () => 0): { player: Player; forgotten: Program[] } {
  const forgotten: Program[] = [];
  const player = {
    payload: { size: [640, 480] },
    inputs: () => ({ frame: {}, parameter: {}, number: { own: 1 } }),
    forget: (source: Program) => forgotten.push(source),
    timed: async ({ fragment }: Program, { number }: { number: Record<string, number> }, _: unknown, draws: number) => {
      const place = Number(/MEASURED_PLACE (-?\d+)/.exec(fragment)![1]);
      const rounds = number["Repeats"] ?? 1;
      const line = place === 0 ? 2 : place === 1 ? 8 * 0.5 : 0;
      return draws * (5 + (place === -1 ? 0 : rounds * (1 + line)) + noise());
    },
  };
  return { player: player as unknown as Player, forgotten };
}

test("a line's time is the slope of its repetitions, less that of the loop", async () => {
  const { player, forgotten } = exact();
  const parts: number[] = [];
  const times = await timesOf(timing, player, { isWanted: () => true, progress: (part) => parts.push(part) });
  assert.deepEqual(parts, [0.5, 1]);
  assert.equal(times!.frame, 5);
  const [three, seven] = times!.lines.get("scene.py")!;
  assert.ok(Math.abs(three!.ms - 2) < 1e-9 && three!.error < 1e-9);
  assert.ok(Math.abs(seven!.ms - 0.5) < 1e-9 && seven!.line === 7);
  assert.equal(forgotten.length, 5); // Two for each line, and the whole picture.
  const figures = timeFigures(times!).get("scene.py")!;
  assert.deepEqual(figures.map(({ text }) => text), ["40 %", "10 %"]);
  assert.match(figures[0]!.hint, /^2 ms ± .* of 5 ms for 64 × 48 pixels, with what it calls: 40 % ±/);
});

test("where the error is not smaller than the time, the line is not measurable", async () => {
  let count = 0;
  const { player } = exact(() => 400 * ((count++ * 0.618) % 1));
  const times = await timesOf(timing, player, { isWanted: () => true, progress: () => {} });
  for (const { text, hint } of timeFigures(times!).get("scene.py")!) {
    assert.equal(text, "–");
    assert.match(hint, /^Not measurable: .* ms ± .* ms, the error is not smaller than the time$/);
  }
});

test("what nobody wants any more ends", async () => {
  let asked = 0;
  const { player, forgotten } = exact();
  const times = await timesOf(timing, player, { isWanted: () => ++asked < 4, progress: () => {} });
  assert.equal(times, null);
  assert.equal(forgotten.length, 3);
});

test("a driver that draws nothing ends it", async () => {
  const { player } = exact();
  player.timed = async () => null;
  assert.equal(await timesOf(timing, player, { isWanted: () => true, progress: () => {} }), null);
});

test("the figures of work say that they are estimates, and where a pixel holds no more", () => {
  const counts = new Map([["a.py", [{ line: 1, mean: 0, most: 0 }, { line: 2, mean: 1234, most: 99 }]]]);
  const [none, some] = workFigures(counts, 99).get("a.py")!;
  assert.match(none!.hint, /once a frame$/);
  assert.equal(some!.hint, "About 1234 operations a pixel with what it calls, 99 or more at most (an estimate)");
  assert.deepEqual([none!.share, some!.share], [0, 1]);
});
