import assert from "node:assert/strict";
import { test } from "node:test";
import {
  begun, keptMine, kindOf, isOpen, NO_FILE, restored, saved, seen, tookTheirs, typed, UNREADABLE,
  type Disk, type FileState,
} from "../src/studio/file_state";

/** A file on a disk, its page, and which texts of the disk a person has agreed to lose. */
interface World {
  disk: Disk;
  state: FileState;
  /** Digests that the page has shown as its own text, or that a person chose to overwrite. */
  agreed: ReadonlySet<string>;
  /** What was in the page when a choice replaced it. */
  lost: string | null;
}

const digestOf = (text: string) => `digest of ${text}`;
const onDisk = (text: string, order: number): Disk => ({ digest: digestOf(text), text, problem: "", order });

function outside(world: World, change: Partial<Disk>): World {
  return { ...world, disk: { ...world.disk, problem: "", ...change, order: world.disk.order + 1 } };
}

function withState(world: World, state: FileState): World {
  const isSame = kindOf(state) === "same";
  return { ...world, state, agreed: isSame ? new Set([...world.agreed, state.disk.digest]) : world.agreed };
}

/** A save, as the server does it: only over the digest that it is told. */
function save(world: World): World {
  const { disk, state } = world;
  if (isOpen(state)) return world; // the page asks
  if (disk.digest === UNREADABLE) return world; // the server refuses
  if (disk.digest !== state.base.digest) return withState(world, seen(state, disk));
  assert.ok(
    disk.digest === NO_FILE || world.agreed.has(disk.digest),
    `${disk.digest} was overwritten, and nobody had seen it`,
  );
  const next = onDisk(state.text, disk.order + 1);
  return withState({ ...world, disk: next }, saved(state, state.text, next.digest, next.order));
}

function keep(world: World, digest: string): World {
  const state = keptMine(world.state, digest);
  assert.equal(state.text, world.state.text);
  const agreed = state === world.state ? world.agreed : new Set([...world.agreed, digest]);
  return { ...world, state, agreed };
}

const EVENTS: Record<string, (world: World) => World> = {
  "type a": (world) => withState(world, typed(world.state, "a")),
  "type b": (world) => withState(world, typed(world.state, "b")),
  undo: (world) => withState(world, typed(world.state, "start")),
  "other x": (world) => outside(world, { text: "x", digest: digestOf("x") }),
  "other a": (world) => outside(world, { text: "a", digest: digestOf("a") }),
  back: (world) => outside(world, { text: "start", digest: digestOf("start") }),
  gone: (world) => outside(world, { text: null, digest: NO_FILE, problem: "was deleted" }),
  unreadable: (world) => outside(world, { text: null, digest: UNREADABLE, problem: "cannot be read" }),
  bytes: (world) => outside(world, { text: null, digest: "bytes", problem: "is not UTF-8 text" }),
  told: (world) => withState(world, seen(world.state, world.disk)),
  keep: (world) => keep(world, world.state.disk.digest),
  "keep late": (world) => keep(world, digestOf("x")),
  take: (world) => withState(world, tookTheirs(world.state, world.state.disk.digest)),
  save,
};

function begin(digest = digestOf("start")): World {
  const state = begun("start", digest);
  return { disk: { ...state.disk }, state, agreed: new Set([digest]), lost: null };
}

/** Every sequence of events of some length, from a file and from a new one. */
function* sequences(length: number): Generator<string[]> {
  const names = Object.keys(EVENTS);
  if (!length) return yield [];
  for (const rest of sequences(length - 1)) for (const name of names) yield [...rest, name];
}

function after(world: World, names: readonly string[]): World {
  let now = world;
  for (const name of names) {
    const before = now;
    try {
      now = EVENTS[name]!(now);
    } catch (error) {
      throw new Error(`${names.join(", ")}: ${(error as Error).message}`);
    }
    check(before, now, name, names);
  }
  return now;
}

