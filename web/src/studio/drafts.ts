/**
 * Drafts: unsaved texts go to the studio's server, which keeps them when the page and the server have ended.
 *
 * Input: texts that change, the connection. Output: requests; what the server does not have yet stays in the
 * tab's own storage, for a reload. Of the first message on, the server knows which tab this is.
 */

import type { Greeted } from "../generated/messages";
import type { Keeping } from "./keeping";
import { recalled, remember } from "./storage";
import type { Studio } from "./studio";

/** After a key, so long until the text is sent. */
const KEY_MS = 250;
/** Where it could not be kept, so long until the next try. */
const RETRY_MS = 5000;
const TAB = "distal:tab";
/** With the folder: another server may have this address later. */
const UNSENT = "distal:unsent:";

interface Draft {
  text: string;
  digest: string;
}

export class Drafts implements Keeping {
  #timer = 0;
  /** By name, what the server has or is about to have; nothing for a file that is as on the disk. */
  #sent = new Map<string, string>();
  /** By name, what the server has not confirmed. */
  #unsent = new Map<string, Draft>();
  /** What the page before could not send. */
  #before: Record<string, Draft>;
  #isThere = false;
  /** Why the server keeps nothing. */
  #unkept = "";

  constructor(readonly studio: Studio) {
    this.#before = unsentBefore(this.#place);
  }

  /** Where in the tab's storage what is not sent is kept. */
  get #place(): string {
    return UNSENT + this.studio.settings.folder;
  }

  /** Whether a text goes with the tab. */
  get isHereOnly(): boolean {
    return this.#unsent.size > 0 && (!this.#isThere || !!this.#unkept);
  }

  changed(): void {
    if (!this.#timer) this.#timer = window.setTimeout(() => this.keep(), KEY_MS);
  }

  keep(): void {
    clearTimeout(this.#timer);
    this.#timer = 0;
    for (const name of this.studio.texts.names) this.#keepOne(name);
    this.#store();
  }

  /** The connection opened or closed. */
  async connected(isOpen: boolean): Promise<void> {
    const { client, files, page, texts } = this.studio;
    this.#isThere = false;
    this.#sent.clear();
    if (!isOpen) return this.#away();
    const isNew = !texts.names.length;
    const asked = { kind: "hello", revision: texts.revision, tab: recalled("sessionStorage", TAB) ?? "", is_new: isNew } as const;
    const answer = await client.ask(asked);
    if (answer?.kind !== "answer" || answer.request !== "hello") return;
    this.#isThere = true;
    page.bar("away", null);
    this.#greeted(answer.result, isNew);
    files.greeted(isNew ? { ...answer.result.drafts, ...this.#before } : {});
    this.#before = {};
    // The server has these: what is as on the disk by now is one no longer.
    for (const name of Object.keys(answer.result.drafts)) this.#sent.set(name, "before");
    this.keep();
  }

  #greeted({ others, tab, unkept }: Greeted, isNew: boolean): void {
    const { page, versions } = this.studio;
    remember("sessionStorage", TAB, tab);
    this.#say(unkept);
    if (!isNew || !others.length) return;
    const close = () => page.bar("others", null);
    const show = () => (close(), void versions.open(others[0]!));
    const text = `Another unsaved text of ${others.join(", ")} is among the versions.`;
    page.bar("others", text, ["Show versions", show], ["Close", close]);
  }

  #keepOne(name: string): void {
    const { client, texts } = this.studio;
    const { text, base } = texts.state(name);
    const draft = texts.isChanged(name) ? { text, digest: base.digest } : null;
    const key = draft ? JSON.stringify(draft) : "";
    if (key === (this.#sent.get(name) ?? "") && this.#isThere) return;
    if (draft) this.#unsent.set(name, draft);
    else this.#unsent.delete(name);
    if (!this.#isThere) return;
    this.#sent.set(name, key);
    const asked = { kind: "draft", revision: texts.revision, file: name, text: draft?.text ?? null } as const;
    void client.ask({ ...asked, digest: base.digest }).then((answer) => {
      if (this.#sent.get(name) !== key) return; // a newer one is on its way
      const isAnswer = answer?.kind === "answer" && answer.request === "draft";
      const reason = isAnswer ? answer.result.unkept : answer?.kind === "mistakes" ? answer.mistakes[0]!.message : null;
      if (reason === null) return; // the connection is gone: it comes back
      this.#say(reason);
      if (!reason) this.#unsent.delete(name);
      else this.#sent.delete(name);
      if (reason && !this.#timer) this.#timer = window.setTimeout(() => this.keep(), RETRY_MS);
      this.#store();
    });
  }

  /** Says why nothing can be kept; nothing where it can. */
  #say(reason: string): void {
    this.#unkept = reason;
    const text = `Unsaved text is not kept on the disk: ${reason}. It is in this page alone until you save it.`;
    this.studio.page.bar("unkept", reason ? text : null);
  }

  #away(): void {
    this.keep();
    const { page } = this.studio;
    const where = this.#store() ? "in this tab, also when you reload it" : "in this page alone: leave it open";
    page.bar("away", `The studio's server is away. Unsaved text is kept ${where}; it goes to the server when that is back.`);
  }

  /** Keeps what the server does not have in the tab's storage; returns whether that was possible. */
  #store(): boolean {
    const unsent = { ...this.#before, ...Object.fromEntries(this.#unsent) };
    return remember("sessionStorage", this.#place, Object.keys(unsent).length ? JSON.stringify(unsent) : null);
  }
}

/** What a page in this tab could not send before it was loaded again. */
function unsentBefore(place: string): Record<string, Draft> {
  try {
    return JSON.parse(recalled("sessionStorage", place) ?? "{}") as Record<string, Draft>;
  } catch {
    return {};
  }
}
