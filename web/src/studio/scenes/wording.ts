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
export function momentOf(at: number, now = new Date()): string {
  const moment = new Date(at);
  const time = moment.toLocaleTimeString("en", { hour: "2-digit", minute: "2-digit", hour12: false });
  if (moment.toDateString() === now.toDateString()) return `today, ${time}`;
  const year = moment.getFullYear() === now.getFullYear() ? {} : ({ year: "numeric" } as const);
  return `${moment.toLocaleDateString("en", { day: "numeric", month: "long", ...year })}, ${time}`;
}

export function earlierText({ changed, name }: SceneRecord): string {
  return `You changed this earlier (${momentOf(changed)}): it is your scene ${quoted(name)}.`;
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
