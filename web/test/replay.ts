/**
 * Replays a hand's events on the player's parts, without a browser, and prints what came of them:
 * tests/page/test_same_hand.py does the same to a window's session and compares.
 *
 * In, on standard input: JSON, as `Given`. Out: JSON.
 */

import { readFileSync } from "node:fs";
import { Camera } from "../src/camera";
import { Clock } from "../src/clock";
import { hexOf, linearOf } from "../src/color";
import { listen } from "../src/gestures";
import { Hands, movesOf } from "../src/hands";
import { press, type Actions } from "../src/keyboard";
import { Mouse } from "../src/mouse";
import { shown } from "../src/numbers";
import type { Parameter } from "../src/payload";
import { positionCount, positionOf, valueAt } from "../src/values";

interface Given {
  elevation: number | null;
  start: number;
  size: [number, number];
  events: { type: string; x: number; y: number; [key: string]: unknown }[];
  sliders: { parameter: Parameter; values: number[] }[];
  hex: string[];
  linear: number[][];
  numbers: number[];
}

class Element extends EventTarget {}
Object.assign(globalThis, { HTMLElement: Element, HTMLInputElement: Element });

const given = JSON.parse(readFileSync(0, "utf8")) as Given;
const [width, height] = given.size;
const box = { left: 0, top: 0, right: width, bottom: height, width, height };
const canvas = Object.assign(new Element(), {
  getBoundingClientRect: () => box,
  clientHeight: height,
  setPointerCapture: () => {},
  classList: { add: () => {}, toggle: () => {} },
});

const camera = given.elevation === null ? null : new Camera(given.elevation);
const mouse = new Mouse();
const clock = new Clock(given.start, null);
const hands = new Hands(camera, mouse, () => !camera, () => {});
const other = () => false;
const actions: Actions = {
  ...movesOf(hands, clock, true, () => {}, () => {}),
  ...{ pause: other, nextView: other, lastView: other, fullScreen: other, screenshot: other },
  ...{ parameters: other, help: other, copyCamera: other, mode: other },
};
listen(canvas as unknown as HTMLCanvasElement, hands, () => true);

const states = given.events.map(({ type, x, y, ...rest }) => {
  const event = Object.assign(new Event(type), { clientX: x, clientY: y, pointerId: 1, ...rest });
  if (type === "keydown") {
    Object.assign(event, { composedPath: () => [] });
    press(event as unknown as KeyboardEvent, actions);
  } else canvas.dispatchEvent(event);
  const { yaw, pitch, zoom, pan } = camera?.steering ?? { yaw: 0, pitch: 0, zoom: 1, pan: [0, 0] };
  const state = [yaw, pitch, zoom, ...pan, clock.time, clock.index, clock.speed, ...clock.range()];
  const pointed = mouse.pixels(width, height);
  mouse.settle();
  return [...state, ...pointed];
});

const sliders = given.sliders.map(({ parameter, values }) => {
  const count = positionCount(parameter);
  return values.map((value) => {
    const at = Math.round(positionOf(parameter, value));
    return [at, ...[at - 1, at, at + 1, Math.floor(count / 3)].map((p) => valueAt(parameter, p))];
  });
});
const colors = given.hex.map((text) => linearOf(text));
const texts = given.linear.map((light) => hexOf(light));
const numbers = given.numbers.map((number) => shown(number));
console.log(JSON.stringify({ states, sliders, colors, texts, numbers }));
