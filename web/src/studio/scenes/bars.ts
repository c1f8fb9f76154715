/**
 * Bars below the header, each for a state that lasts: it stays until the state ends or a person closes it.
 *
 * Input: the name of a state, a sentence, buttons. Output: elements. The page's notice is another element:
 * what it tells hides no bar.
 */

import { make } from "../../dom";

export type Action = readonly [label: string, act: () => void];

export class Bars {
  readonly element = make("div", { className: "bars" });
  #bars = new Map<string, HTMLElement>();

  /** Shows a bar, in place of the one of that name. */
  show(name: string, text: string, ...actions: Action[]): void {
    const buttons = actions.map(([label, act]) => make("button", { type: "button", onclick: act }, label));
    const bar = make("div", { className: "notice", role: "status", "data-bar": name }, make("span", {}, text), ...buttons);
    const old = this.#bars.get(name);
    if (old) old.replaceWith(bar);
    else this.element.append(bar);
    this.#bars.set(name, bar);
  }

  hide(name: string): void {
    this.#bars.get(name)?.remove();
    this.#bars.delete(name);
  }
}
