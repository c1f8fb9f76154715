/**
 * Pictures and films that are rendered: what runs, what waits, what is there.
 *
 * Input: requests, the server's messages about them. Output: a row for each, and one sentence for the page's
 * foot. A render goes on while its sheet is closed; it ends with the tab.
 */

import { make } from "../dom";
import type { Progress, RenderChoices, Rendered } from "../generated/messages";
import type { Asked, Client } from "./client";

export type RenderAsked = Extract<Asked, { kind: "render" }>;

interface Job {
  id: number;
  state: "running" | "done" | "failed" | "cancelled";
  row: HTMLElement;
  bar: HTMLProgressElement;
  text: HTMLElement;
  name: string;
}

export class Jobs {
  readonly rows = make("ul", { className: "jobs", "aria-label": "Renders" });
  /** In the page's foot; a press opens the sheet. */
  readonly chip = make("button", { type: "button", className: "chip", hidden: true });
  /** What the server can render, once it has said so. */
  choices: RenderChoices | null = null;
  #jobs: Job[] = [];

  constructor(
    readonly client: Client,
    readonly announce: (text: string) => void,
    open: () => void,
  ) {
    this.chip.title = "Show what is rendered";
    this.chip.onclick = open;
  }

  /** Renders; the browser saves a picture when it is there. */
  start(request: RenderAsked, name: string): void {
    const bar = make("progress", { max: 1, value: 0, "aria-label": name });
    const text = make("span", { className: "quiet" }, "starting");
    const row = make("li", {}, make("strong", {}, name), bar, text);
    const job: Job = { id: 0, state: "running", row, bar, text, name };
    const begun = this.client.begin(request, (message) => this.#progress(job, message));
    job.id = begun.id;
    const cancel = make("button", { type: "button" }, "Cancel");
    cancel.setAttribute("aria-label", `Cancel ${name}`);
    cancel.onclick = () => {
      cancel.disabled = true;
      this.client.tell({ kind: "cancel", revision: request.revision, job: job.id });
    };
    row.append(cancel);
    this.#jobs.push(job);
    this.rows.prepend(row);
    this.#show();
    void begun.answer.then((answer) => {
      cancel.remove();
      bar.remove();
      if (answer?.kind === "answer" && answer.request === "render") this.#done(job, answer.result);
      else if (answer?.kind === "dropped") this.#ended(job, "cancelled", "Cancelled; no file is left.");
      else if (answer?.kind === "mistakes") this.#ended(job, "failed", answer.mistakes[0]!.message);
      else this.#ended(job, "failed", "The studio's server has ended, and the render with it.");
    });
  }

  #progress(job: Job, { label, done, text, remaining_s }: Progress): void {
    // Before it renders nobody knows how long it takes.
    if (done > 0) job.bar.value = done;
    else job.bar.removeAttribute("value");
    const part = done > 0 ? `${label} ${Math.round(100 * done)} %` : (WORDS[label] ?? label);
    const left = remaining_s === null ? "" : `${duration(remaining_s)} left`;
    job.text.textContent = [part, text, left].filter(Boolean).join(" · ");
    this.#show();
  }

  #done(job: Job, { name, bytes, address, command, said }: Rendered): void {
    const own = job.name;
    job.name = name;
    const where = address ? "saved by the browser" : "beside the scene";
    this.#ended(job, "done", `${size(bytes)}, ${where}`);
    job.row.querySelector("strong")!.textContent = name;
    if (address) {
      const link = make("a", { href: address, download: name }, "Save it again");
      job.row.append(link);
      link.click();
    }
    job.row.append(commandOf(command));
    const notes = said.split("\n").filter((line) => line && !line.startsWith(`${own}: `));
    if (notes.length) job.row.append(make("pre", { className: "said" }, notes.join("\n")));
    this.announce(`${name} is there`);
  }

  #ended(job: Job, state: Job["state"], text: string): void {
    job.state = state;
    job.text.textContent = text;
    job.row.className = state;
    job.row.setAttribute("data-state", state);
    if (state === "failed") this.announce(`${job.name}: ${text}`);
    this.#show();
  }

  /** The sentence in the foot: what runs first, or what came out while nobody looked. */
  #show(): void {
    const running = this.#jobs.filter(({ state }) => state === "running");
    const last = this.#jobs.at(-1);
    this.chip.hidden = !last;
    const [first] = running;
    const more = running.length > 1 ? ` (+${running.length - 1})` : "";
    if (first) this.chip.textContent = `${first.name}: ${first.text.textContent}${more}`;
    else if (last) this.chip.textContent = `${last.name}: ${last.state}`;
  }
}

/** What is done before anything can be counted. */
const WORDS: Record<string, string> = {
  waiting: "waits for another render",
  loading: "running the code",
};

/** A command with a button that copies it. */
export function commandOf(command: string): HTMLElement {
  const text = make("code", { tabIndex: 0 }, command);
  const copy = make("button", { type: "button" }, "Copy");
  copy.setAttribute("aria-label", "Copy the command");
  copy.onclick = async () => {
    try {
      await navigator.clipboard.writeText(text.textContent!);
    } catch {
      // Some browsers refuse: what is selected is copied by hand.
      getSelection()?.selectAllChildren(text);
      document.execCommand("copy");
    }
    copy.textContent = "Copied";
  };
  return make("div", { className: "command" }, text, copy);
}

function duration(seconds: number): string {
  if (seconds < 90) return `${Math.max(1, Math.round(seconds))} s`;
  return seconds < 5400 ? `${Math.round(seconds / 60)} min` : `${(seconds / 3600).toFixed(1)} h`;
}

function size(bytes: number): string {
  return bytes < 1e6 ? `${Math.ceil(bytes / 1e3)} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
}
