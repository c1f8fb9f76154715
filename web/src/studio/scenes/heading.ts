/**
 * The scene's name in the header: a press makes it a field.
 *
 * Input: the name, whether it is a scene of this browser, whether another tab edits it. Output: what a person types.
 */

import { make } from "../../dom";
import { quoted } from "./wording";

export class Heading {
  readonly element = make("div", { className: "heading" });
  #button = make("button", { type: "button", className: "file" });
  #state = make("span", { className: "quiet" });
  #reader = make("button", { type: "button", hidden: true }, "Read only");
  #name = "";

  constructor(
    readonly renamed: (name: string) => void,
    /** Whoever reads only wants to know why. */
    asked: () => void,
  ) {
    this.element.append(this.#button, this.#state, this.#reader);
    this.#button.onclick = () => this.edit();
    this.#reader.onclick = asked;
  }

  edit(): void {
    if (this.#reader.hidden) editName(this.#button, this.#name, this.renamed);
  }

  show(name: string, isKept: boolean, isReader: boolean): void {
    this.#name = name;
    this.#button.textContent = name;
    this.#button.title = isReader ? name : `Rename ${quoted(name)}`;
    this.#state.textContent = isKept ? "" : "not changed yet";
    this.#reader.hidden = !isReader;
    this.element.classList.toggle("reader", isReader);
  }
}

/** A field in place of a button, until Enter, Escape or the focus elsewhere ends it. */
export function editName(button: HTMLElement, name: string, renamed: (name: string) => void, ended = () => {}): void {
  const field = make("input", { type: "text", value: name, maxLength: 120, "aria-label": "Name of the scene" });
  let isDone = false;
  const end = (isTaken: boolean) => {
    if (isDone) return;
    isDone = true;
    field.replaceWith(button);
    if (isTaken && field.value.trim() && field.value.trim() !== name) renamed(field.value);
    ended();
  };
  field.onblur = () => end(true);
  field.onkeydown = (event) => {
    if (event.isComposing || (event.key !== "Enter" && event.key !== "Escape")) return;
    // Escape would close the sheet that it is in.
    event.preventDefault();
    event.stopPropagation();
    end(event.key === "Enter");
    button.focus();
  };
  button.replaceWith(field);
  field.focus();
  field.select();
}
