// Made by tools/gen_messages.py from src/distal/editor/messages: change that, and run it.
// A field with a question mark has the default there where it is left out.

import type { Parameter, Payload, Program, UniformEntry } from "../payload";

export type Value = boolean | number | number[];

export type LiteralValue = boolean | number | string | number[];

/** One change of the source that the worker writes. */
export interface Change {
  /** "literal": the one at `file`, `start` and `end`; "parameter": the default in the declaration of the parameter `name`; "camera": the placement of the scene's camera. */
  what: "literal" | "parameter" | "camera";
  file?: string | null;
  start?: number | null;
  end?: number | null;
  name?: string | null;
  /** The new value of a literal or parameter; a choice's number for a parameter of choice. */
  value?: boolean | number | string | number[] | null;
  /** For a camera: what `Player.cameraText()` gives. */
  text?: string | null;
}

/** A piece of a file to replace: offsets in the text as it was sent. */
export interface Edit {
  file: string;
  start: number;
  end: number;
  text: string;
}

/** A literal of the source that a dial, a picker or a switch can change. */
export interface SourceLiteral {
  file: string;
  line: number;
  start: number;
  end: number;
  text: string;
  /** What changes it. */
  type: "number" | "vector" | "color" | "switch" | "choice";
  /** Its value now; of a color linear numbers, or its text where it is "#hex". */
  value: boolean | number | string | number[];
  /** Start and end of each number of a vector. */
  parts: [number, number][];
  /** The function or class it is an argument of, or "". */
  call: string;
  /** The name of that argument, or of the variable it is assigned to, or "". */
  slot: string;
  /** The least allowed value, of each part of a vector. */
  low: number | null;
  /** The greatest. */
  high: number | null;
  /** How much the last written digit counts. */
  step: number;
  /** Whether only whole numbers are allowed. */
  whole: boolean;
  /** The words of a choice. */
  options: string[];
  /** What a drag needs: "numbers" where the program stays (an object scene), "hold" where a `hold` request first makes it an input (in a `@func`), else "compile". */
  way: "numbers" | "hold" | "compile";
}

/** Where a shape of the scene was written. */
export interface ShapePlace {
  /** The author's name for it, else that of the primitive or operator. */
  name: string;
  /** Whether the name is the author's. */
  label: boolean;
  file: string;
  line: number;
  /** First column of the call that makes it. */
  start: number;
  /** One past its last column on that line. */
  end: number;
  /** The material's name or "". */
  material: string;
}

/** Another place that a mistake is about, and what is there; fields as those of `Mistake`. */
export interface MistakeLabel {
  text: string;
  file: string | null;
  line: number | null;
  column: number | null;
  end_line: number | null;
  end_column: number | null;
  excerpt: string | null;
}

/** An error, warning or note: the JSON of a `Diagnostic`, and how severe it is. */
export interface Mistake {
  severity: "error" | "warning" | "note";
  /** The family of messages that it belongs to. */
  code: string;
  message: string;
  hint: string | null;
  file: string | null;
  /** Counted from 1, as columns are, in characters; null where the place is not known. */
  line: number | null;
  column: number | null;
  end_line: number | null;
  /** One past the last column on the first line. */
  end_column: number | null;
  /** The whole first line. */
  excerpt: string | null;
  labels: MistakeLabel[];
}

/** A format of `render`. */
export interface RenderFormat {
  name: string;
  /** Whether it is a film; it is then written beside the scene. */
  film: boolean;
  /** The bits of a channel that there are; the first is the default. */
  bits: number[];
  /** Whether it has a quality. */
  lossy: boolean;
  /** Whether the file says if it repeats. */
  loops: boolean;
  /** What has to be installed first, or None. */
  missing: string | null;
}

/** A file on the disk that has no text. */
export interface DiskProblem {
  /** Of its bytes; "" if it is gone, "?" if it cannot be read. */
  digest: string;
  /** What is wrong, for a sentence that begins with its name: "was deleted". */
  text: string;
}

/** A draft: a text, and the digest of what was on the disk when it began. */
export interface UnsavedText {
  text: string;
  digest: string;
}

