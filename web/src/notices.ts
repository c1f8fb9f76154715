/**
 * Notices over the picture: "compiling", a lost context, an error in the author's lines.
 *
 * Input: states and errors. Output: elements. Everything is said to screen readers as well.
 */

import { make } from "./dom";
import { complaints, type Complaint } from "./lines";
import { ShaderError } from "./program";

export interface Failure {
  sentence: string;
  /** The driver's words, one row each, with the author's lines where they are known. */
  rows: Complaint[];
}

const NO_WEBGL = "This browser offers no WebGL 2, so the scene does not move.";

/** The notice of an error: one sentence, and details to unfold. */
export function failureOf(error: unknown, files: readonly string[], isUnsupported: boolean): Failure {
  if (error instanceof ShaderError) {
    const rows = complaints(error.log, error.lines, files);
    const place = rows.find((row) => row.place)?.place;
    return { sentence: error.message + (place ? ` It stumbled at ${place}.` : ""), rows };
  }
  const text = error instanceof Error ? error.message : String(error);
  if (!isUnsupported) return { sentence: `The scene cannot be drawn: ${text}`, rows: [] };
  return { sentence: NO_WEBGL, rows: text ? [{ place: "", text }] : [] };
}

export class Notices {
  readonly element = make("div", { className: "notices" });
  /** Hidden from the eye, read aloud. */
  readonly status = make("div", { className: "aloud", role: "status", "aria-live": "polite" });
  #word: HTMLElement | undefined;

  clear(): void {
    this.element.replaceChildren();
  }

  /** A few words while something is under way. */
  busy(text: string): void {
    this.clear();
    this.element.append(make("div", { className: "chip busy" }, text));
    this.say(text);
  }

  /** A few words that go away by themselves; what is wrong or under way stays beside them. */
  brief(text: string): void {
    const word = make("div", { className: "chip" }, text);
    this.#word?.remove();
    this.element.append((this.#word = word));
    this.say(text);
    setTimeout(() => word.remove(), 2500);
  }

  /** Something is wrong, and stays until it is mended. */
  failure({ sentence, rows }: Failure, retry: () => void): void {
    this.clear();
    const again = make("button", { type: "button", className: "text", onclick: retry }, "Try again");
    const card = make("div", { className: "card", role: "alert" }, make("p", {}, sentence));
    if (rows.length) {
      const lines = rows.map(({ place, text }) => {
        return make("div", {}, place && make("strong", {}, `${place}  `), text);
      });
      const words = make("div", { className: "words", tabIndex: 0 }, ...lines);
      card.append(make("details", {}, make("summary", {}, "Details"), words));
    }
    card.append(again);
    this.element.append(card);
  }

  say(text: string): void {
    this.status.textContent = text;
  }
}
