/**
 * Pointers and wheels to movements of a hand.
 *
 * Input: events of the canvas. Output: drags in parts of the picture's height, places in parts of the
 * picture from its lower left, zoom factors, notches. It knows neither camera nor scene.
 */

import { notchesOf } from "./generated/interaction";

export interface Hand {
  /** A drag, right and down, in picture heights; `pan`: with the right button or two fingers. */
  drag(right: number, down: number, pan: boolean): void;
  /** Two fingers: above 1 they came together. */
  pinch(factor: number): void;
  wheel(notches: number): void;
  press(x: number, y: number): void;
  move(x: number, y: number): void;
  release(): void;
  doubleClick(): void;
}

interface Place {
  x: number;
  y: number;
}

const LEFT = 0;
/** Back and forth on the side of a mouse are the browser's. */
const HIGHEST_BUTTON = 2;

/** Listens on a canvas. `takesWheel` says whether the wheel is ours or scrolls the page. */
export function listen(
  canvas: HTMLCanvasElement,
  hand: Hand,
  takesWheel: (event: WheelEvent) => boolean,
): void {
  const pointers = new Map<number, Place>();
  let panning = false;

  const within = (event: PointerEvent): [number, number] => {
    const box = canvas.getBoundingClientRect();
    return [(event.clientX - box.left) / box.width, (box.bottom - event.clientY) / box.height];
  };
  const release = (event: PointerEvent) => {
    if (!pointers.delete(event.pointerId)) return;
    canvas.classList.toggle("held", pointers.size > 0);
    if (!pointers.size) hand.release();
  };

  canvas.addEventListener("pointerdown", (event) => {
    if (event.button > HIGHEST_BUTTON) return;
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    panning = event.button !== LEFT || event.shiftKey;
    canvas.classList.add("held");
    if (pointers.size === 1 && event.button === LEFT) hand.press(...within(event));
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    const next = { x: event.clientX, y: event.clientY };
    const height = canvas.clientHeight || 1;
    const others = [...pointers].filter(([id]) => id !== event.pointerId);
    pointers.set(event.pointerId, next);
    // With two fingers each one's way is half of the common one.
    const share = 1 / pointers.size / height;
    const pan = panning || others.length > 0;
    hand.drag((next.x - last.x) * share, (next.y - last.y) * share, pan);
    const other = others[0]?.[1];
    if (other) hand.pinch(distance(last, other) / Math.max(distance(next, other), 1));
    else hand.move(...within(event));
  });
  canvas.addEventListener("pointerup", release);
  canvas.addEventListener("pointercancel", release);
  canvas.addEventListener("lostpointercapture", release);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("dblclick", () => hand.doubleClick());
  canvas.addEventListener(
    "wheel",
    (event) => {
      if (!takesWheel(event)) return;
      event.preventDefault();
      hand.wheel(notchesOf(event.deltaY, event.deltaMode, event.ctrlKey));
    },
    { passive: false },
  );
}

function distance(a: Place, b: Place): number {
  return Math.hypot(a.x - b.x, a.y - b.y);
}
