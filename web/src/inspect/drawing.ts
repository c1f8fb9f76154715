/**
 * Draws a ruler over a picture: a line, a mark at each end, a label.
 *
 * Input: a drawing context, a `SeenRuler`. Output: pixels; `distal/window/ruler_panels.py` draws the same
 * in windows. The line has a dark border and the label a dark plate: both are readable on any picture.
 */

import type { Point, SeenRuler } from "./inspection";

const LINE = "#ffd64a";
const DARK = "#0e1016e8";
const MARK = 6;
const LARGE = 17;
const SMALL = 13;

/** Draws on a picture of some size; `offset` is the frame's lower left, `ratio` pixels for each of the page's. */
export function drawRuler(
  context: CanvasRenderingContext2D,
  { ends, points, lines }: SeenRuler,
  [left, low]: Point,
  ratio: number,
): void {
  const { width, height } = context.canvas;
  const places = points.map((point): Point | null => point && [left + point[0], height - low - point[1]]);
  const marks = [places[0], ...(ends.length > 1 ? [places.at(-1)] : [])];
  const clip = new Path2D();
  clip.rect(0, 0, width, height);
  for (const mark of marks) {
    if (!mark) continue;
    const hole = new Path2D();
    hole.arc(...mark, 0.8 * MARK * ratio, 0, 2 * Math.PI);
    clip.addPath(hole);
  }
  const way = new Path2D();
  places.forEach((place, i) => place && (places[i - 1] ? way.lineTo(...place) : way.moveTo(...place)));
  const rings = new Path2D();
  marks.forEach((mark, i) => mark && rings.addPath(ring(mark, ends[i]!.kind, MARK * ratio)));
  context.lineJoin = "round";
  for (const [color, wide] of [[DARK, 5], [LINE, 2]] as const) {
    context.strokeStyle = color;
    context.lineWidth = wide * ratio;
    context.save();
    // The line ends at the marks, whose inside stays free: the places themselves are seen.
    context.clip(clip, "evenodd");
    context.stroke(way);
    context.restore();
    context.stroke(rings);
  }
  const seen = places.filter((place) => !!place);
  if (lines.length) label(context, lines, seen, ratio);
}

/** A circle on a surface, a square on an edge, a diamond on a corner. */
function ring([x, y]: Point, kind: string, radius: number): Path2D {
  const path = new Path2D();
  if (kind === "edge") path.rect(x - 0.9 * radius, y - 0.9 * radius, 1.8 * radius, 1.8 * radius);
  else if (kind === "corner") {
    const r = 1.25 * radius;
    path.moveTo(x, y - r);
    for (const [right, down] of [[r, 0], [0, r], [-r, 0]] as const) path.lineTo(x + right, y + down);
    path.closePath();
  } else path.arc(x, y, radius, 0, 2 * Math.PI);
  return path;
}

function label(context: CanvasRenderingContext2D, lines: string[], places: Point[], ratio: number): void {
  const font = (i: number) => `${i ? "" : "600 "}${(i ? SMALL : LARGE) * ratio}px system-ui, sans-serif`;
  const heights = lines.map((_, i) => 1.45 * (i ? SMALL : LARGE) * ratio);
  const widths = lines.map((line, i) => ((context.font = font(i)), context.measureText(line).width));
  const padding = 10 * ratio;
  const plate: Point = [
    Math.max(...widths) + 2 * padding,
    heights.reduce((a, b) => a + b) + 1.4 * padding,
  ];
  const [x, y] = freePlace(context.canvas, places, plate, ratio);
  context.fillStyle = DARK;
  context.beginPath();
  context.roundRect(x, y, ...plate, 6 * ratio);
  context.fill();
  context.textBaseline = "middle";
  let at = y + 0.7 * padding;
  lines.forEach((line, i) => {
    context.font = font(i);
    context.fillStyle = [LINE, "#fff"][i] ?? "#c8ced8";
    context.fillText(line, x + padding, at + heights[i]! / 2);
    at += heights[i]!;
  });
}

/** Where a plate covers as little of the line as possible: on one of its four sides. */
function freePlace(
  { width, height }: HTMLCanvasElement | OffscreenCanvas,
  places: Point[],
  [wide, high]: Point,
  ratio: number,
): Point {
  const [x, y] = places[places.length >> 1] ?? [width / 2, height / 2];
  const apart = 18 * ratio;
  const margin = 6 * ratio;
  let best: Point = [0, 0];
  let least = Infinity;
  for (const right of [x + apart, x - apart - wide]) {
    for (const down of [y + apart, y - apart - high]) {
      const left = Math.min(Math.max(right, margin), Math.max(width - wide - margin, 0));
      const top = Math.min(Math.max(down, margin), Math.max(height - high - margin, 0));
      const isUnder = ([px, py]: Point) =>
        Math.abs(px - left - wide / 2) < (wide + apart) / 2 &&
        Math.abs(py - top - high / 2) < (high + apart) / 2;
      const moved = (Math.abs(left - right) + Math.abs(top - down)) / Math.max(width, height);
      const cost = places.filter(isUnder).length + moved;
      if (cost < least) [best, least] = [[left, top], cost];
    }
  }
  return best;
}
