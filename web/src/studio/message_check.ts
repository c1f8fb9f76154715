/**
 * What comes out of the playground's cell, checked: a stranger's code may have written it.
 *
 * Input: a JSON value. Output: where it is not what a worker sends, or null. The forms of messages are
 * those that the worker and the payload declare (`tools/gen_forms.py`); here stands besides what numbers
 * and names must be for a player to show a payload.
 */

import { FORMS, OF_WORKER, RESULTS, type Form, type FormRecord } from "../generated/forms";
import type { Answer, Response } from "../generated/messages";
import type { Parameter, Payload, Program, Resource, View } from "../payload";
import { checked } from "../values";

/** Items of a list, at most: more would hold up the page. */
const MOST_ITEMS = 200_000;
const MOST_PARAMETERS = 10_000;
const MOST_CHOICES = 1000;
const LONGEST_SIDE_PX = 65_536;
const LARGEST_RESOURCE = 2 ** 28;
const BYTES = { rgba8: 1, float16: 2, float32: 4, int32: 4, uint32: 4 };

/** Where a value is no message of a worker; null where it is one. */
export function faultOf(found: unknown): string | null {
  const kind = isObject(found) && found["kind"];
  if (typeof kind !== "string" || !OF_WORKER.includes(kind)) return "kind";
  const message = found as Response;
  const fault = misfit(kind, message, kind);
  if (fault) return fault;
  if (message.kind === "answer") return resultFault(message);
  if (message.kind === "mistakes") return message.mistakes.length ? null : "mistakes.mistakes";
  if (message.kind === "numbers") return parametersFault(message.parameters);
  if (message.kind !== "scene") return null;
  return message.objects.length > MOST_CHOICES ? "scene.objects" : payloadFault(message.payload);
}

// Forms

