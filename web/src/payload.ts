/**
 * What a page says of a scene: the types of the payload, and how its programs are unpacked.
 *
 * Input: the JSON that `distal export` writes. Output: plain objects. The one place that knows the format.
 */

export type Value = number | boolean | number[];
export type Values = Record<string, Value>;

export interface Parameter {
  name: string;
  label: string;
  kind: "slider" | "integer" | "toggle" | "choice" | "color" | "point";
  default: Value;
  low: number | null;
  high: number | null;
  step: number | null;
  log: boolean;
  group: string;
  help: string;
  options: string[];
}

/** Lines `first` to `last` of a text, from 1, come from line `line` of file number `file`. */
export type LineRange = [first: number, last: number, file: number, line: number];

export interface UniformEntry {
  name: string;
  uniform: string;
  type: string;
  origin: "frame" | "parameter" | "number";
  default: Value | number[][] | null;
}

export interface TextureEntry {
  name: string;
  uniform: string;
  type: string;
  wrap: string;
}

export interface BufferEntry {
  name: string;
  uniform: string;
  count: string;
  element: string;
}

export interface Program {
  vertex: string;
  fragment: string;
  uniforms: UniformEntry[];
  textures: TextureEntry[];
  buffers: BufferEntry[];
  /** What to define for the driver's own built-in in place of the fragment's careful one. */
  trust: Record<string, string>;
  lines: LineRange[];
  vertex_lines: LineRange[];
  /** Its light by random paths; left out where that is not wanted. */
  film?: FilmPrograms | undefined;
  /** What is drawn before it in each frame; left out where nothing is kept. */
  frames?: FrameProgram | undefined;
}

/** A buffer, or a picture that is read in the next frame, and the texture that it draws. */
export interface FramePass {
  program: Program;
  name: string;
}

/** What a picture reads that changes with each frame. */
export interface FrameProgram {
  passes: FramePass[];
  itself: FramePass | null;
  /** The texture that is the keyboard. */
  keyboard: string | null;
  /** The texture that is the microphone. */
  microphone: string | null;
  /** Sounds from files. */
  sounds: SoundEntry[];
  /** Textures that a person replaces. */
  images: ImageInput[];
}

export interface SoundEntry {
  name: string;
  loop: boolean;
  /** Its texels, 60 rows a second: packed, in base64. */
  rows: string;
  /** The file in base64. */
  file: string;
}

export interface ImageInput {
  name: string;
  wrap: string;
}

/** The programs of a film: one adds samples to it, one shows it. */
export interface FilmPrograms {
  trace: Program;
  show: Program;
  /** The texture that is the film. */
  name: string;
  /** Of a scene whose caustics photons find. */
  photons?: PhotonPrograms;
}

/** The programs of photons: one says what a pass depends on, one traces them. */
export interface PhotonPrograms {
  plan: Program;
  deposits: Program;
  /** The buffers that the paths read: places, arrivals, starts. */
  tables: string[];
  /** Photons for each pixel, and the least and most of them. */
  of_sample: number;
  fewest: number;
  most: number;
}

export type Format = "rgba8" | "float16" | "float32" | "int32" | "uint32";

export interface Resource {
  type: string;
  size: number[];
  components: number;
  /** One number stands for all components. */
  grey?: true;
  format: Format;
  data: string;
  /** Whether they are compressed, as in pages. */
  packed?: true;
}

export interface View {
  name: string;
  label: string;
  program: number;
  /** The numbers of the programs of its film, where its light is that of random paths. */
  film?: {
    trace: number;
    show: number;
    name: string;
    photons?: Omit<PhotonPrograms, "plan" | "deposits"> & { plan: number; deposits: number };
  };
}

/** How a scene's camera is written as Python. */
export interface CameraForm {
  name: string;
  mirror: boolean;
  /** The argument that sets how much it sees. */
  extent: "fov_deg" | "height" | "";
}

export interface Payload {
  format: number;
  name: string;
  /** What stands before and after the arguments of `render` in the line that is copied. */
  code?: [string, string];
  description: string;
  size: [number, number];
  embed: boolean;
  panel: boolean;
  /** Of a scene's camera: `guide` is the number of its guide's program, -1 if there is none. */
  steering: { elevation: number; guide?: number; camera?: CameraForm } | null;
  time: { start: number; duration: number | null; animated: boolean };
  parameters: Parameter[];
  values: Values;
  views: View[];
  /** Of a picture that keeps frames: the numbers of its programs, in the order of drawing. */
  frames?: {
    passes: { program: number; name: string }[];
    itself: { program: number; name: string } | null;
    keyboard: string | null;
    microphone: string | null;
    sounds: SoundEntry[];
    images: ImageInput[];
  };
  /** Which of the views is shown first. */
  view: string;
  poster: string | null;
  files: string[];
  programs: { encoding: "plain"; data: Program[] } | { encoding: "deflate-raw"; data: string };
  resources: Record<string, Resource>;
}

/** The bytes of a base64 text. */
export function bytesOf(base64: string): Uint8Array<ArrayBuffer> {
  return Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
}

/** What was compressed, from a base64 text. */
export function inflated(base64: string): Response {
  const packed = new Blob([bytesOf(base64)]).stream();
  return new Response(packed.pipeThrough(new DecompressionStream("deflate-raw")));
}

const unpacked = new WeakMap<Resource, ArrayBuffer>();

/** The numbers of a resource of a payload whose programs are known. */
export function numbersIn(resource: Resource): ArrayBuffer {
  return unpacked.get(resource) ?? bytesOf(resource.data).buffer;
}

/**
 * The programs of a payload, unpacked where they came packed: field by field, and texts as the
 * numbers of their parts, which programs share. The numbers of resources are unpacked, too.
 */
export async function programsOf(payload: Payload): Promise<Program[]> {
  const { programs } = payload;
  for (const resource of Object.values(payload.resources)) {
    if (!resource.packed || unpacked.has(resource)) continue;
    unpacked.set(resource, await inflated(resource.data).arrayBuffer());
  }
  if (programs.encoding === "plain") return programs.data;
  const { parts, ...columns } = (await inflated(programs.data).json()) as Packed;
  const joined = (numbers: number[]) => numbers.map((n) => parts[n]).join("");
  return columns.vertex.map((vertex, i) => {
    const fields = Object.entries(columns).map(([key, all]) => [key, all[i]]);
    const fragment = joined(columns.fragment[i]!);
    return { ...Object.fromEntries(fields), vertex: joined(vertex), fragment } as Program;
  });
}

type Packed = { parts: string[]; vertex: number[][]; fragment: number[][] } & {
  [K in Exclude<keyof Program, "vertex" | "fragment">]: Program[K][];
};
