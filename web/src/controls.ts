/**
 * A parameter as a row of the panel: label, field, slider, what it does, its own reset.
 *
 * Input: a parameter. Output: an element, and `show` for values that came from elsewhere. A row reports
 * what a person did through `give`; it does not keep the value.
 */

import { hexOf, linearOf } from "./color";
import { ICONS, icon, make, rename } from "./dom";
import { POINT_STEP } from "./generated/interaction";
import { shown } from "./numbers";
import type { Parameter, Value } from "./payload";
import { checked, positionCount, positionOf, same, valueAt } from "./values";

export interface Row {
  element: HTMLElement;
  show(value: Value): void;
}

/** The control in a row, next to its label and reset button. */
interface Control {
  /** Beside the label. */
  field: HTMLElement;
  /** Beneath, over the whole width. */
  wide?: HTMLElement;
  show(value: Value): void;
}

type Give = (value: Value) => void;

let count = 0;

export function rowOf(parameter: Parameter, give: Give): Row {
  const { label, help, kind, default: fallback } = parameter;
  const id = `c${++count}`;
  const giveChecked = (value: unknown) => {
    const fit = checked(parameter, value);
    if (fit !== null) give(fit);
  };
  const control = CONTROLS[kind](parameter, id, giveChecked);
  const reset = make("button", { type: "button", className: "icon undo" }, icon(ICONS.reset));
  rename(reset, `Reset ${label}`);
  reset.onclick = () => {
    give(fallback);
    (control.wide ?? control.field).focus(); // The button disappears; the focus must not.
  };
  const isGroup = kind === "point";
  const name = make(isGroup ? "span" : "label", { className: "label", id: `${id}l` }, label);
  if (!isGroup) name.setAttribute("for", id);
  const hint = help && make("p", { className: "hint", id: `${id}h` }, help);
  const element = make("div", { className: `row ${kind}` }, name, reset, control.field);
  if (control.wide) element.append(control.wide);
  if (hint) {
    element.append(hint);
    for (const input of element.querySelectorAll("input, select")) {
      input.setAttribute("aria-describedby", hint.id);
    }
  }
  return {
    element,
    show(value) {
      control.show(value);
      reset.classList.toggle("idle", same(value, fallback));
    },
  };
}

const CONTROLS: Record<Parameter["kind"], (p: Parameter, id: string, give: Give) => Control> = {
  slider: numeric,
  integer: numeric,
  toggle: switched,
  choice: chosen,
  color: colored,
  point: placed,
};

/** A number field that leaves alone what is just being typed. */
function numberField(properties: Record<string, unknown>, give: (value: number) => void) {
  const field = make("input", { type: "number", className: "number", ...properties });
  field.oninput = () => {
    if (field.value !== "") give(field.valueAsNumber);
  };
  const show = (value: number, isDone = false) => {
    const isTyping = !isDone && field.matches(":focus") && field.value !== "";
    if (!isTyping || field.valueAsNumber !== value) field.value = shown(value);
  };
  return { field, show };
}

function numeric(parameter: Parameter, id: string, give: Give): Control {
  const { label, low, high, step, kind } = parameter;
  let now = parameter.default as number;
  const wide = make("input", { type: "range", id, min: 0, max: positionCount(parameter), step: 1 });
  wide.oninput = () => give(valueAt(parameter, wide.valueAsNumber));
  const { field, show } = numberField(
    { min: low, max: high, step: step ?? (kind === "integer" ? 1 : "any") },
    (value) => {
      // While one types "15", the "1" may lie below the range: only what fits is taken.
      if (value >= low! && value <= high!) give(value);
    },
  );
  field.setAttribute("aria-label", label);
  field.onchange = () => {
    if (field.value !== "") give(field.valueAsNumber);
    show(now, true);
  };
  return {
    field,
    wide,
    show(value) {
      now = value as number;
      const position = positionOf(parameter, now);
      wide.valueAsNumber = Math.round(position);
      wide.style.setProperty("--part", `${(100 * position) / positionCount(parameter)}%`);
      wide.setAttribute("aria-valuetext", shown(now));
      // A text half typed and out of range stays until it is done.
      if (!field.matches(":focus") || field.validity.valid || field.value === "") show(now);
    },
  };
}

function switched(_: Parameter, id: string, give: Give): Control {
  const field = make("input", { type: "checkbox", role: "switch", id });
  field.onchange = () => give(field.checked);
  return { field, show: (value) => (field.checked = value as boolean) };
}

function chosen({ options }: Parameter, id: string, give: Give): Control {
  const items = options.map((text, i) => make("option", { value: String(i) }, text));
  const field = make("select", { id }, ...items);
  field.onchange = () => give(+field.value);
  return { field, show: (value) => (field.value = String(value)) };
}

function colored({ label }: Parameter, id: string, give: Give): Control {
  const picker = make("input", { type: "color", id });
  const text = make("input", { type: "text", className: "hex", maxLength: 7, spellcheck: false });
  text.setAttribute("aria-label", `${label}, hexadecimal`);
  picker.oninput = () => give(linearOf(picker.value)!);
  let hex = "";
  text.oninput = () => {
    // "#abc" is a color, and the beginning of others: taken when one is done.
    const linear = text.value.length > 5 && linearOf(text.value);
    if (linear) give(linear);
  };
  text.onchange = () => {
    const linear = linearOf(text.value);
    if (linear) give(linear);
    text.value = hex;
  };
  return {
    field: make("span", { className: "pair" }, text, picker),
    show(value) {
      hex = picker.value = hexOf(value as number[]);
      if (!text.matches(":focus")) text.value = hex;
    },
  };
}

function placed({ label, default: fallback }: Parameter, id: string, give: Give): Control {
  let now = fallback as number[];
  const fields = now.map((_, axis) => {
    const made = numberField({ step: POINT_STEP }, (value) => give(now.with(axis, value)));
    made.field.setAttribute("aria-label", `${label} ${"xyz"[axis]}`);
    made.field.onchange = () => made.show(now[axis]!, true);
    return made;
  });
  const axes = fields.map(({ field }, axis) =>
    make("span", { className: "axis" }, make("span", { "aria-hidden": true }, "xyz"[axis]!), field),
  );
  const wide = make("div", { className: "axes", role: "group" }, ...axes);
  wide.setAttribute("aria-labelledby", `${id}l`);
  return {
    field: make("span"),
    wide,
    show(value) {
      now = value as number[];
      fields.forEach((made, axis) => made.show(now[axis]!));
    },
  };
}
