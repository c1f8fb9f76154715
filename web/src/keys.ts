/**
 * The keyboard and the buttons of the mouse as a picture reads them.
 *
 * Input: events. Output: texels, a column for each code of a key, and rows from below: is it down, did it
 * go down in this frame, was it pressed an odd number of times. Only the script of pages of pictures that
 * keep frames contains this.
 */

const CODES = 256;
const [HELD, PRESSED, TOGGLED] = [0, CODES, 2 * CODES];

export class Keys {
  readonly WIDTH = CODES;
  readonly HEIGHT = 3;
  readonly texels = new Uint8Array(3 * CODES);
  /** 1: the left button is down, 2: the right one, 4: the middle one. */
  buttons = 0;

  /** Takes a key; false for one that stays the page's. */
  take(event: KeyboardEvent): boolean {
    const { keyCode: code, type, key } = event; // Shaders number keys by these codes.
    if (event.ctrlKey || event.metaKey || event.altKey || key === "Tab" || key === "Escape") return false;
    if (code >= CODES) return false;
    const isDown = type === "keydown";
    if (isDown && !this.texels[HELD + code]) {
      this.texels[PRESSED + code] = 255;
      this.texels[TOGGLED + code]! ^= 255;
    }
    this.texels[HELD + code] = isDown ? 255 : 0;
    return true;
  }

  /** The page has lost the keyboard: it will not hear when keys go up. */
  release(): void {
    this.texels.fill(0, HELD, PRESSED);
  }

  settle(): void {
    this.texels.fill(0, PRESSED, TOGGLED);
  }
}
