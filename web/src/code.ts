/** The state of a page as Python: what to hand to `render` for the same picture. Pure. */

import { hexOf, linearOf } from "./color";
import type { Steering } from "./camera";
import { rounded } from "./generated/interaction";
import type { Guided } from "./guide";
import { shown } from "./numbers";
import type { CameraForm, Parameter, Value, Values } from "./payload";
import { same } from "./values";

/** A Python literal of a number; -0 and integers stay what they are. */
function number(value: number): string {
  return String(+value.toPrecision(7));
}

/** A Python literal of a text: JSON's is one. */
function text(value: string): string {
  return JSON.stringify(value);
}

function tuple(values: readonly number[]): string {
  return `(${values.map(number).join(", ")})`;
}

function literal(parameter: Parameter, value: Value): string {
  if (parameter.kind === "toggle") return value ? "True" : "False";
  if (parameter.kind === "choice") return text(parameter.options[value as number] ?? "");
  if (!Array.isArray(value)) return number(value as number);
  if (parameter.kind === "color") {
    // A color that the picker can say is said as people say it.
    const hex = hexOf(value);
    if (linearOf(hex)!.every((light, i) => Math.abs(light - value[i]!) < 1e-6)) return text(hex);
  }
  return tuple(value);
}

function point(numbers: readonly number[], unit: number): string {
  return `(${numbers.map((n) => shown(rounded(n, unit))).join(", ")})`;
}

/** A camera's position and target as Python, rounded to a ten-thousandth of their distance. */
export function pointsOf(place: Guided): [position: string, target: string] {
  const { eyeX, eyeY, eyeZ, targetX, targetY, targetZ } = place;
  const away = Math.hypot(targetX - eyeX, targetY - eyeY, targetZ - eyeZ);
  const unit = 0.1 * Math.max(away, 1e-6);
  return [point([eyeX, eyeY, eyeZ], unit), point([targetX, targetY, targetZ], unit)];
}

/** A camera at a place as Python. */
export function cameraOf(place: Guided, { name, mirror, extent }: CameraForm): string {
  const { upX, upY, upZ, opening, height } = place;
  const parts: string[] = pointsOf(place);
  if (upX || upZ || upY !== 1) parts.push(`up=${point([upX, upY, upZ], 0.1)}`);
  if (extent === "fov_deg") parts.push(`fov_deg=${shown(rounded(opening, 10))}`);
  if (extent === "height") {
    parts.push(`height=${shown(rounded(height, 0.1 * Math.max(height, 1e-6)))}`);
  }
  if (mirror) parts.push("mirrored=True");
  return `${name}(${parts.join(", ")})`;
}

/** `params={...}` of the parameters that are not at their defaults, and the other arguments. */
export function pythonOf(
  parameters: readonly Parameter[],
  values: Values,
  time: number,
  view: string,
  steering: Steering | null,
): string {
  const changed = parameters.filter(({ name, default: fallback }) => !same(values[name], fallback));
  const rows = changed.map((p) => `${text(p.name)}: ${literal(p, values[p.name]!)}`);
  const parts = [`params={${rows.join(", ")}}`];
  const seconds = number(+time.toFixed(3));
  if (seconds !== "0") parts.push(`time=${seconds}`);
  if (view !== "color") parts.push(`view=${text(view)}`);
  if (steering) {
    const { yaw, pitch, zoom, pan } = steering;
    const said = [
      yaw && `yaw=${number(+yaw.toFixed(4))}`,
      pitch && `pitch=${number(+pitch.toFixed(4))}`,
      zoom !== 1 && `zoom=${number(+zoom.toFixed(4))}`,
      (pan[0] || pan[1]) && `pan=${tuple(pan.map((p) => +p.toFixed(4)))}`,
    ].filter(Boolean);
    parts.push(`steering=distal.Steering(${said.join(", ")})`);
  }
  return parts.join(", ");
}