/** A version of a file. */
export interface VersionEntry {
  /** Names it in `version`. */
  name: string;
  /** When it was kept, in milliseconds since 1970. */
  at: number;
  /** "opened" (on the disk then), "saved" (here), "other" (by another program), "typed" (in the page), "left" (in a tab that is gone). */
  why: string;
  /** In bytes. */
  size: number;
}

/** Edits that make the changes; the new literals are found by the next `look`. */
export interface Written {
  edits: Edit[];
}

/**
 * A program that counts how often lines run, or their operations, and what to draw it with.
 *
 * Draw it as the view's program with the uniform `which` set to the number of a place: each
 * pixel's color holds the count as red + 256 green + 65536 blue (bytes).
 */
export interface Counting {
  program: Program;
  which: string;
  /** The largest count of a pixel; it stands for all above. */
  most: number;
  files: string[];
  /** File (number in `files`) and line by the number of the place. */
  places: [number, number][];
}

/** A program that does what a line computes several times, without changing the picture. */
export interface LineTiming {
  program: Program;
  /** The program's line that picks a place. It ends in -1, for none; with n it repeats place n, with -2 - n the loop of the place alone, without what it computes. */
  choice: string;
  /** The uniform that says how often. */
  repeats: string;
  files: string[];
  /** File (number in `files`) and line by the number of the place. */
  places: [number, number][];
  /** How often one repetition does the line, by the number of the place. */
  evaluations: number[];
}

/**
 * A program that draws which shape each pixel shows, for outlines.
 *
 * Draw it as the view's program: each pixel's color holds the number of a part as red + 256 green
 * + 65536 blue (bytes), with alpha 0 where there is none.
 */
export interface ShapeMap {
  program: Program;
  files: string[];
  /** For each number the lines that make a shape which holds the part: file (number in `files`) and line. */
  parts: [number, number][][];
}

/** What a pixel shows; `shape` is empty where it is the background. */
export interface ProbeResult {
  shape: string;
  material: string;
  file: string | null;
  line: number | null;
  point: number[];
  normal: number[];
  /** Further measured values by name, e.g. "steps", "distance", "depth". */
  numbers: Record<string, number>;
}

/** What `distal check` reports. */
export interface Checked {
  mistakes: Mistake[];
}

/** A scene as the text of a target, and where its lines come from. */
export interface EmittedText {
  target: string;
  language: "glsl" | "wgsl" | "llvm" | "ir";
  text: string;
  files: string[];
  places: [number, number, number, number][];
}

/** A file to save: its data as text, or in base64 where it is bytes. */
export interface ExportedFile {
  name: string;
  media_type: string;
  text: string | null;
  base64: string | null;
  command: string;
}

/** A finished picture or film. */
export interface Rendered {
  /** The file's name. */
  name: string;
  /** Its size. */
  bytes: number;
  /** Where the page gets it, for a picture; None for a film, which is beside the scene. */
  address: string | null;
  /** The command that makes the same file. */
  command: string;
  /** What the command has said: figures, warnings. */
  said: string;
}

/** The command that renders a picture or film, in the folder of the scene. */
export interface Planned {
  command: string;
}

/** What `render` can be asked for. */
export interface RenderChoices {
  formats: RenderFormat[];
  /** How light may be computed. */
  modes: string[];
  /** Names of qualities; numbers from 0 to 100 are allowed, too. */
  qualities: string[];
  /** The one that is used without. */
  quality: string;
  /** Of a picture, in pixels. */
  largest_side: number;
  /** Of a pixel. */
  most_samples: number;
  /** Samples of a pixel in mode "path" without `samples` and `time_limit`. */
  path_samples: number;
}

/** The file is on the disk with this digest; or it is not written, and this is there instead. */
export interface Saved {
  /** Of what is on the disk now; "" for nothing, "?" for what cannot be read. */
  digest: string;
  /** Whether the text is on the disk. */
  is_saved: boolean;
  /** The text that is there instead; None where there is none. */
  conflict: string | null;
  /** What is wrong with the file that is there instead, as `DiskProblem.text`; or "". */
  problem: string;
  /** Why the file is not replaced, although `in_place` would write it; or "". */
  refusal: string;
  /** What another program wrote while the file was replaced; it is among the versions. */
  other: string | null;
  /** Why the versions cannot be kept; "" where they are. */
  unkept: string;
  /** As in `changed`. */
  order: number;
}

