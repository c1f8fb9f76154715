/**
 * Share links: JSON, compressed by deflate, in the letters of base64url, as `distal/editor/links.py`.
 *
 * Input: what is shared. Output: the fragment of an address, and back; null for a text that is none.
 */

import type { Values } from "../payload";

export interface Shared {
  files: Record<string, string>;
  main: string;
  values?: Values;
  camera?: { yaw: number; pitch: number; zoom: number; pan: [number, number] };
  time?: number;
}

const PREFIX = "#c=";
/** Characters of a link, and of what is in it. */
const LONGEST = 1_000_000;
/** Each file has a tab. */
const MOST_FILES = 100;
/** A name that Python's side takes, too: what is not printed could look like another one. */
const NAME = /^[^/\\\p{C}\p{Zl}\p{Zp}]{1,200}\.py$/u;

export async function linkOf(shared: Shared): Promise<string> {
  const bytes = new TextEncoder().encode(JSON.stringify(shared));
  const packed = await through(bytes, new CompressionStream("deflate-raw"));
  const text = btoa(Array.from(packed, (byte) => String.fromCharCode(byte)).join(""));
  return PREFIX + text.replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
}

export async function sharedOf(fragment: string): Promise<Shared | null> {
  if (!fragment.startsWith(PREFIX) || fragment.length > LONGEST) return null;
  try {
    const text = atob(fragment.slice(PREFIX.length).replaceAll("-", "+").replaceAll("_", "/"));
    const packed = Uint8Array.from(text, (letter) => letter.charCodeAt(0));
    const bytes = await through(packed, new DecompressionStream("deflate-raw"));
    const found = JSON.parse(new TextDecoder().decode(bytes)) as Shared;
    return isShared(found) ? found : null;
  } catch {
    return null;
  }
}

function isShared(found: Shared | null): found is Shared {
  if (typeof found?.main !== "string" || typeof found.files !== "object" || !found.files) return false;
  const names = Object.entries(found.files);
  const areFine = names.every(([name, text]) => NAME.test(name) && typeof text === "string");
  return areFine && names.length <= MOST_FILES && Object.hasOwn(found.files, found.main);
}

/** Reads a stream as far as a link may go: a short one can unpack to gigabytes. */
async function through(
  bytes: Uint8Array<ArrayBuffer>,
  stream: CompressionStream | DecompressionStream,
): Promise<Uint8Array> {
  const reader = new Blob([bytes]).stream().pipeThrough(stream).getReader();
  const parts: Uint8Array[] = [];
  let length = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    length += value.length;
    if (length > LONGEST) throw new RangeError("The link is too long.");
    parts.push(value);
  }
  const all = new Uint8Array(length);
  let at = 0;
  for (const part of parts) {
    all.set(part, at);
    at += part.length;
  }
  return all;
}
