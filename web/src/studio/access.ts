/**
 * The way to the studio's server: nothing is sent before both sides have proved that they know the
 * same text, and neither sends that text. Another program that has the server's port later learns nothing.
 *
 * Input: a key in the page's address, or the secret that this browser has got for one. Output: texts of the
 * server, its settings first; whether it is there. `distal/editor/local/guard.py` describes the messages.
 */

import { recalled, remember } from "./storage";

const KEPT = "distal:secret";
const PROOF = /^[0-9a-f]{64}$/;
const RETRY_MS = 1500;
/** How long a server may take to answer the first messages. */
const ADMISSION_MS = 10_000;
/** The codes of sockets that the server closes: the page has no access, and there are too many pages. */
const REFUSED = 4403;
const BUSY = 1013;

/** Why nobody answers: the server is away, has too many pages, or gives this one no access. */
export type Reason = "away" | "busy" | "refused";

export const REASONS: Record<Reason, string> = {
  away: "The studio's server has ended.",
  busy: "The studio has no place for another page now: close one of its tabs.",
  refused:
    "This page has no access to the studio. Press Enter in the terminal in which the studio runs, " +
    "and open the address that it prints.",
};
export const NOT_KEPT =
  "This browser stores nothing for this page. After a reload, press Enter in the terminal for a new address.";

/** A text that the server knows too. */
interface Shared {
  by: "key" | "secret";
  text: string;
}

export class Access {
  /** Called with the server's settings whenever it is there. */
  onOpen: (settings: unknown) => void = () => {};
  onText: (text: string) => void = () => {};
  /** Called when the connection ends, or cannot be made. */
  onClosed: (reason: Reason) => void = () => {};
  /** Whether a reload needs no new key. */
  isKept = true;
  #key: string | null = null;
  #secret: string | null = null;
  #socket: WebSocket | null = null;
  #timer = 0;
  /** Grows with each attempt: what belongs to an earlier one is not read. */
  #attempt = 0;

  constructor() {
    this.#takeKey();
    addEventListener("hashchange", () => this.#takeKey() && this.start());
    // Another tab of this browser has got a new secret.
    addEventListener("storage", ({ key }) => {
      if (key === KEPT && !this.isOpen) this.start();
    });
  }

  /** Connects; later it connects again by itself. */
  start(): void {
    this.end();
    void this.#connect(++this.#attempt);
  }

  end(): void {
    const socket = this.#socket;
    this.#attempt += 1;
    clearTimeout(this.#timer);
    this.#socket = null;
    if (!socket) return;
    socket.close();
    this.onClosed("away"); // What was asked through it has no answer.
  }

  get isOpen(): boolean {
    return this.#socket?.readyState === WebSocket.OPEN;
  }

  send(text: string): void {
    if (this.isOpen) this.#socket!.send(text);
  }

  /** Takes the key out of the address, which the history and the screen show. */
  #takeKey(): boolean {
    const key = /^#key=([\w-]+)$/.exec(location.hash)?.[1];
    if (!key) return false;
    history.replaceState(null, "", location.pathname + location.search);
    this.#key = key;
    return true;
  }

  async #connect(attempt: number): Promise<void> {
    let reason: Reason | null = "refused";
    for (const shared of this.#texts()) {
      reason = await this.#admitted(shared, attempt);
      if (attempt !== this.#attempt) return;
      if (reason !== "refused") break;
      if (shared.by === "key") this.#key = null; // It is used up.
    }
    if (reason) this.#closed(reason);
  }

  #closed(reason: Reason): void {
    this.#socket = null;
    const attempt = this.#attempt;
    // A page without access gets it by a key in its address, or by another tab.
    if (reason !== "refused") this.#timer = window.setTimeout(() => void this.#connect(attempt), RETRY_MS);
    this.onClosed(reason);
  }

  #texts(): Shared[] {
    const kept = recalled("localStorage", KEPT);
    const secrets = [...new Set([kept, this.#secret])].filter((text) => text !== null);
    const texts = secrets.map((text): Shared => ({ by: "secret", text }));
    return this.#key ? [{ by: "key", text: this.#key }, ...texts] : texts;
  }

  /** Resolves to null once the server has admitted this page, and to the reason if it has not. */
  #admitted(shared: Shared, attempt: number): Promise<Reason | null> {
    const socket = new WebSocket(`ws://${location.host}/socket`);
    const nonce = newNonce();
    return new Promise((resolve) => {
      const timer = setTimeout(() => socket.close(), ADMISSION_MS);
      const refuse = () => (resolve("refused"), socket.close());
      socket.onopen = () => socket.send(JSON.stringify({ nonce, by: shared.by }));
      socket.onmessage = async ({ data }) => {
        socket.onmessage = refuse; // The server waits for the proof.
        const answer = await answered(shared.text, nonce, String(data));
        if (!answer || attempt !== this.#attempt) return refuse();
        socket.onmessage = ({ data: welcome }) => {
          clearTimeout(timer);
          resolve(null);
          this.#opened(socket, attempt, String(welcome));
        };
        if (socket.readyState === WebSocket.OPEN) socket.send(answer);
      };
      socket.onclose = ({ code }) => {
        clearTimeout(timer);
        resolve(code === REFUSED ? "refused" : code === BUSY ? "busy" : "away");
      };
    });
  }

  #opened(socket: WebSocket, attempt: number, welcome: string): void {
    if (attempt !== this.#attempt) return socket.close();
    const { settings, secret } = JSON.parse(welcome) as { settings: unknown; secret?: string };
    if (secret) {
      this.#key = null;
      this.#secret = secret;
      this.isKept = remember("localStorage", KEPT, secret);
    }
    this.#socket = socket;
    socket.onmessage = ({ data }) => this.onText(String(data));
    socket.onclose = ({ code }) => {
      if (socket === this.#socket) this.#closed(code === BUSY ? "busy" : "away");
    };
    this.onOpen(settings);
  }
}

/** The page's proof, if the server's is right; else null. */
async function answered(text: string, nonce: string, challenge: string): Promise<string | null> {
  try {
    const { nonce: theirs, proof } = JSON.parse(challenge) as { nonce: string; proof: string };
    if (!PROOF.test(theirs) || !PROOF.test(proof)) return null;
    const bytes = (letters: string) => new TextEncoder().encode(letters);
    const usages: KeyUsage[] = ["sign", "verify"];
    const key = await crypto.subtle.importKey("raw", bytes(text), { name: "HMAC", hash: "SHA-256" }, false, usages);
    const ofServer = bytes(`server ${nonce} ${theirs}`);
    if (!(await crypto.subtle.verify("HMAC", key, fromHex(proof), ofServer))) return null;
    const own = await crypto.subtle.sign("HMAC", key, bytes(`page ${nonce} ${theirs}`));
    return JSON.stringify({ proof: toHex(new Uint8Array(own)) });
  } catch {
    return null; // What another program sends may be anything.
  }
}

function newNonce(): string {
  return toHex(crypto.getRandomValues(new Uint8Array(32)));
}

function toHex(bytes: Uint8Array): string {
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
}

function fromHex(letters: string): Uint8Array<ArrayBuffer> {
  return Uint8Array.from(letters.match(/../g)!, (pair) => parseInt(pair, 16));
}
