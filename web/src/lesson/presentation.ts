/**
 * Presentation: one section at a time, large, beside the picture.
 *
 * Keys: arrows, Page Up and Page Down turn, Home and End jump, Escape leaves. A slider or the picture
 * that has the focus keeps its keys.
 */

import { make } from "../dom";

export function present(): void {
  const button = document.querySelector<HTMLButtonElement>(".present");
  const sections = [...document.querySelectorAll<HTMLElement>("article > section")];
  if (!button || sections.length === 0) return;
  button.hidden = false;
  let at = 0;
  let end: AbortController | null = null;
  const count = make("span", { className: "count", role: "status" });
  const turn = (to: number) => {
    at = Math.min(Math.max(to, 0), sections.length - 1);
    sections.forEach((section, i) => (section.hidden = i !== at));
    count.textContent = `${at + 1} of ${sections.length}`;
    last.disabled = at === 0;
    next.disabled = at === sections.length - 1;
    document.querySelector("article")!.scrollTop = 0;
  };
  const step = (text: string, by: number) =>
    make("button", { type: "button", onclick: () => turn(at + by) }, text);
  const [last, next] = [step("Back", -1), step("Next", 1)];
  const leave = () => {
    end?.abort();
    end = null;
    document.documentElement.classList.remove("presenting");
    for (const section of sections) section.hidden = false;
    bar.remove();
    button.focus();
  };
  const close = make("button", { type: "button", onclick: leave }, "End");
  const bar = make("nav", { className: "turns", "aria-label": "Presentation" }, last, count, next, close);
  const KEYS: Record<string, () => void> = {
    ArrowRight: () => turn(at + 1),
    PageDown: () => turn(at + 1),
    ArrowLeft: () => turn(at - 1),
    PageUp: () => turn(at - 1),
    Home: () => turn(0),
    End: () => turn(sections.length - 1),
    Escape: leave,
  };
  button.onclick = () => {
    end = new AbortController();
    document.documentElement.classList.add("presenting");
    document.querySelector("main")!.after(bar);
    turn(0);
    next.focus();
    const act = (event: KeyboardEvent) => {
      const target = event.target as HTMLElement;
      const isTaken = event.key !== "Escape" && target.matches("input, select, [data-distal], pre");
      if (isTaken || event.altKey || event.ctrlKey || event.metaKey || !KEYS[event.key]) return;
      event.preventDefault();
      KEYS[event.key]!();
    };
    document.addEventListener("keydown", act, { signal: end.signal });
  };
}
