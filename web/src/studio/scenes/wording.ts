/** Sentences about scenes: times, what the store refuses, why a version is there. */

import type { Reason, SceneRecord } from "./records";

export const REASONS: Record<Reason, string> = {
  opened: "as it was opened",
  typed: "after a pause",
  run: "run",
  "before replace": "before it was replaced",
  named: "kept with Save",
};

export function quoted(name: string): string {
  return `“${name}”`;
}

/** A moment as a person says it: the time today, else the day. */
export function momentOf(at: number, hasSeconds = false, now = new Date()): string {
  const moment = new Date(at);
  const seconds = hasSeconds ? ({ second: "2-digit" } as const) : {};
  const time = moment.toLocaleTimeString("en-GB", { hour: "2-digit", minute: "2-digit", ...seconds });
  return isToday(moment, now) ? `today, ${time}` : `${dayOf(moment, now)}, ${time}`;
}

export function earlierText({ changed, name }: SceneRecord, now = new Date()): string {
  const moment = new Date(changed);
  const when = isToday(moment, now) ? "today" : `on ${dayOf(moment, now)}`;
  return `You changed this ${when}: it is your scene ${quoted(name)}.`;
}

function isToday(moment: Date, now: Date): boolean {
  return moment.toDateString() === now.toDateString();
}

function dayOf(moment: Date, now: Date): string {
  const year = moment.getFullYear() === now.getFullYear() ? {} : ({ year: "numeric" } as const);
  return moment.toLocaleDateString("en-GB", { day: "numeric", month: "long", ...year });
}

/** What a refusal of the store means for the text. */
export function failureText({ name, message }: Error): string {
  const here = "The newest text is in this tab only.";
  if (name === "QuotaExceededError") return `The browser's storage is full. ${here}`;
  if (name === "VersionError") return `A newer version of the playground wrote your scenes: reload the page. ${here}`;
  const isBlocked = name === "SecurityError" || name === "InvalidStateError" || name === "TypeError" || name === "ReferenceError";
  const why = isBlocked || !message ? "a private window, or storage is blocked" : message;
  return `This browser stores nothing for the page (${why}). ${here}`;
}
