/** Keys to actions: which key does what, and when a key belongs to somebody else. */

export interface Actions {
  /** An arrow: where to, right and up, in parts of the picture's height. False: nothing moves. */
  arrow(right: number, up: number): boolean;
  zoom(factor: number): boolean;
  toggle(): boolean;
  reset(): boolean;
  nextView(): boolean;
  fullScreen(): boolean;
  screenshot(): boolean;
  panel(): boolean;
  help(): boolean;
}

/** For the page of help, in its order. */
export const KEYS: readonly (readonly [keys: string, meaning: string, needs: keyof Actions])[] = [
  ["← → ↑ ↓", "Turn around the scene", "arrow"],
  ["+ −", "Nearer, farther", "zoom"],
  ["R", "Reset the camera", "reset"],
  ["Space", "Play or pause", "toggle"],
  ["V", "Next view", "nextView"],
  ["F", "Full screen", "fullScreen"],
  ["S", "Save a picture", "screenshot"],
  ["H", "Hide or show the panel", "panel"],
  ["?", "This list", "help"],
];

const STEP = 1 / 24;
const ZOOM = 1.1;

const ACTS: Record<string, (actions: Actions) => boolean> = {
  ArrowLeft: (a) => a.arrow(-STEP, 0),
  ArrowRight: (a) => a.arrow(STEP, 0),
  ArrowUp: (a) => a.arrow(0, STEP),
  ArrowDown: (a) => a.arrow(0, -STEP),
  "+": (a) => a.zoom(1 / ZOOM),
  "=": (a) => a.zoom(1 / ZOOM),
  "-": (a) => a.zoom(ZOOM),
  " ": (a) => a.toggle(),
  r: (a) => a.reset(),
  v: (a) => a.nextView(),
  f: (a) => a.fullScreen(),
  s: (a) => a.screenshot(),
  h: (a) => a.panel(),
  "?": (a) => a.help(),
};

/** Acts on a key unless the element that has the focus needs it. */
export function press(event: KeyboardEvent, actions: Actions): void {
  if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
  const { key } = event;
  if (isNeeded(event.composedPath()[0], key)) return;
  const act = ACTS[key.length === 1 ? key.toLowerCase() : key];
  if (act?.(actions)) event.preventDefault();
}

function isNeeded(target: EventTarget | undefined, key: string): boolean {
  if (!(target instanceof HTMLElement)) return false;
  const isArrow = key.startsWith("Arrow");
  if (target instanceof HTMLInputElement) {
    // A slider takes arrows, a switch the space bar; where one writes, every key is text.
    if (target.type === "range") return isArrow;
    return target.type === "checkbox" ? key === " " : true;
  }
  if (target.closest("textarea, select, dialog[open], [contenteditable]")) return true;
  return key === " " && !!target.closest("button, summary, a");
}
