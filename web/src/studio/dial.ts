/**
 * What changes one literal: a slider and a field for a number, a picker for a color, a switch, a menu.
 *
 * Input: a literal. Output: an element; `give` is called with each new value, `done` when a hand lets go.
 */

import { hexOf, linearOf } from "../color";
import { make } from "../dom";
import type { LiteralValue, SourceLiteral } from "../generated/messages";
import { shown } from "../numbers";
import { clamp } from "../values";

export interface Dial {
  element: HTMLElement;
  /** The literal has another place or value. */
  update(literal: SourceLiteral): void;
}

export interface Turned {
  give(value: LiteralValue): void;
  done(): void;
}

/** Positions of a slider to each side of a number without limits. */
const REACH = 100;

export function dialOf(literal: SourceLiteral, turned: Turned): Dial {
  const name = [literal.call, literal.slot].filter(Boolean).join(" · ") || "Value";
  const body = BODIES[literal.type](literal, turned);
  const title = make("span", { className: "dial-name" }, name);
  const element = make("div", { className: `dial ${literal.type}`, role: "group" }, title, ...body.parts);
  element.setAttribute("aria-label", name);
  element.onkeydown = (event) => {
    // Arrows and letters are the controls', not the editor's.
    if (event.key !== "Escape") event.stopPropagation();
  };
  return {
    element,
    update: body.show,
  };
}

interface Body {
  parts: HTMLElement[];
  show(literal: SourceLiteral): void;
}

const BODIES: Record<SourceLiteral["type"], (literal: SourceLiteral, turned: Turned) => Body> = {
  number: (literal, turned) => {
    const row = numberRow(literal, literal.value as number, "", turned.give, turned.done);
    return { parts: [row.element], show: ({ value }) => row.show(value as number) };
  },
  vector: (literal, turned) => {
    let now = [...(literal.value as number[])];
    const rows = now.map((value, i) =>
      numberRow(
        literal,
        value,
        "xyzw"[i]!,
        (part) => turned.give((now = now.with(i, part))),
        turned.done,
      ),
    );
    return {
      parts: rows.map(({ element }) => element),
      show({ value }) {
        now = [...(value as number[])];
        rows.forEach((row, i) => row.show(now[i]!));
      },
    };
  },
  color: (literal, turned) => {
    const isHex = typeof literal.value === "string";
    const picker = make("input", { type: "color", "aria-label": "Color" });
    const text = make("input", { type: "text", maxLength: 7, spellcheck: false });
    text.setAttribute("aria-label", "Color, hexadecimal");
    const show = ({ value }: SourceLiteral) => {
      const linear = typeof value === "string" ? linearOf(value) : (value as number[]);
      picker.value = hexOf(linear ?? [0, 0, 0]);
      text.value = picker.value;
    };
    const give = (hex: string) => turned.give(isHex ? hex : linearOf(hex)!);
    picker.oninput = () => {
      text.value = picker.value;
      give(picker.value);
    };
    picker.onchange = turned.done;
    text.onchange = () => {
      const linear = linearOf(text.value);
      if (linear) {
        picker.value = hexOf(linear);
        give(picker.value);
        turned.done();
      }
      text.value = picker.value;
    };
    show(literal);
    return { parts: [make("div", { className: "dial-row" }, picker, text)], show };
  },
  switch: (literal, turned) => {
    const field = make("input", { type: "checkbox", role: "switch", "aria-label": literal.slot });
    field.onchange = () => {
      turned.give(field.checked);
      turned.done();
    };
    const show = ({ value }: SourceLiteral) => {
      field.checked = value as boolean;
    };
    show(literal);
    return { parts: [make("div", { className: "dial-row" }, field)], show };
  },
  choice: (literal, turned) => {
    const words = literal.options.length ? literal.options : [String(literal.value)];
    const field = make("select", { "aria-label": literal.slot });
    field.append(...words.map((word) => make("option", { value: word }, word)));
    field.onchange = () => {
      turned.give(field.value);
      turned.done();
    };
    const show = ({ value }: SourceLiteral) => {
      field.value = String(value);
    };
    show(literal);
    return { parts: [make("div", { className: "dial-row" }, field)], show };
  },
};

/** The ends of a slider: the literal's limits, else some way to both sides of the value. */
export function rangeOf(literal: SourceLiteral, value: number): [low: number, high: number] {
  const { low, high, step } = literal;
  const reach = Math.max(2 * Math.abs(value), REACH * step);
  const first = low ?? (high !== null ? Math.min(value - reach, high - reach) : value - reach);
  const last = high ?? (low !== null ? Math.max(low + reach, value + reach) : value + reach);
  return [first, last];
}

function numberRow(
  literal: SourceLiteral,
  first: number,
  axis: string,
  give: (value: number) => void,
  done: () => void,
) {
  let now = first;
  let { step } = literal;
  const slider = make("input", { type: "range", "aria-label": axis || literal.slot || "Value" });
  const field = make("input", { type: "number", step: "any" });
  field.setAttribute("aria-label", `${axis || literal.slot || "Value"}, number`);
  const show = (value: number, isRanged = true) => {
    now = value;
    if (isRanged) {
      const [low, high] = rangeOf(literal, value);
      Object.assign(slider, { min: String(low), max: String(high), step: String(step) });
    }
    slider.valueAsNumber = value;
    if (document.activeElement !== field) field.value = shown(value);
  };
  const take = (value: number) => {
    const { low, high, whole } = literal;
    const fit = clamp(whole ? Math.round(value) : value, low ?? -Infinity, high ?? Infinity);
    if (!Number.isFinite(fit)) return;
    show(fit, false);
    give(fit);
  };
  // A slider's own steps begin at its low end: values are rounded to the step's multiples.
  slider.oninput = () => take(rounded(slider.valueAsNumber, step));
  slider.onchange = done;
  field.onchange = () => {
    if (field.value !== "") take(field.valueAsNumber);
    field.value = shown(now);
    done();
  };
  const nudge = (by: number) => () => {
    take(rounded(now + by * step, step));
    done();
  };
  const less = make("button", { type: "button", onclick: nudge(-1), "aria-label": "Less" }, "−");
  const more = make("button", { type: "button", onclick: nudge(1), "aria-label": "More" }, "+");
  const label = axis ? make("span", { className: "axis", "aria-hidden": "true" }, axis) : "";
  show(first);
  return {
    element: make("div", { className: "dial-row" }, label, less, slider, more, field),
    show(value: number) {
      step = literal.step;
      show(value);
    },
  };
}

/** The nearest multiple of a step, without the dust of binary fractions. */
export function rounded(value: number, step: number): number {
  const digits = Math.max(0, Math.min(15, Math.ceil(-Math.log10(step) - 1e-9)));
  return Number((Math.round(value / step) * step).toFixed(digits));
}
