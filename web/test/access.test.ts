import assert from "node:assert/strict";
import { createHmac } from "node:crypto";
import { test } from "node:test";
import { Access, type Reason } from "../src/studio/access";

const proofOf = (text: string, ...words: string[]) => createHmac("sha256", text).update(words.join(" ")).digest("hex");
const THEIRS = "7".repeat(64);

/** A browser with one page, and a server that answers as a test says. */
class World {
  readonly kept = new Map<string, string>();
  /** What the server has heard, socket by socket. */
  readonly heard: Record<string, string>[][] = [];
  replaced = "";
  hasStorage = true;

  /** `answer` gets a message and what was heard before it; a number closes the socket by that code. */
  constructor(hash: string, answer: (message: Record<string, string>, count: number) => (object | number)[]) {
    const { heard } = this;
    class Socket {
      static OPEN = 1;
      readyState = 1;
      onopen = () => {};
      onmessage = (_: { data: string }) => {};
      onclose = (_: { code: number }) => {};
      readonly said: Record<string, string>[] = [];
      constructor() {
        heard.push(this.said);
        setTimeout(() => this.onopen());
      }
      send(text: string): void {
        this.said.push(JSON.parse(text));
        for (const one of answer(this.said.at(-1)!, this.said.length)) {
          setTimeout(() => (typeof one === "number" ? this.close(one) : this.onmessage({ data: JSON.stringify(one) })));
        }
      }
      close(code = 1006): void {
        if (this.readyState === 1) setTimeout(() => this.onclose({ code }));
        this.readyState = 3;
      }
    }
    const storage = {
      getItem: (name: string) => this.#stored().get(name) ?? null,
      setItem: (name: string, value: string) => this.#stored().set(name, value),
    };
    const location = { host: "127.0.0.1:1", hash, pathname: "/", search: "" };
    const history = { replaceState: (_: unknown, __: string, url: string) => (this.replaced = url) };
    Object.assign(globalThis, { WebSocket: Socket, window: globalThis, addEventListener: () => {} });
    for (const [name, value] of Object.entries({ localStorage: storage, location, history })) {
      Object.defineProperty(globalThis, name, { value, configurable: true });
    }
  }

  /** Resolves to the settings of the server, or to the reason why there is none. */
  begin(): Promise<unknown> {
    return new Promise((resolve) => {
      const access = new Access();
      access.onOpen = (settings) => resolve([settings, access.isKept]);
      access.onClosed = (reason: Reason) => {
        access.end();
        resolve(reason);
      };
      access.start();
    });
  }

  #stored(): Map<string, string> {
    if (!this.hasStorage) throw new Error("blocked");
    return this.kept;
  }
}

/** The server, which has a key and a secret. */
const honest = (key: string, secret: string) => {
  let hello: Record<string, string> = {};
  return (message: Record<string, string>, count: number) => {
    if (count > 2) return [];
    if (count === 1) {
      hello = message;
      const text = message["by"] === "key" ? key : secret;
      return [{ nonce: THEIRS, proof: proofOf(text, "server", message["nonce"]!, THEIRS) }];
    }
    const text = hello["by"] === "key" ? key : secret;
    const isRight = message["proof"] === proofOf(text, "page", hello["nonce"]!, THEIRS);
    return [isRight ? { settings: { main: "a.py" }, secret } : 4403];
  };
};

test("a key is taken out of the address, and a secret is kept for it", async () => {
  const world = new World("#key=abc_-9", honest("abc_-9", "s3cret"));
  assert.deepEqual(await world.begin(), [{ main: "a.py" }, true]);
  assert.equal(world.replaced, "/");
  assert.deepEqual([...world.kept], [["distal:secret", "s3cret"]]);
  assert.deepEqual(Object.keys(world.heard[0]![0]!).sort(), ["by", "nonce"]);
  assert.ok(!JSON.stringify(world.heard).includes("abc_-9"));
});

test("without storage the secret is in memory, and the page knows that", async () => {
  const world = new World("#key=abc", honest("abc", "s3cret"));
  world.hasStorage = false;
  assert.deepEqual(await world.begin(), [{ main: "a.py" }, false]);
});

test("after a used key the secret of this browser is tried", async () => {
  const world = new World("#key=used", honest("another", "s3cret"));
  world.kept.set("distal:secret", "s3cret");
  assert.deepEqual(await world.begin(), [{ main: "a.py" }, true]);
  assert.deepEqual(world.heard.map((said) => said[0]!["by"]), ["key", "secret"]);
});

test("without key and secret nothing is sent at all", async () => {
  const world = new World("", honest("k", "s"));
  assert.equal(await world.begin(), "refused");
  assert.deepEqual(world.heard, []);
});

const STRANGERS: Record<string, (hello: Record<string, string>) => (object | number)[]> = {
  "guesses": () => [{ nonce: THEIRS, proof: "0".repeat(64) }],
  "welcomes at once": () => [{ settings: { main: "a.py" }, secret: "mine" }],
  "guesses and welcomes": () => [{ nonce: THEIRS, proof: THEIRS }, { settings: {}, secret: "mine" }],
  "sends a page's proof": ({ nonce }) => [{ nonce: THEIRS, proof: proofOf("s3cret", "page", nonce!, THEIRS) }],
  "sends an old proof": () => [{ nonce: THEIRS, proof: proofOf("s3cret", "server", "1".repeat(64), THEIRS) }],
  "sends an odd nonce": ({ nonce }) => [{ nonce: "7", proof: proofOf("s3cret", "server", nonce!, "7") }],
  "sends no object": () => [[1]],
  "refuses": () => [4403],
};
for (const [what, answer] of Object.entries(STRANGERS)) {
  test(`a server that ${what} gets a nonce and nothing else`, async () => {
    const world = new World("", (message, count) => (count === 1 ? answer(message) : []));
    world.kept.set("distal:secret", "s3cret");
    assert.equal(await world.begin(), "refused");
    assert.equal(world.kept.get("distal:secret"), "s3cret");
    for (const said of world.heard) {
      assert.equal(said.length, 1);
      assert.deepEqual(Object.keys(said[0]!).sort(), ["by", "nonce"]);
      assert.match(said[0]!["nonce"]!, /^[0-9a-f]{64}$/);
    }
  });
}

test("a nonce is used once", async () => {
  const world = new World("", () => [4403]);
  world.kept.set("distal:secret", "s3cret");
  await world.begin();
  await world.begin();
  const nonces = world.heard.map((said) => said[0]!["nonce"]);
  assert.equal(new Set(nonces).size, 2);
});

test("a server that is away or busy is asked again, and this is told apart", async () => {
  for (const [code, reason] of [[1006, "away"], [1013, "busy"]] as const) {
    const world = new World("", () => [code]);
    world.kept.set("distal:secret", "s3cret");
    assert.equal(await world.begin(), reason);
  }
});

test("a connection that another one replaces has ended: what was asked through it has no answer", async () => {
  new World("#key=abc", honest("abc", "s3cret"));
  const access = new Access();
  const told: string[] = [];
  const opened = () => new Promise<void>((resolve) => (access.onOpen = () => (told.push("open"), resolve())));
  access.onClosed = (reason) => told.push(reason);
  const first = opened();
  access.start();
  await first;
  const second = opened();
  access.start();
  await second;
  assert.deepEqual(told, ["open", "away", "open"]);
  access.end();
  access.end();
  assert.deepEqual(told, ["open", "away", "open", "away"]);
});