/** What a tab begins with. */
export interface Greeted {
  /** The tab's name, to be said when the page is loaded again. */
  tab: string;
  /** Its unsaved texts by file. */
  drafts: Record<string, UnsavedText>;
  /** Files of which other unsaved texts were there; they are versions now. */
  others: string[];
  /** Why nothing can be kept; "" where it can. */
  unkept: string;
}

/** The draft is kept; or `unkept` says why not. */
export interface DraftAnswer {
  unkept: string;
}

/** The versions of a file, the newest first. */
export interface VersionList {
  versions: VersionEntry[];
}

/** The text of a version. */
export interface VersionText {
  text: string;
}

/** Compile a scene's view. Answered by `scene`, `numbers` or `mistakes`. */
export interface LookRequest {
  kind: "look";
  /** The app's number of the request, never used twice. */
  id: number;
  /** The app's number of the text, greater after each change. */
  revision: number;
  /** The texts by name: the scene's file and modules beside it. */
  files: Record<string, string>;
  /** The name of the scene's file. */
  main: string;
  /** The name of the object in it; None for the only one. */
  object?: string | null;
  /** The view to show. */
  view?: string;
  /** Values of parameters by name; others have their defaults. */
  values?: Record<string, boolean | number | number[]>;
  /** In seconds. */
  time?: number;
  /** The look to show it in; None for its own. */
  look?: string | null;
  /** How light is computed; None: as the scene says. */
  mode?: "direct" | "path" | null;
  /** The author's frame in pixels. */
  size?: [number, number];
  /** The `key` of the program that the app shows; if it is still that of the scene, the answer is `numbers`. None for a `scene` in any case. */
  known?: string | null;
  /** Changes to make in the text first; the answer has their edits. */
  changes?: Change[];
  /** Whether to leave out literals and shapes, as while a literal is dragged. */
  lean?: boolean;
  /** Whether the camera's guide is among the programs. Without it the camera moves freely; while one types, the picture comes sooner. */
  guided?: boolean;
}

/**
 * Make the number of a `@func` an input of the program. Answered as a `look`.
 *
 * The `scene` that answers has `held`: the name of the input, to be set by
 * `player.setNumber(held, value)`. Where it cannot be an input (a loop's bound), `held` is
 * None and the program is the usual one.
 */
export interface HoldRequest {
  kind: "hold";
  /** The app's number of the request, never used twice. */
  id: number;
  /** The app's number of the text, greater after each change. */
  revision: number;
  /** The texts by name: the scene's file and modules beside it. */
  files: Record<string, string>;
  /** The name of the scene's file. */
  main: string;
  /** The name of the object in it; None for the only one. */
  object?: string | null;
  /** The view to show. */
  view?: string;
  /** Values of parameters by name; others have their defaults. */
  values?: Record<string, boolean | number | number[]>;
  /** In seconds. */
  time?: number;
  /** The look to show it in; None for its own. */
  look?: string | null;
  /** How light is computed; None: as the scene says. */
  mode?: "direct" | "path" | null;
  /** The author's frame in pixels. */
  size?: [number, number];
  file: string;
  start: number;
  end: number;
}

/** Write changes into the source: Keep of a slider, a literal or the camera. */
export interface WriteRequest {
  kind: "write";
  /** The app's number of the request, never used twice. */
  id: number;
  /** The app's number of the text, greater after each change. */
  revision: number;
  /** The texts by name: the scene's file and modules beside it. */
  files: Record<string, string>;
  /** The name of the scene's file. */
  main: string;
  /** The name of the object in it; None for the only one. */
  object?: string | null;
  /** The view to show. */
  view?: string;
  /** Values of parameters by name; others have their defaults. */
  values?: Record<string, boolean | number | number[]>;
  /** In seconds. */
  time?: number;
  /** The look to show it in; None for its own. */
  look?: string | null;
  /** How light is computed; None: as the scene says. */
  mode?: "direct" | "path" | null;
  /** The author's frame in pixels. */
  size?: [number, number];
  changes: Change[];
}

