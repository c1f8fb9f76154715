/**
 * The literals of the code that can be turned: their marks, the dial over one of them, drags of numbers.
 *
 * Input: the literals that the worker found. Output: an extension of the editor. Marks follow the text
 * until the next literals come; the dial stays open while its literal is rewritten.
 */

import { StateEffect, StateField, type EditorState, type Extension } from "@codemirror/state";
import {
  Decoration,
  EditorView,
  WidgetType,
  keymap,
  showTooltip,
  type DecorationSet,
  type Tooltip,
} from "@codemirror/view";
import { make } from "../dom";
import type { LiteralValue, SourceLiteral } from "../generated/messages";
import { dialOf, type Dial } from "./dial";

export interface Turning {
  turn(literal: SourceLiteral, value: LiteralValue): void;
  release(): void;
}

/** A press that moves farther is a drag. */
const CLICK_PX = 4;
/** A drag so far is one step of the number. */
const STEP_PX = 4;

export const setLiterals = StateEffect.define<readonly SourceLiteral[]>();
const openDial = StateEffect.define<SourceLiteral | null>();

class Swatch extends WidgetType {
  constructor(readonly color: string) {
    super();
  }

  override eq(other: Swatch): boolean {
    return other.color === this.color;
  }

  toDOM(): HTMLElement {
    const made = make("span", { className: "swatch", "aria-hidden": "true" });
    made.style.background = this.color;
    return made;
  }

  /** A press on it is one on the color. */
  override ignoreEvent(): boolean {
    return false;
  }
}

interface Marks {
  set: DecorationSet;
}

const marks = StateField.define<Marks>({
  create: () => ({ set: Decoration.none }),
  update(now, transaction) {
    let { set } = now;
    if (transaction.docChanged) set = set.map(transaction.changes);
    for (const effect of transaction.effects) {
      if (effect.is(setLiterals)) set = decorated(effect.value, transaction.state.doc.length);
    }
    return set === now.set ? now : { set };
  },
  provide: (field) => EditorView.decorations.from(field, ({ set }) => set),
});

function decorated(literals: readonly SourceLiteral[], length: number): DecorationSet {
  const ranges = literals
    .filter(({ start, end }) => start >= 0 && end <= length && start < end)
    .flatMap((literal) => {
      const { start, end, type, value } = literal;
      const mark = Decoration.mark({ class: `literal ${type}`, literal }).range(start, end);
      const isHex = type === "color" && typeof value === "string" && /^#[0-9a-f]+$/i.test(value);
      return isHex ? [Decoration.widget({ widget: new Swatch(value), side: -1 }).range(start), mark] : [mark];
    });
  return Decoration.set(ranges, true);
}

/** The literal at a position, with the place it has now. */
export function literalAt(state: EditorState, at: number): SourceLiteral | null {
  let found: SourceLiteral | null = null;
  state.field(marks).set.between(at, at, (start, end, decoration) => {
    const literal = (decoration.spec as { literal?: SourceLiteral }).literal;
    // The innermost: a number of a vector is the vector's.
    if (literal) found = { ...literal, start, end };
  });
  return found;
}

/** The dial: where it is, and what it is for. */
interface Opened {
  literal: SourceLiteral;
  tooltip: Tooltip;
}

/** Opens the dial of the literal at the caret, with the focus in it. */
export function dialAtCaret(view: EditorView): void {
  const literal = literalAt(view.state, view.state.selection.main.head);
  if (!literal) return;
  view.dispatch({ effects: openDial.of(null) });
  view.dispatch({ effects: openDial.of(literal) });
  requestAnimationFrame(() => view.dom.querySelector<HTMLElement>(".dial :is(input, select)")?.focus());
}

