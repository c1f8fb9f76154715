/**
 * What a person inspects: the plane that cuts a scene open, and a ruler on its surface.
 *
 * Input: choices of a panel, places of the pointer. Output: the numbers that the programs of a cut scene
 * read, the places on the surface, the measures. The arithmetic is scene code: small programs of the GPU
 * find places, measure, and know where planes lie; here is what is chosen.
 */

import {
  CUT_AXES,
  CUT_NUMBERS,
  END,
  HATCH,
  KINDS,
  NORMAL,
  OFFSET,
  PLACE_NUMBERS,
  POINTER,
  POINTS,
  RULER_NUMBERS,
  SIZE,
  START,
  UNSEEN,
  cutLines,
  cutPlace,
  measured,
} from "../generated/inspect";
import { shown } from "../numbers";
import type { Given } from "../uniforms";

/** What a payload says of inspection: numbers of programs. */
export interface Inspecting {
  /** By view, its program of the scene that is cut open. */
  cuts: Record<string, number>;
  /** Why nothing can be cut; "" if it can. */
  why: string;
  /** What finds the place under a pointer: of the whole scene, and of the cut one. */
  places: [number, number];
  ruler: number;
  planes: number;
  unit: string;
}

/** Who waits longer wants to know what for. */
const LATE_MS = 300;

export type Axis = (typeof CUT_AXES)[number];
export type Point = [number, number];

export interface Plane {
  axis: Axis;
  normal: number[];
  low: number;
  high: number;
  diagonal: number;
  /** Its place from 0 to 1. */
  share: number;
  isFlipped: boolean;
}

export interface End {
  point: number[];
  kind: (typeof KINDS)[number];
  pixel: number;
}

/** A ruler in a picture; points in pixels from its frame's lower left, null where one is not seen. */
export interface SeenRuler {
  ends: End[];
  points: (Point | null)[];
  lines: string[];
}

/** What the player does for an inspection. */
export interface Stage {
  /** The numbers of a program's row; null where it cannot be drawn. */
  read(program: number, given: Given, count: number): Promise<number[] | null>;
  /** The size of the frame in pixels. */
  readonly size: Point;
  /** The camera stands where gestures have asked it to go. */
  rest(): Promise<void>;
  /** Another program is needed, or other numbers. */
  changed(): void;
}

export class Inspection {
  plane: Plane | null = null;
  isMeasuring = false;
  ends: End[] = [];
  /** What to do next. */
  hint = "";
  /** Called after something has changed. */
  onChange: () => void = () => {};

  constructor(
    readonly facts: Inspecting,
    readonly stage: Stage,
  ) {}

  /** The numbers that programs of the cut scene read. */
  get numbers(): Given {
    if (!this.plane) return {};
    const { normal, low, high, share, isFlipped, diagonal } = this.plane;
    const sign = isFlipped ? -1 : 1;
    return {
      [NORMAL]: normal.map((n) => sign * n),
      [OFFSET]: sign * cutPlace(low, high, share),
      [HATCH]: cutLines(diagonal),
    };
  }

  /** Cuts along an axis, in the middle; null: the whole scene. */
  async cut(axis: Axis | null): Promise<void> {
    if (this.facts.why) return;
    const found = axis && (await this.#planes());
    if (axis && !found) return;
    this.plane = found ? { ...planeOf(axis!, found), share: 0.5, isFlipped: false } : null;
    this.stage.changed();
    this.onChange();
  }

  /** The next axis; after the last one the scene is whole. */
  next(): void {
    const at = this.plane ? CUT_AXES.indexOf(this.plane.axis) : -1;
    void this.cut(CUT_AXES[at + 1] ?? null);
  }

  /** The plane elsewhere, or its other side. */
  move(change: Partial<Pick<Plane, "share" | "isFlipped">>): void {
    if (!this.plane) return;
    Object.assign(this.plane, change);
    this.stage.changed();
    this.onChange();
  }

  /** Cuts the other side away. */
  turn(): void {
    if (this.plane) this.move({ isFlipped: !this.plane.isFlipped });
  }

  /** The scene has another size: the plane stays at its share of it. */
  async refresh(): Promise<void> {
    const { plane } = this;
    if (!plane || plane.axis === "view") return;
    const found = await this.#planes();
    if (!found || this.plane !== plane) return;
    Object.assign(plane, planeOf(plane.axis, found));
    this.stage.changed();
    this.onChange();
  }

  #planes(): Promise<number[] | null> {
    const given = { [SIZE]: this.stage.size };
    return this.stage.read(this.facts.planes, given, CUT_NUMBERS.length);
  }