/** Give the program that counts how often each line runs. */
export interface CountRequest {
  kind: "count";
  /** The app's number of the request, never used twice. */
  id: number;
  /** The app's number of the text, greater after each change. */
  revision: number;
  /** The texts by name: the scene's file and modules beside it. */
  files: Record<string, string>;
  /** The name of the scene's file. */
  main: string;
  /** The name of the object in it; None for the only one. */
  object?: string | null;
  /** The view to show. */
  view?: string;
  /** Values of parameters by name; others have their defaults. */
  values?: Record<string, boolean | number | number[]>;
  /** In seconds. */
  time?: number;
  /** The look to show it in; None for its own. */
  look?: string | null;
  /** How light is computed; None: as the scene says. */
  mode?: "direct" | "path" | null;
  /** The author's frame in pixels. */
  size?: [number, number];
  /** Whether its estimated operations are counted instead. */
  work?: boolean;
}

/** Give the program that repeats what a line computes, to measure its time. */
export interface TimeRequest {
  kind: "time";
  /** The app's number of the request, never used twice. */
  id: number;
  /** The app's number of the text, greater after each change. */
  revision: number;
  /** The texts by name: the scene's file and modules beside it. */
  files: Record<string, string>;
  /** The name of the scene's file. */
  main: string;
  /** The name of the object in it; None for the only one. */
  object?: string | null;
  /** The view to show. */
  view?: string;
  /** Values of parameters by name; others have their defaults. */
  values?: Record<string, boolean | number | number[]>;
  /** In seconds. */
  time?: number;
  /** The look to show it in; None for its own. */
  look?: string | null;
  /** How light is computed; None: as the scene says. */
  mode?: "direct" | "path" | null;
  /** The author's frame in pixels. */
  size?: [number, number];
}

/** Give the program that draws which shape each pixel shows. */
export interface MapRequest {
  kind: "map";
  /** The app's number of the request, never used twice. */
  id: number;
  /** The app's number of the text, greater after each change. */
  revision: number;
  /** The texts by name: the scene's file and modules beside it. */
  files: Record<string, string>;
  /** The name of the scene's file. */
  main: string;
  /** The name of the object in it; None for the only one. */
  object?: string | null;
  /** The view to show. */
  view?: string;
  /** Values of parameters by name; others have their defaults. */
  values?: Record<string, boolean | number | number[]>;
  /** In seconds. */
  time?: number;
  /** The look to show it in; None for its own. */
  look?: string | null;
  /** How light is computed; None: as the scene says. */
  mode?: "direct" | "path" | null;
  /** The author's frame in pixels. */
  size?: [number, number];
}

/** Tell what the pixel at `x`, `y` shows (from the top left), with the camera as moved. */
export interface ProbeRequest {
  kind: "probe";
  /** The app's number of the request, never used twice. */
  id: number;
  /** The app's number of the text, greater after each change. */
  revision: number;
  /** The texts by name: the scene's file and modules beside it. */
  files: Record<string, string>;
  /** The name of the scene's file. */
  main: string;
  /** The name of the object in it; None for the only one. */
  object?: string | null;
  /** The view to show. */
  view?: string;
  /** Values of parameters by name; others have their defaults. */
  values?: Record<string, boolean | number | number[]>;
  /** In seconds. */
  time?: number;
  /** The look to show it in; None for its own. */
  look?: string | null;
  /** How light is computed; None: as the scene says. */
  mode?: "direct" | "path" | null;
  /** The author's frame in pixels. */
  size?: [number, number];
  x: number;
  y: number;
  /** "yaw", "pitch", "zoom", "pan_x", "pan_y"; empty where it was not moved. */
  steering?: Record<string, number>;
}

/** Validate the scene as `distal check` does. */
export interface CheckRequest {
  kind: "check";
  /** The app's number of the request, never used twice. */
  id: number;
  /** The app's number of the text, greater after each change. */
  revision: number;
  /** The texts by name: the scene's file and modules beside it. */
  files: Record<string, string>;
  /** The name of the scene's file. */
  main: string;
  /** The name of the object in it; None for the only one. */
  object?: string | null;
  /** The view to show. */
  view?: string;
  /** Values of parameters by name; others have their defaults. */
  values?: Record<string, boolean | number | number[]>;
  /** In seconds. */
  time?: number;
  /** The look to show it in; None for its own. */
  look?: string | null;
  /** How light is computed; None: as the scene says. */
  mode?: "direct" | "path" | null;
  /** The author's frame in pixels. */
  size?: [number, number];
}