function check(before: World, now: World, event: string, names: readonly string[]): void {
  const where = names.join(", ");
  const { state } = now;
  const was = before.state;
  // A text of the page goes only by a key or by a choice.
  if (["mine", "both"].includes(kindOf(was)) && !event.startsWith("type") && !["undo", "take"].includes(event)) {
    assert.equal(state.text, was.text, where);
  }
  // The base moves only where the page and the disk are one, or a person chose, or it was saved.
  if (was.base.digest !== state.base.digest && !event.startsWith("keep")) {
    assert.equal(kindOf(state) === "same" || event === "save", true, where);
  }
  // Where the page believes that all is saved, its text is the one that the disk had when it told so.
  if (kindOf(state) === "same") assert.equal(state.disk.text, state.text, where);
}

test("nothing is overwritten that nobody has seen, in any sequence of four events and a save", () => {
  let count = 0;
  for (const names of sequences(4)) {
    for (const digest of [digestOf("start"), NO_FILE]) {
      const world = after(begin(digest), names);
      // A save at the end asks, refuses, or overwrites what was agreed.
      save(save(world));
      count += 1;
    }
  }
  assert.equal(count, 2 * Object.keys(EVENTS).length ** 4);
});

const mine = (state: FileState) => typed(state, "mine");
const theirs = (state: FileState, order = 1) => seen(state, onDisk("theirs", order));

test("a file is same, mine, theirs or both", () => {
  const start = begun("start", "d");
  assert.equal(kindOf(start), "same");
  assert.equal(kindOf(mine(start)), "mine");
  assert.equal(kindOf(theirs(mine(start))), "both");
  assert.deepEqual(theirs(start).text, "theirs");
  assert.equal(kindOf(theirs(start)), "same");
  const gone: Disk = { digest: NO_FILE, text: null, problem: "was deleted", order: 1 };
  assert.equal(kindOf(seen(start, gone)), "theirs");
  assert.equal(seen(start, gone).text, "start");
  assert.equal(kindOf(seen(mine(start), gone)), "both");
  assert.equal(kindOf(begun("start", NO_FILE)), "mine");
});

test("a conflict ends by a choice for what the disk has now, not for what it had", () => {
  const both = theirs(mine(begun("start", "d")));
  assert.equal(keptMine(both, "d"), both);
  assert.equal(tookTheirs(both, "d"), both);
  const kept = keptMine(both, digestOf("theirs"));
  assert.equal(kindOf(kept), "mine");
  assert.equal(kept.text, "mine");
  assert.equal(kindOf(seen(kept, onDisk("again", 2))), "both");
  assert.deepEqual(tookTheirs(both, digestOf("theirs")).text, "theirs");
});

test("a conflict ends by itself where both texts become one", () => {
  const both = theirs(mine(begun("start", "d")));
  assert.equal(kindOf(typed(both, "theirs")), "same");
  assert.equal(kindOf(seen(both, onDisk("mine", 2))), "same");
  assert.equal(kindOf(seen(both, { ...onDisk("start", 2), digest: "d" })), "mine");
});

test("undo to the base does not bring a text that nobody chose", () => {
  const both = theirs(mine(begun("start", "d")));
  const undone = typed(both, "start");
  assert.equal(kindOf(undone), "theirs");
  assert.equal(undone.text, "start");
});

test("an unreadable file is never chosen away", () => {
  const disk: Disk = { digest: UNREADABLE, text: null, problem: "cannot be read", order: 1 };
  const both = seen(mine(begun("start", "d")), disk);
  assert.equal(keptMine(both, UNREADABLE), both);
  assert.equal(tookTheirs(both, UNREADABLE), both);
});

test("an older message changes nothing, also the answer to a save", () => {
  const state = saved(mine(begun("start", "d")), "mine", "m", 5);
  assert.equal(kindOf(state), "same");
  assert.equal(theirs(state, 4), state);
  const newer = seen(mine(begun("start", "d")), onDisk("theirs", 7));
  assert.equal(kindOf(saved(newer, "mine", "m", 6)), "theirs");
});

test("a draft is what it began with: unsaved, a conflict, or nothing", () => {
  const start = begun("start", "d");
  assert.equal(kindOf(restored(start, "mine", "d")), "mine");
  assert.equal(kindOf(restored(start, "mine", "earlier")), "both");
  assert.equal(kindOf(restored(start, "start", "earlier")), "same");
  assert.equal(kindOf(restored(begun("", NO_FILE), "mine", "earlier")), "both");
  assert.equal(kindOf(restored(begun("new", NO_FILE), "mine", NO_FILE)), "mine");
});
