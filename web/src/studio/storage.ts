/**
 * What the browser keeps for this address: of all tabs, or of one.
 *
 * Input: a key, a text. Output: the text of an earlier page, and whether it was kept. A browser that refuses
 * storage has nothing and keeps nothing.
 */

type Place = "localStorage" | "sessionStorage";

export function recalled(place: Place, key: string): string | null {
  try {
    return window[place].getItem(key);
  } catch {
    return null;
  }
}

/** Keeps a text, or removes it by null; returns whether that was possible. */
export function remember(place: Place, key: string, value: string | null): boolean {
  try {
    if (value === null) window[place].removeItem(key);
    else window[place].setItem(key, value);
    return true;
  } catch {
    return false;
  }
}