/** Give the emitted text of a target, as `distal compile` prints it. */
export interface TextRequest {
  kind: "text";
  /** The app's number of the request, never used twice. */
  id: number;
  /** The app's number of the text, greater after each change. */
  revision: number;
  /** The texts by name: the scene's file and modules beside it. */
  files: Record<string, string>;
  /** The name of the scene's file. */
  main: string;
  /** The name of the object in it; None for the only one. */
  object?: string | null;
  /** The view to show. */
  view?: string;
  /** Values of parameters by name; others have their defaults. */
  values?: Record<string, boolean | number | number[]>;
  /** In seconds. */
  time?: number;
  /** The look to show it in; None for its own. */
  look?: string | null;
  /** How light is computed; None: as the scene says. */
  mode?: "direct" | "path" | null;
  /** The author's frame in pixels. */
  size?: [number, number];
  target?: string;
}

/** Make a file of the scene; `ready` has the formats. */
export interface ExportRequest {
  kind: "export";
  /** The app's number of the request, never used twice. */
  id: number;
  /** The app's number of the text, greater after each change. */
  revision: number;
  /** The texts by name: the scene's file and modules beside it. */
  files: Record<string, string>;
  /** The name of the scene's file. */
  main: string;
  /** The name of the object in it; None for the only one. */
  object?: string | null;
  /** The view to show. */
  view?: string;
  /** Values of parameters by name; others have their defaults. */
  values?: Record<string, boolean | number | number[]>;
  /** In seconds. */
  time?: number;
  /** The look to show it in; None for its own. */
  look?: string | null;
  /** How light is computed; None: as the scene says. */
  mode?: "direct" | "path" | null;
  /** The author's frame in pixels. */
  size?: [number, number];
  /** E.g. "page", "shadertoy", "isf", "wgsl". */
  format: string;
  /** The title of a page; None for the scene's name. */
  title?: string | null;
  /** Whether a page is a fragment for other pages. */
  embed?: boolean;
  /** A PNG in base64 that a page shows first; None for none. */
  poster?: string | null;
}

/** Render a picture or film, with `progress`. */
export interface RenderRequest {
  kind: "render";
  /** The app's number of the request, never used twice. */
  id: number;
  /** The app's number of the text, greater after each change. */
  revision: number;
  /** The texts by name: the scene's file and modules beside it. */
  files: Record<string, string>;
  /** The name of the scene's file. */
  main: string;
  /** The name of the object in it; None for the only one. */
  object?: string | null;
  /** The view to show. */
  view?: string;
  /** Values of parameters by name; others have their defaults. */
  values?: Record<string, boolean | number | number[]>;
  /** In seconds. */
  time?: number;
  /** The look to show it in; None for its own. */
  look?: string | null;
  /** How light is computed; None: as the scene says. */
  mode?: "direct" | "path" | null;
  /** The author's frame in pixels. */
  size?: [number, number];
  /** The name of a format of `choices`. */
  format: string;
  /** Samples of a pixel; None: as `distal render` has it. */
  samples?: number | null;
  /** In mode "path", of a picture: seconds after which no more samples are begun. */
  time_limit?: number | null;
  /** Bits of a channel of a picture; None for the format's own. */
  bits?: number | null;
  /** Whether a picture's background is left out. */
  transparent?: boolean;
  /** How the camera was moved; empty where it was not. */
  steering?: Record<string, number>;
  /** Seconds of a film. */
  duration?: number;
  /** Frames of a film in a second: "30", "29.97", "30000/1001". */
  fps?: string;
  /** Of a lossy film: a name, or a number from 0 to 100; None for the default. */
  quality?: string | null;
  /** Whether a film repeats, where its format says so. */
  loop?: boolean;
}