function isObject(value: unknown): value is Record<string, unknown> {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

const PLAIN: Record<string, (value: unknown) => boolean> = {
  s: (value) => typeof value === "string",
  n: (value) => Number.isFinite(value),
  i: (value) => Number.isSafeInteger(value),
  b: (value) => typeof value === "boolean",
  "0": (value) => value === null,
  "*": () => true,
};

/** The place in a value that has another form; null where the whole has it. */
function misfit(form: Form | FormRecord, value: unknown, path: string): string | null {
  if (typeof form === "string") {
    const isPlain = PLAIN[form];
    return isPlain ? (isPlain(value) ? null : path) : misfit(FORMS[form]!, value, path);
  }
  if (!Array.isArray(form)) return recordMisfit(form as FormRecord, value, path);
  const [kind, ...rest] = form as [string, ...unknown[]];
  const inner = rest as Form[];
  if (kind === "r") return recordMisfit(inner[0] as unknown as FormRecord, value, path);
  if (kind === "=") return rest.includes(value) ? null : path;
  if (kind === "|") {
    const faults = inner.map((one) => misfit(one, value, path));
    // The deepest place: a record with one wrong field, not a value of another type.
    return faults.includes(null) ? null : faults.reduce((a, b) => (b!.length > a!.length ? b : a))!;
  }
  if (kind === "{}") {
    if (!isObject(value) || Object.hasOwn(value, "__proto__")) return path;
    return first(Object.entries(value), ([key, one]) => misfit(inner[0]!, one, `${path}.${key.slice(0, 40)}`));
  }
  if (!Array.isArray(value) || value.length > MOST_ITEMS) return path;
  if (kind === "()" && value.length !== inner.length) return path;
  return first(value, (one, i) => misfit(inner[kind === "()" ? i : 0]!, one, `${path}[${i}]`));
}

function recordMisfit(record: FormRecord, value: unknown, path: string): string | null {
  if (!isObject(value) || Object.hasOwn(value, "__proto__")) return path;
  return first(Object.entries(record), ([field, form]) => {
    const name = field.replace("?", "");
    if (Object.hasOwn(value, name)) return misfit(form, value[name], `${path}.${name}`);
    return name === field ? `${path}.${name}` : null;
  });
}

/** The first fault of some items. */
function first<T>(items: readonly T[], fault: (item: T, i: number) => string | null): string | null {
  for (let i = 0; i < items.length; i++) {
    const found = fault(items[i]!, i);
    if (found) return found;
  }
  return null;
}

// What a player needs besides

function resultFault({ request, result }: Answer): string | null {
  const path = "answer.result";
  if (!Object.hasOwn(RESULTS, request)) return "answer.request";
  const fault = misfit(RESULTS[request]!, result, path);
  if (fault || !("program" in result)) return fault;
  return programFault(result.program, `${path}.program`);
}

function payloadFault({ frames, parameters, programs, resources, size, steering, time, view, views }: Payload): string | null {
  const path = "scene.payload";
  if (programs.encoding !== "plain") return `${path}.programs`;
  const { data } = programs;
  const isThere = (number: number) => Number.isInteger(number) && number >= 0 && number < data.length;
  const isSize = (side: number) => Number.isInteger(side) && side >= 1 && side <= LONGEST_SIDE_PX;
  if (!size.every(isSize)) return `${path}.size`;
  if (time.duration !== null && time.duration <= 0) return `${path}.time`;
  const { guide = -1 } = steering ?? {};
  if (guide !== -1 && !isThere(guide)) return `${path}.steering`;
  const kept = [...(frames?.passes ?? []), ...(frames?.itself ? [frames.itself] : [])];
  if (!kept.every(({ program }) => isThere(program))) return `${path}.frames`;
  return (
    viewsFault(views, view, isThere) ??
    parametersFault(parameters) ??
    first(data, (program, i) => programFault(program, `${path}.programs[${i}]`)) ??
    first(Object.entries(resources), ([name, one]) => (isWhole(one) ? null : `${path}.resources.${name}`))
  );
}

function viewsFault(views: View[], shown: string, isThere: (number: number) => boolean): string | null {
  const path = "scene.payload.views";
  if (views.length > MOST_CHOICES || new Set(views.map(({ name }) => name)).size < views.length) return path;
  const isDrawn = views.some(({ name, program }) => name === shown && isThere(program));
  if (!isDrawn) return path;
  return first(views, ({ film, program }, i) => {
    const { deposits, plan } = film?.photons ?? {};
    const numbers = [program, film?.trace, film?.show, deposits, plan];
    return numbers.every((n, at) => n === undefined || (n === -1 && !at) || isThere(n)) ? null : `${path}[${i}]`;
  });
}

function parametersFault(parameters: readonly Parameter[]): string | null {
  const path = "parameters";
  if (parameters.length > MOST_PARAMETERS) return path;
  if (new Set(parameters.map(({ name }) => name)).size < parameters.length) return path;
  return first(parameters, (parameter, i) => (isParameter(parameter) ? null : `${path}[${i}]`));
}

function isParameter(parameter: Parameter): boolean {
  const { default: fallback, high, kind, log, low, name, options, step } = parameter;
  const size = Array.isArray(fallback) ? fallback.length : 0;
  if (name === "__proto__" || options.length > MOST_CHOICES) return false;
  if (kind === "color" && size !== 3) return false;
  if (kind === "point" && size !== 2 && size !== 3) return false;
  if (kind === "choice" && !options.length) return false;
  if (kind === "slider" || kind === "integer") {
    if (low === null || high === null || low >= high || (log && low <= 0)) return false;
    if (step !== null && step <= 0) return false;
  }
  return checked(parameter, fallback) !== null;
}

const UNIFORM = /^(float|u?int|bool|[iub]?vec[234]|mat[234])$/;

function programFault({ film, frames, uniforms }: Program, path: string): string | null {
  // They are put together here, of the payload's programs.
  if (film || frames) return path;
  return first(uniforms, ({ type }, i) => (UNIFORM.test(type) ? null : `${path}.uniforms[${i}]`));
}

/** Whether a resource has as many bytes as its size says. */
function isWhole({ components, data, format, grey, packed, size, type }: Resource): boolean {
  if (packed) return false; // Only pages are.
  const sides = [...size, type === "TextureCube" ? 6 : 1];
  const count = sides.reduce((all, side) => all * side, 1);
  const isSize = sides.every((side) => Number.isInteger(side) && side >= 0) && size.length >= 1 && size.length <= 3;
  if (!isSize || count > LARGEST_RESOURCE || ![1, 2, 3, 4].includes(components)) return false;
  const padding = /=*$/.exec(data.slice(-2))![0].length;
  const bytes = (data.length / 4) * 3 - padding;
  return bytes === count * (grey ? 1 : components) * BYTES[format];
}
