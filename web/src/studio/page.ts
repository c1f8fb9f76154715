/**
 * The page's own elements: header, panes, tabs, status.
 *
 * Input: what is written in them. Output: elements. It decides places and names, nothing else.
 */

import { make } from "../dom";

export class Page {
  readonly name = make("span", { className: "file" });
  readonly objects = make("select", { "aria-label": "Picture of the file", hidden: true });
  readonly buttons = make("div", { className: "buttons" });
  readonly files = make("div", { className: "tabs", role: "tablist", "aria-label": "Files" });
  readonly tabRow = make("div", { className: "tab-row" }, this.files);
  readonly code = make("div", { className: "code-area" });
  readonly mistakes = make("div", { className: "mistakes", role: "region", "aria-label": "Mistakes" });
  readonly printed = make("pre", { className: "printed", hidden: true, tabIndex: 0 });
  readonly show = make("section", { className: "show", "aria-label": "Picture", tabIndex: -1 });
  readonly left = make("section", { className: "left", "aria-label": "Code", tabIndex: -1 });
  readonly notice = make("div", { className: "notice", role: "alert", hidden: true });
  readonly bars = make("div", { className: "state-bars" });
  readonly work = make("span", { className: "work" });
  readonly drawn = make("span", { className: "drawn" });
  readonly announcer = make("div", { className: "announcer", role: "status" });
  #narrow = make("div", { className: "switch", role: "group", "aria-label": "Part of the page" });

  constructor(parent: HTMLElement) {
    const brand = make("strong", { className: "brand" }, "distal");
    const header = make("header", { className: "top" }, brand, this.name, this.objects, this.buttons);
    this.left.append(this.tabRow, this.code, this.printed, this.mistakes);
    const main = make("main", { className: "panes" }, this.left, this.show);
    const status = make("footer", { className: "status" }, this.work, this.drawn);
    parent.append(header, this.#narrow, this.bars, this.notice, main, status, this.announcer);
    this.#fillSwitch(main);
  }

  /** Puts the focus into the code, or from there into the picture's controls. */
  nextPart(): void {
    const parts = [this.left, this.show];
    const at = parts.findIndex((part) => part.contains(document.activeElement));
    const next = parts[(at + 1) % parts.length]!;
    (next.querySelector<HTMLElement>(".cm-content") ?? next.querySelector("select") ?? next).focus();
  }

  /** On a phone the picture is on top, and below it either the code or the controls. */
  #fillSwitch(main: HTMLElement): void {
    const parts = [["Code", "code"], ["Controls", "controls"]] as const;
    const buttons = parts.map(([text, part]) => {
      const button = make("button", { type: "button" }, text);
      button.onclick = () => {
        main.dataset["part"] = part;
        for (const one of buttons) one.setAttribute("aria-pressed", String(one === button));
      };
      return button;
    });
    this.#narrow.append(...buttons);
    buttons[0]!.click();
  }

  /** Inside of another page: only code, picture, and the way to the whole. */
  beFramed(address: () => Promise<string>): void {
    document.body.classList.add("framed");
    const open = make("button", { type: "button" }, "Open in the playground");
    // A window is opened by the press itself; its address follows.
    open.onclick = () => {
      const whole = window.open("", "_blank");
      void address().then((href) => whole && (whole.location.href = href));
    };
    this.buttons.after(open);
  }

  /** What the code has printed. */
  print(text: string): void {
    this.printed.hidden = !text;
    this.printed.textContent = text;
  }

  /** A sentence with its own place, which stays until it is taken away: null does that. */
  bar(key: string, text: string | null, ...actions: [label: string, act: () => void][]): void {
    const bars = [...this.bars.children] as HTMLElement[];
    const old = bars.find((one) => one.dataset["key"] === key);
    if (text === null) return old?.remove();
    // What is said again and again is read out once.
    if (old && !actions.length && old.textContent === text) return;
    const buttons = actions.map(([label, onclick]) => make("button", { type: "button", onclick }, label));
    const bar = make("div", { className: "state-bar", role: "alert" }, make("span", {}, text), ...buttons);
    bar.dataset["key"] = key;
    if (old) old.replaceWith(bar);
    else this.bars.append(bar);
  }

  /** A sentence over everything, with what can be done; null takes it away. */
  tell(text: string | null, ...actions: [label: string, act: () => void][]): void {
    this.notice.hidden = text === null;
    const buttons = actions.map(([label, act]) =>
      make("button", { type: "button", onclick: () => (this.tell(null), act()) }, label),
    );
    this.notice.replaceChildren(make("span", {}, text ?? ""), ...buttons);
  }
}
