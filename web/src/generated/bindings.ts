// Made by tools/gen_player.py from src/distal/scene/viewing/key_bindings.py: change that, and run it.

export type Action = "left" | "right" | "up" | "down" | "nearer" | "farther" | "resetCamera" | "frame" | "front" | "backSide" | "rightSide" | "leftSide" | "top" | "bottom" | "copyCamera" | "pause" | "back" | "forth" | "frameBack" | "frameForth" | "begin" | "slower" | "faster" | "nextView" | "lastView" | "mode" | "parameters" | "screenshot" | "fullScreen" | "help";

export const KEYS: Record<string, Action> = {
  "ArrowLeft": "left",
  "ArrowRight": "right",
  "ArrowUp": "up",
  "ArrowDown": "down",
  "+": "nearer",
  "=": "nearer",
  "-": "farther",
  "_": "farther",
  "r": "resetCamera",
  "f": "frame",
  "1": "front",
  "3": "rightSide",
  "7": "top",
  "c": "copyCamera",
  " ": "pause",
  ",": "back",
  ".": "forth",
  "<": "frameBack",
  ";": "frameBack",
  ">": "frameForth",
  ":": "frameForth",
  "Home": "begin",
  "[": "slower",
  "]": "faster",
  "v": "nextView",
  "V": "lastView",
  "p": "parameters",
  "s": "screenshot",
  "F": "fullScreen",
  "h": "help",
  "?": "help",
  ...(PATHS && {"m": "mode"}),
};

/** The actions of digits with shift. */
export const OPPOSITES: Record<string, Action> = {
  "1": "backSide",
  "3": "leftSide",
  "7": "bottom",
};

export type Needs = Action | "camera" | "mouse";

export const HELP: readonly (readonly [string, string, Needs])[] = [
  ["Drag, arrows", "Turn around the scene", "camera"],
  ["Right or shift drag", "Move the scene (shift arrows, two fingers)", "camera"],
  ["Wheel, pinch, + -", "Nearer, farther", "camera"],
  ["R, double click", "Reset the camera", "camera"],
  ["F", "See the whole scene", "camera"],
  ["1  3  7", "From the front, right, top (shift: opposite)", "camera"],
  ["C", "Copy the camera as Python", "camera"],
  ["Drag, arrows", "The mouse that the picture reads", "mouse"],
  ["R", "Reset the mouse", "mouse"],
  ["Space", "Play or pause", "pause"],
  [",  .", "Step in time (shift: one frame)", "back"],
  ["Home", "Back to the start time", "begin"],
  ["[  ]", "Slower, faster", "slower"],
  ["V, shift V", "Next view, the one before", "nextView"],
  ...(PATHS ? [["M", "Direct light or paths", "mode"] as const] : []),
  ["P", "Parameters", "parameters"],
  ["S", "Save a picture", "screenshot"],
  ["Shift F", "Full screen", "fullScreen"],
  ["H, ?", "This list", "help"],
];
