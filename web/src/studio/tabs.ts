/**
 * Tabs and places: which file is shown, where its mistakes are, the way to a line.
 *
 * Input: names of files, mistakes, lines. Output: tabs, the list of mistakes, the caret.
 */

import { nextDiagnostic } from "@codemirror/lint";
import { make } from "../dom";
import type { Mistake } from "../generated/messages";
import { labelText, offsetIn } from "./editor";
import type { Studio } from "./studio";

const TEXT_TAB = "Emitted text";

export class Tabs {
  #now = "";
  #line = 0;
  #mistakes: readonly Mistake[] = [];

  constructor(readonly studio: Studio) {}

  fill(): void {
    const { emitted, page, scenes, settings, texts } = this.studio;
    const names = [...texts.names, TEXT_TAB];
    page.files.replaceChildren(
      ...names.map((name) => {
        const isHere = name === this.#now;
        // A scene of the playground is kept by itself.
        const isChanged = !scenes && name !== TEXT_TAB && texts.isChanged(name);
        const tab = make("button", { type: "button", role: "tab" }, isChanged ? `${name} •` : name);
        tab.setAttribute("aria-selected", String(isHere));
        if (isChanged) tab.setAttribute("aria-label", `${name}, not saved`);
        tab.tabIndex = isHere ? 0 : -1;
        tab.onclick = () => this.show(name);
        tab.onkeydown = ({ key }) => {
          const step = key === "ArrowRight" ? 1 : key === "ArrowLeft" ? -1 : 0;
          if (!step) return;
          this.show(names[(names.indexOf(name) + step + names.length) % names.length]!);
          page.files.querySelector<HTMLElement>("[aria-selected=true]")!.focus();
        };
        return tab;
      }),
    );
    const { isText } = this;
    emitted.menu.hidden = !isText;
    emitted.element.hidden = !isText;
    page.code.classList.toggle("beside", isText);
    page.name.textContent = settings.main;
  }

  show(name: string): void {
    const { costs, editor, texts } = this.studio;
    // A stranger's answer may name any file.
    if (name !== TEXT_TAB && !Object.hasOwn(texts.files, name)) return;
    const was = this.#now;
    this.#now = name;
    if (name === TEXT_TAB) void this.emit();
    else editor.show(name, texts.files[name]!);
    if (was !== name) this.fill();
    if (was !== name && name !== TEXT_TAB) {
      this.showMistakes(this.#mistakes);
      costs.shown();
    }
  }

  /** Shows a file, with the caret in it. */
  goToFile(name: string): void {
    this.show(name);
    this.studio.editor.view.focus();
  }

  goTo(file: string, line: number, column = 0, isFocused = false): void {
    const { editor } = this.studio;
    if (editor.name !== file) this.show(file);
    if (editor.name === file) editor.goTo(line, column, isFocused);
  }

  /** The caret is on another line. */
  moved(name: string, line: number): void {
    if (line === this.#line) return;
    this.#line = line;
    this.studio.costs.moved(line);
    if (this.isText) this.studio.emitted.link(name, line);
  }

  // The emitted text

  get isText(): boolean {
    return this.#now === TEXT_TAB;
  }

  /** Shows or leaves the emitted text. */
  toggleText(): void {
    void this.studio.channel.start?.();
    this.show(this.isText ? this.studio.editor.name : TEXT_TAB);
  }

  emitAgain(): void {
    if (this.isText) void this.emit();
  }

  async emit(): Promise<void> {
    const { client, editor, emitted, looking } = this.studio;
    const { target } = emitted;
    const answer = await client.ask({ kind: "text", ...looking.source, target });
    if (answer?.kind !== "answer" || answer.request !== "text") return;
    emitted.show(answer.result);
    emitted.link(editor.name, this.#line);
  }

  // Mistakes

  get hasMistakes(): boolean {
    return this.#mistakes.some(({ file, line }) => file && line !== null);
  }

  /** Goes to the next mistake of the file that is shown, or to the first of another file. */
  nextMistake(): void {
    const { editor } = this.studio;
    const placed = this.#mistakes.filter(({ file, line }) => file && line !== null);
    const [first] = placed;
    if (!first) return;
    if (placed.some(({ file }) => file === editor.name)) {
      editor.view.focus();
      nextDiagnostic(editor.view);
    } else this.goTo(first.file!, first.line!, offsetIn(first, first.column), true);
  }

  showMistakes(mistakes: readonly Mistake[]): void {
    const { editor, page, settings } = this.studio;
    this.#mistakes = mistakes;
    editor.setMistakes(mistakes);
    page.mistakes.replaceChildren(
      ...mistakes.slice(0, 20).map((mistake) => {
        const { file, line, column, message, hint, severity, labels } = mistake;
        const place = line === null ? "" : `${file === settings.main ? "" : `${file} `}line ${line}: `;
        const text = make("span", {}, make("b", {}, place), message);
        const about = [...labels.map(labelText), hint].map((said) => said && make("em", {}, said));
        if (line === null || !file) return make("div", { className: severity }, text, ...about);
        const button = make("button", { type: "button", className: severity }, text, ...about);
        button.onclick = () => this.goTo(file, line, offsetIn(mistake, column), true);
        return button;
      }),
    );
    const [first] = mistakes;
    if (first) page.announcer.textContent = `${first.line === null ? "" : `Line ${first.line}: `}${first.message}`;
  }
}
