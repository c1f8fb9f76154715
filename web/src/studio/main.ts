/**
 * Starts the studio: with the settings in the page of the playground, with those of the local server once
 * it has admitted the page.
 */

import { make } from "../dom";
import { Access, NOT_KEPT, REASONS, type Reason } from "./access";
import { CellChannel } from "./cell_channel";
import { SocketChannel, type Channel } from "./channel";
import type { Settings } from "./settings";
import { Studio } from "./studio";

const { nonce } = document.querySelector<HTMLScriptElement>("script[src]")!;

function begin(settings: Settings, channel: Channel): Studio {
  const studio = new Studio({ ...settings, nonce }, channel);
  (window as unknown as { studio: Studio }).studio = studio;
  return studio;
}

function beginLocally(): void {
  const access = new Access();
  const channel = new SocketChannel(access);
  const note = make("p", { className: "no-access", role: "status" });
  document.body.append(note);
  let studio: Studio | null = null;
  let edited = "";
  access.onOpen = (given) => {
    const settings = given as Settings;
    const file = JSON.stringify([settings.folder, settings.main]);
    if (studio && file !== edited) {
      access.end();
      return tellOther(studio);
    }
    note.remove();
    const isFirst = !studio;
    studio ??= begin(settings, channel);
    edited = file;
    studio.page.bar("access", null);
    channel.onState(true);
    if (isFirst && !access.isKept) studio.page.tell(NOT_KEPT, ["Close", () => {}]);
  };
  access.onClosed = (reason: Reason) => {
    note.textContent = REASONS[reason];
    if (!studio) return;
    channel.onState(false);
    // The bar of what is kept says that the server is away.
    studio.page.bar("access", reason === "away" ? null : REASONS[reason]);
  };
  access.start();
}

/** The page's texts belong to no file of the server that is here now. */
function tellOther({ page, sharing, texts }: Studio): void {
  const text = "The studio at this address edits another file now: reload the page to see it.";
  if (!texts.names.some((name) => texts.isChanged(name))) return page.bar("access", text);
  page.bar("access", `${text} What is not saved goes with this page.`, ["Save a copy", () => sharing.saveChanged()]);
}

const own = document.getElementById("settings");
if (own) {
  const settings = JSON.parse(own.textContent!) as Settings;
  begin(settings, new CellChannel(settings.python!));
} else beginLocally();