/** Give the command that renders it. */
export interface CommandRequest {
  kind: "command";
  /** The app's number of the request, never used twice. */
  id: number;
  /** The app's number of the text, greater after each change. */
  revision: number;
  /** The texts by name: the scene's file and modules beside it. */
  files: Record<string, string>;
  /** The name of the scene's file. */
  main: string;
  /** The name of the object in it; None for the only one. */
  object?: string | null;
  /** The view to show. */
  view?: string;
  /** Values of parameters by name; others have their defaults. */
  values?: Record<string, boolean | number | number[]>;
  /** In seconds. */
  time?: number;
  /** The look to show it in; None for its own. */
  look?: string | null;
  /** How light is computed; None: as the scene says. */
  mode?: "direct" | "path" | null;
  /** The author's frame in pixels. */
  size?: [number, number];
  /** The name of a format of `choices`. */
  format: string;
  /** Samples of a pixel; None: as `distal render` has it. */
  samples?: number | null;
  /** In mode "path", of a picture: seconds after which no more samples are begun. */
  time_limit?: number | null;
  /** Bits of a channel of a picture; None for the format's own. */
  bits?: number | null;
  /** Whether a picture's background is left out. */
  transparent?: boolean;
  /** How the camera was moved; empty where it was not. */
  steering?: Record<string, number>;
  /** Seconds of a film. */
  duration?: number;
  /** Frames of a film in a second: "30", "29.97", "30000/1001". */
  fps?: string;
  /** Of a lossy film: a name, or a number from 0 to 100; None for the default. */
  quality?: string | null;
  /** Whether a film repeats, where its format says so. */
  loop?: boolean;
}

/** Tell what `render` can be asked for (local only; the server answers). */
export interface ChoicesRequest {
  kind: "choices";
  /** The app's number of the request, never used twice. */
  id: number;
  /** The app's number of the text, greater after each change. */
  revision: number;
}

/** End a `render` (local only), which is then `dropped`; it has no answer of its own. */
export interface CancelRequest {
  kind: "cancel";
  /** The app's number of the request, never used twice. */
  id: number;
  /** The app's number of the text, greater after each change. */
  revision: number;
  /** The `id` of the render. */
  job: number;
}

/** Write a file (local only; the server answers). */
export interface SaveRequest {
  kind: "save";
  /** The app's number of the request, never used twice. */
  id: number;
  /** The app's number of the text, greater after each change. */
  revision: number;
  /** The file's name. */
  file: string;
  /** Its new text. */
  text: string;
  /** The digest of what it replaces; None or "" for a new file. */
  digest?: string | null;
  /** Whether the file itself is written, not replaced by another: other names of it (hard links) then have the new text, too. */
  in_place?: boolean;
}

/** Say which tab this is (local only; the server answers). */
export interface HelloRequest {
  kind: "hello";
  /** The app's number of the request, never used twice. */
  id: number;
  /** The app's number of the text, greater after each change. */
  revision: number;
  /** The name that the tab had before it was loaded again, or "". */
  tab?: string;
  /** Whether it has no texts yet: then it gets the drafts of tabs that are gone. */
  is_new?: boolean;
}

/** Keep an unsaved text (local only; the server answers). */
export interface DraftRequest {
  kind: "draft";
  /** The app's number of the request, never used twice. */
  id: number;
  /** The app's number of the text, greater after each change. */
  revision: number;
  /** The file's name. */
  file: string;
  /** The text; None where the file on the disk has it. */
  text: string | null;
  /** The digest of the text on the disk that it began with; "" for a new file. */
  digest?: string;
}

/** List the versions of a file that are kept (local only; the server answers). */
export interface VersionsRequest {
  kind: "versions";
  /** The app's number of the request, never used twice. */
  id: number;
  /** The app's number of the text, greater after each change. */
  revision: number;
  file: string;
}

/** Give the text of a version (local only; the server answers). */
export interface VersionRequest {
  kind: "version";
  /** The app's number of the request, never used twice. */
  id: number;
  /** The app's number of the text, greater after each change. */
  revision: number;
  file: string;
  version: string;
}

/** End the worker; it answers nothing. */
export interface StopRequest {
  kind: "stop";
  /** The app's number of the request, never used twice. */
  id: number;
  /** The app's number of the text, greater after each change. */
  revision: number;
}

/** The first message of a worker. */
export interface Ready {
  kind: "ready";
  /** The kinds of requests that it answers. */
  abilities: string[];
  /** By name: "distal", "python", "payload", "messages". */
  versions: Record<string, string>;
  /** The targets of `text`. */
  targets: string[];
  /** The formats of `export`. */
  formats: string[];
}