  /** Begins to choose places, or removes the ruler. */
  measure(isOn = !this.isMeasuring): void {
    this.isMeasuring = isOn;
    this.ends = [];
    if (isOn) void this.#place([0, 0]); // Compiled before the first click.
    this.hint = isOn ? "Click or tap the first place." : "";
    this.onChange();
  }

  /** Chooses the place at a pixel of the frame, from its lower left; a third one starts anew. */
  async choose(pointer: Point): Promise<void> {
    await this.stage.rest();
    const late = setTimeout(() => {
      this.hint = "Finding the place …";
      this.onChange();
    }, LATE_MS);
    const found = await this.#place(pointer);
    clearTimeout(late);
    if (!this.isMeasuring) return;
    const kind = found && KINDS[found[3]!];
    if (!found?.every(Number.isFinite)) this.hint = "The graphics driver does not find places.";
    else if (!kind || kind === "nothing") this.hint = "Nothing is there. Choose a place on the shape.";
    else {
      const end = { point: found.slice(0, 3), kind, pixel: found[4]! };
      this.ends = this.ends.length === 2 ? [end] : [...this.ends, end];
      this.hint = this.ends.length === 2 ? "" : `From ${endText(end)}: choose the second place.`;
    }
    this.onChange();
  }

  #place(pointer: Point): Promise<number[] | null> {
    const given = { [POINTER]: pointer, [SIZE]: this.stage.size };
    return this.stage.read(this.facts.places[this.plane ? 1 : 0]!, given, PLACE_NUMBERS.length);
  }

  /** The ruler in a picture whose frame has this size; null where there is none. */
  async seen(size = this.stage.size): Promise<SeenRuler | null> {
    const { ends } = this;
    const [start, end = start] = ends;
    if (!start || !end) return null;
    const given = { [START]: start.point, [END]: end.point, [SIZE]: size };
    const count = RULER_NUMBERS.length + 2 * POINTS;
    const found = await this.stage.read(this.facts.ruler, given, count);
    if (!found || ends !== this.ends) return null;
    const points = Array.from({ length: POINTS }, (_, i): Point | null => {
      const [x, y] = found.slice(RULER_NUMBERS.length + 2 * i) as Point;
      return x < UNSEEN ? [x, y] : null;
    });
    if (end === start) return { ends, points: points.slice(0, 1), lines: [] };
    return { ends, points, lines: this.#lines(start, end, found) };
  }

  #lines(start: End, end: End, [distance, ...ways]: number[]): string[] {
    const pixel = Math.min(start.pixel, end.pixel);
    const axes = [..."xyz"].map((axis, i) => `Δ${axis} ${text(ways[i]!, pixel)}`).join("   ");
    const length = `${text(distance!, pixel)} ${this.facts.unit}`;
    return [length, axes, `from ${endText(start)}`, `to ${endText(end)}`];
  }
}

function planeOf(axis: Axis, found: number[]): Omit<Plane, "share" | "isFlipped"> {
  const own = found.slice(5 * CUT_AXES.indexOf(axis));
  const [low, high] = own.slice(3) as Point;
  return { axis, normal: own.slice(0, 3), low, high, diagonal: found.at(-1)! };
}

function text(value: number, pixel: number): string {
  return shown(measured(value, pixel)).replace("-", "\u2212");
}

function endText({ point, kind, pixel }: End): string {
  return `(${point.map((n) => text(n, pixel)).join(", ")}), ${kind}`;
}
