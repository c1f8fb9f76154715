import assert from "node:assert/strict";
import { test } from "node:test";
import type { Request, Response } from "../src/generated/messages";
import { Client } from "../src/studio/client";
import { Drafts } from "../src/studio/drafts";
import { Texts } from "../src/studio/texts";

/** A channel to nobody, until a test answers. */
class Channel {
  isOpen = true;
  posted: Request[] = [];
  onMessage = (_: Response) => {};
  onState = (_: boolean) => {};
  post(request: Request): void {
    if (this.isOpen) this.posted.push(request);
  }
}

const EVENTS = { ready() {}, changed() {}, printed() {}, restarted() {}, state() {} };
const SAVE = { kind: "save", revision: 1, file: "a.py", text: "", digest: null, in_place: false } as const;

test("who asks while nobody is there learns it, and does not wait for the server that comes next", async () => {
  const channel = new Channel();
  const client = new Client(channel, EVENTS);
  channel.isOpen = false;
  assert.equal(await client.ask(SAVE), null);
  channel.isOpen = true;
  channel.onState(true);
  const answer = client.ask(SAVE);
  assert.deepEqual(channel.posted.map(({ kind }) => kind), ["save"]);
  channel.onState(false);
  assert.equal(await answer, null);
});

/** A page of a folder in a tab, with a server that has drafts. */
class World {
  readonly texts = new Texts();
  readonly asked: Record<string, unknown>[] = [];
  readonly drafts: Drafts;
  restored: Record<string, { text: string }> = {};

  constructor(storage: Map<string, string>, folder: string, drafts: Record<string, { text: string; digest: string }> = {}) {
    const sessionStorage = {
      getItem: (key: string) => storage.get(key) ?? null,
      setItem: (key: string, value: string) => storage.set(key, value),
      removeItem: (key: string) => storage.delete(key),
    };
    Object.defineProperty(globalThis, "sessionStorage", { value: sessionStorage, configurable: true });
    Object.assign(globalThis, { window: globalThis });
    const ask = async (request: Record<string, unknown>) => {
      this.asked.push(request);
      const result = request["kind"] === "hello" ? { tab: "t", drafts, others: [], unkept: "" } : { unkept: "" };
      return { kind: "answer", request: request["kind"], result };
    };
    const greeted = (given: Record<string, { text: string; digest: string }>) => {
      this.restored = given;
      this.texts.take("a.py", "disk", "d");
      for (const [name, { text, digest }] of Object.entries(given)) this.texts.restore(name, text, digest);
    };
    const studio = { texts: this.texts, settings: { folder }, client: { ask }, files: { greeted }, page: { bar() {} }, versions: {} };
    this.drafts = new Drafts(studio as never);
  }
}

test("what a page could not send belongs to its folder, whichever server has the address later", async () => {
  const storage = new Map<string, string>();
  const first = new World(storage, "/one");
  await first.drafts.connected(true);
  first.texts.set("a.py", "mine");
  assert.equal(first.drafts.isHereOnly, false);
  await first.drafts.connected(false);
  assert.equal(first.drafts.isHereOnly, true);
  const other = new World(storage, "/two");
  await other.drafts.connected(true);
  assert.deepEqual(other.restored, {});
  const again = new World(storage, "/one");
  await again.drafts.connected(true);
  assert.deepEqual(again.restored, { "a.py": { text: "mine", digest: "d" } });
});

test("a draft of the server ends where the page has what the disk has", async () => {
  const world = new World(new Map(), "/one", { "a.py": { text: "disk", digest: "older" } });
  await world.drafts.connected(true);
  const sent = world.asked.filter(({ kind }) => kind === "draft");
  assert.deepEqual(sent.map(({ file, text }) => [file, text]), [["a.py", null]]);
});