/** A compiled view: the payload of a player, with its program. */
export interface SceneFound {
  kind: "scene";
  id: number;
  revision: number;
  /** Names the program: equal keys, equal programs. */
  key: string;
  /** None where the request was lean. */
  literals: SourceLiteral[] | null;
  /** None where the request was lean. */
  shapes: ShapePlace[] | null;
  /** The edits of the request's changes. */
  edits: Edit[];
  /** Milliseconds of work by stage: "load", "compile", "literals", "all". */
  ms: Record<string, number>;
  /** For `player.load(payload)`. It has the programs of `view` and of the camera's guide; `views` lists all views, with program -1 for those that are not there. */
  payload: Payload;
  /** The names of the pictures in the file, which `object` can select. */
  objects: string[];
  /** For `hold`: the name of the input; else None. */
  held: string | null;
}

/** The program is the one the app has; these are its new numbers. */
export interface NumbersFound {
  kind: "numbers";
  id: number;
  revision: number;
  /** Names the program: equal keys, equal programs. */
  key: string;
  /** None where the request was lean. */
  literals: SourceLiteral[] | null;
  /** None where the request was lean. */
  shapes: ShapePlace[] | null;
  /** The edits of the request's changes. */
  edits: Edit[];
  /** Milliseconds of work by stage: "load", "compile", "literals", "all". */
  ms: Record<string, number>;
  /** The new values of the program's inputs of origin "number", by their `name`: for `player.setNumber(name, value)`. */
  numbers: Record<string, UniformEntry["default"]>;
  /** The declarations of all parameters, as in the payload. */
  parameters: Parameter[];
}

/** The author's code has mistakes, or the request cannot be done; at least one. */
export interface Mistakes {
  kind: "mistakes";
  id: number;
  revision: number;
  mistakes: Mistake[];
  literals: SourceLiteral[] | null;
  edits: Edit[];
}

/** The result of each kind of request that is answered by `answer`. */
export interface Results {
  write: Written;
  count: Counting;
  time: LineTiming;
  map: ShapeMap;
  probe: ProbeResult;
  check: Checked;
  text: EmittedText;
  export: ExportedFile;
  render: Rendered;
  command: Planned;
  choices: RenderChoices;
  save: Saved;
  hello: Greeted;
  draft: DraftAnswer;
  versions: VersionList;
  version: VersionText;
}

/** The result of a request; `request` is its kind. */
export type Answer = {
  [K in keyof Results]: { kind: "answer"; id: number; revision: number; request: K; result: Results[K] };
}[keyof Results];

/** A newer request made this one useless; it was not done. */
export interface Dropped {
  kind: "dropped";
  id: number;
  revision: number;
}

/** What the author's code printed, or where it is after some seconds. */
export interface Printed {
  kind: "printed";
  id: number;
  revision: number;
  /** The text. */
  text: string;
  /** The line that it is at after some seconds, else nothing. */
  hangs: string;
}

/** How much of a long request is done. */
export interface Progress {
  kind: "progress";
  id: number;
  revision: number;
  /** From 0 to 1, of what `label` names. */
  done: number;
  /** What is done now: "waiting", "loading", "compiling", "rendering", "encoding". */
  label: string;
  /** Figures for people: "12 of 60 frames". */
  text: string;
  /** Seconds that are left of it, if that is known. */
  remaining_s: number | null;
}

/** How files are on the disk (local only; from the server): all at first, then what changes. */
export interface Changed {
  kind: "changed";
  /** The texts by name; of a file with a problem the last one that it had. */
  files: Record<string, string>;
  /** Of these texts; "" for those that are not on the disk yet. */
  digests: Record<string, string>;
  /** Of files that have no text now. */
  problems: Record<string, DiskProblem>;
  /** Grows with each change: an older message says nothing of newer ones. */
  order: number;
}

/** The worker did not answer and was replaced (from the carrier); `id` is not answered. */
export interface Restarted {
  kind: "restarted";
  id: number | null;
  reason: string;
}

export type Request = LookRequest | HoldRequest | WriteRequest | CountRequest | TimeRequest | MapRequest | ProbeRequest | CheckRequest | TextRequest | ExportRequest | RenderRequest | CommandRequest | ChoicesRequest | CancelRequest | SaveRequest | HelloRequest | DraftRequest | VersionsRequest | VersionRequest | StopRequest;

export type Response = Ready | SceneFound | NumbersFound | Mistakes | Answer | Dropped | Printed | Progress | Changed | Restarted;