/** What extends an editor by marks and dials. */
export function literals(turning: Turning): Extension {
  let dial: Dial | null = null;
  let current: SourceLiteral | null = null;
  const create = (view: EditorView) => {
    const literal = current!;
    dial = dialOf(literal, {
      give: (value) => turning.turn(current!, value),
      done: () => turning.release(),
    });
    const close = make("button", { type: "button", className: "close", "aria-label": "Close" }, "×");
    close.onclick = () => shut(view);
    dial.element.append(close);
    dial.element.addEventListener("keydown", (event) => {
      if (event.key === "Escape") shut(view);
    });
    return { dom: dial.element };
  };
  const opened = StateField.define<Opened | null>({
    create: () => null,
    update(now, transaction) {
      let literal = now?.literal ?? null;
      if (literal && transaction.docChanged) {
        const start = transaction.changes.mapPos(literal.start, -1);
        const end = transaction.changes.mapPos(literal.end, 1);
        const isTurned = transaction.isUserEvent("input.dial");
        literal = isTurned ? { ...literal, start, end } : null;
      }
      for (const effect of transaction.effects) {
        if (effect.is(openDial)) literal = effect.value;
        if (effect.is(setLiterals) && literal) {
          const { start, type } = literal;
          literal = effect.value.find((one) => one.start === start && one.type === type) ?? null;
          if (literal) dial?.update(literal);
        }
      }
      current = literal;
      if (!literal) return null;
      if (now?.literal === literal) return now;
      return { literal, tooltip: { pos: literal.start, above: true, create } };
    },
    provide: (field) => showTooltip.from(field, (found) => found?.tooltip ?? null),
  });
  const shut = (view: EditorView) => {
    view.dispatch({ effects: openDial.of(null) });
    view.focus();
  };
  const open = (view: EditorView, at: number) => {
    const literal = literalAt(view.state, at);
    const now = view.state.field(opened);
    if (literal?.start === now?.literal.start) return;
    // Another dial is another element.
    if (now) view.dispatch({ effects: openDial.of(null) });
    view.dispatch({ effects: openDial.of(literal) });
  };
  let isDragged = false;
  /** A press on a number that moves turns its dial; one that rests puts the caret there. */
  const press = (event: MouseEvent, view: EditorView, pressed: Element) => {
    const { clientX: from, clientY } = event;
    const start = view.posAtDOM(pressed);
    const at = view.posAtCoords({ x: from, y: clientY }) ?? start;
    const ends = new AbortController();
    const { signal } = ends;
    let slider: HTMLInputElement | undefined;
    let first = 0;
    const release = () => {
      ends.abort();
      if (slider) slider.dispatchEvent(new Event("change"));
      else view.dispatch({ selection: { anchor: at } });
    };
    const move = ({ clientX, buttons }: MouseEvent) => {
      if (!buttons) return release(); // Released outside the window.
      if (!slider) {
        if (Math.abs(clientX - from) < CLICK_PX) return;
        isDragged = true;
        open(view, start);
        // In a vector, the numbers before this one end in commas.
        const number = view.state.sliceDoc(start, at).split(",").length - 1;
        slider = dial!.element.querySelectorAll<HTMLInputElement>("[type=range]")[number];
        if (!slider) return release();
        first = slider.valueAsNumber;
      }
      slider.valueAsNumber = first + Math.round((clientX - from) / STEP_PX) * +slider.step;
      slider.dispatchEvent(new Event("input"));
    };
    addEventListener("mousemove", move, { signal });
    addEventListener("mouseup", release, { signal });
    view.focus();
  };
  return [
    marks,
    opened,
    EditorView.domEventHandlers({
      mousedown(event, view) {
        isDragged = false;
        const pressed = (event.target as HTMLElement).closest?.(".literal:is(.number, .vector)");
        const { altKey, button, ctrlKey, detail, metaKey, shiftKey } = event;
        const isOther = button || detail > 1 || altKey || ctrlKey || metaKey || shiftKey;
        if (!pressed || isOther) return false;
        press(event, view, pressed);
        return true;
      },
      click(event, view) {
        if (isDragged) return; // Its dial stays.
        const pressed = (event.target as HTMLElement).closest?.(".literal, .swatch");
        const isPressed = pressed && view.state.selection.main.empty;
        open(view, isPressed ? view.posAtDOM(pressed) : -1);
      },
    }),
    keymap.of([
      {
        key: "Escape",
        run(view) {
          if (!view.state.field(opened)) return false;
          shut(view);
          return true;
        },
      },
    ]),
  ];
}
