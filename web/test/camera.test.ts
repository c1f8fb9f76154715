/** A camera that asks its guide: what is merged, what is dropped, and when it moves freely. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { Camera, type Steering } from "../src/camera";
import { ACTIONS, NUMBERS } from "../src/generated/guide";
import { answer, question, type Guided } from "../src/guide";

const EMPTY = Object.fromEntries(NUMBERS.map((name) => [name, 0])) as Guided;

function guided({ yaw, pitch, zoom, pan }: Steering, arrived: number): Guided {
  return { ...EMPTY, yaw, pitch, zoom, panX: pan[0], panY: pan[1], arrived };
}

/** A camera that may not go below a pitch of 0, and what it asked. */
function aboveGround(): [Camera, Steering[]] {
  const camera = new Camera(0.5);
  const goals: Steering[] = [];
  camera.ask = async (_, __, goal) => {
    goals.push(goal);
    await new Promise((resolve) => setTimeout(resolve, 2));
    const isFree = goal.pitch >= 0;
    return guided({ ...goal, pitch: Math.max(goal.pitch, 0) }, isFree ? 1 : 0);
  };
  return [camera, goals];
}

test("a gesture goes as far as the guide lets it", async () => {
  const [camera] = aboveGround();
  camera.orbit(0.1, -0.1);
  assert.equal(camera.steering.yaw, 0); // Not before the answer.
  await camera.rest();
  assert.ok(Math.abs(camera.steering.yaw + 0.1 * Math.PI) < 1e-12);
  assert.equal(camera.steering.pitch, 0);
  // What was in the way is forgotten: the way back begins at once.
  camera.orbit(0, 0.01);
  await camera.rest();
  assert.ok(Math.abs(camera.steering.pitch - 0.01 * Math.PI) < 1e-12);
});

test("gestures during an answer are one goal", async () => {
  const [camera, goals] = aboveGround();
  for (let i = 0; i < 10; i++) camera.orbit(0.01, 0.01);
  await camera.rest();
  assert.equal(goals.length, 2);
  assert.ok(Math.abs(camera.steering.yaw + 0.1 * Math.PI) < 1e-12);
});

test("what a program sets stands, whatever was asked before", async () => {
  const [camera] = aboveGround();
  camera.orbit(0.3, -0.3);
  camera.set({ yaw: 1, pitch: -1 });
  await camera.rest();
  assert.deepEqual(camera.steering, { yaw: 1, pitch: -1, zoom: 1, pan: [0, 0] });
  camera.orbit(0.3, 0.3);
  camera.reset();
  await camera.rest();
  assert.equal(camera.moved, false);
});

test("without an answer the camera moves freely", async () => {
  for (const ask of [async () => null, async () => Promise.reject(new Error("lost"))]) {
    const camera = new Camera(0);
    camera.ask = ask;
    camera.wheel(-2);
    await camera.rest();
    assert.ok(camera.steering.zoom < 0.8);
    await camera.show("top");
    assert.equal(await camera.place(), null);
    assert.ok(camera.steering.zoom < 0.8);
  }
});

test("an answer is read from bytes, and a broken one is none", () => {
  const numbers = new Float32Array(NUMBERS.map((_, i) => i + 0.5));
  const found = answer(new Uint8Array(numbers.buffer))!;
  assert.equal(found.zoom, 2.5);
  assert.equal(found.upZ, NUMBERS.length - 0.5);
  assert.equal(answer(new Uint8Array(4 * NUMBERS.length)), null); // A lost context reads zeros.
  numbers[0] = NaN;
  assert.equal(answer(new Uint8Array(numbers.buffer)), null);
});

test("a question names what the program reads", () => {
  const now: Steering = { yaw: 1, pitch: 2, zoom: 3, pan: [4, 5] };
  const goal: Steering = { yaw: 6, pitch: 7, zoom: 8, pan: [9, 10] };
  assert.deepEqual(question("top", now, goal, [4, 3]), {
    View_yaw: 1, View_pitch: 2, View_zoom: 3, View_pan: [4, 5],
    Goal_yaw: 6, Goal_pitch: 7, Goal_zoom: 8, Goal_pan: [9, 10],
    Guide_action: ACTIONS.indexOf("top"), Guide_size: [4, 3],
  });
});
