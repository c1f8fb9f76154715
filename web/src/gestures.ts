/**
 * Pointers and wheels to movements of a hand.
 *
 * In: events of the canvas. Out: drags in parts of the picture's height, places in parts of the
 * picture from its lower left, zoom factors. It knows neither camera nor scene.
 */

export interface Hand {
  /** A drag, right and down, in picture heights; `pan`: with the right button or two fingers. */
  drag(right: number, down: number, pan: boolean): void;
  zoom(factor: number): void;
  press(x: number, y: number): void;
  move(x: number, y: number): void;
  release(): void;
  reset(): void;
}

interface Place {
  x: number;
  y: number;
}

/** Lines and pages of a wheel that does not count pixels. */
const WHEEL_UNIT_PX = [1, 16, 400];

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
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    panning = event.button !== 0 || event.shiftKey;
    canvas.classList.add("held");
    if (pointers.size === 1) hand.press(...within(event));
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
    if (other) hand.zoom(distance(last, other) / Math.max(distance(next, other), 1));
    else hand.move(...within(event));
  });
  canvas.addEventListener("pointerup", release);
  canvas.addEventListener("pointercancel", release);
  canvas.addEventListener("lostpointercapture", release);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("dblclick", () => hand.reset());
  canvas.addEventListener(
    "wheel",
    (event) => {
      if (!takesWheel(event)) return;
      event.preventDefault();
      const way = event.deltaY * WHEEL_UNIT_PX[event.deltaMode]!;
      // A pinch on a touch pad arrives as a wheel with ctrl, in small steps.
      hand.zoom(Math.exp(Math.min(Math.max(way * (event.ctrlKey ? 0.01 : 0.0015), -1), 1)));
    },
    { passive: false },
  );
}

function distance(a: Place, b: Place): number {
  return Math.hypot(a.x - b.x, a.y - b.y);
}
