/**
 * The studio: code, picture and parameters side by side.
 *
 * Input: the settings in the page, a channel to the worker. Output: the running app. Here its parts are
 * made and connected: what a person does goes to the part that answers it.
 */

import { make } from "../dom";
import type { LiteralValue } from "../generated/messages";
import { Asking } from "./asking";
import { CellChannel } from "./cell_channel";
import { SocketChannel, type Channel } from "./channel";
import { Client } from "./client";
import { Editor } from "./editor";
import { Emitted } from "./emitted";
import { Files } from "./files";
import { Looking } from "./looking";
import { Opening } from "./opening";
import { Page } from "./page";
import { Picture } from "./picture";
import type { Settings } from "./settings";
import { Sharing } from "./sharing";
import { gallery, help } from "./sheets";
import { Tabs } from "./tabs";
import { Texts } from "./texts";
import { Turning } from "./turning";

export class Studio {
  readonly texts: Texts;
  readonly page = new Page(document.body);
  readonly looking = new Looking(this);
  readonly turning = new Turning(this);
  readonly asking = new Asking(this);
  readonly files = new Files(this);
  readonly tabs = new Tabs(this);
  readonly opening = new Opening(this);
  readonly sharing = new Sharing(this);
  readonly channel: Channel;
  readonly client: Client;
  readonly editor: Editor;
  readonly picture: Picture;
  readonly emitted: Emitted;

  constructor(readonly settings: Settings) {
    const { folder, main, python } = settings;
    // In another page it is small, and a draft of the whole playground is none of its text.
    const isFramed = new URLSearchParams(location.search).has("embed");
    if (isFramed) this.page.beFramed(() => this.sharing.whole());
    this.texts = new Texts(isFramed ? location.href : folder);
    this.picture = this.#picture();
    this.editor = this.#editor();
    this.emitted = this.#emitted();
    this.#fillButtons();
    this.channel = python ? this.#cell(python) : new SocketChannel(`ws://${location.host}/socket`);
    this.client = new Client(this.channel, {
      ready: (message) => this.looking.started(message),
      changed: (message) => this.files.changed(message),
      printed: ({ text }) => this.page.print(text),
      restarted: ({ reason }) => this.looking.restarted(reason),
      state: (isOpen) => this.looking.connected(isOpen),
    });
    document.title = `${main} · distal`;
    if (settings.start) void this.opening.begin(settings.start);
    addEventListener("beforeunload", () => this.texts.names.forEach((name) => this.texts.keepDraft(name)));
  }

  save(): Promise<void> {
    return this.files.save();
  }

  #picture(): Picture {
    const { asking, looking, page } = this;
    const picture = new Picture({
      view: () => looking.look(),
      clicked: (x, y) => void asking.probe(x, y),
      keepParameter: (name, value) =>
        void looking.write({ what: "parameter", name, value: value as LiteralValue }),
      keepCamera: (text) => {
        looking.keepsCamera = true;
        void looking.write({ what: "camera", text });
      },
      drawn: (text) => (page.drawn.textContent = text),
      guide: () => looking.guide(this.texts.revision),
      program: (view) => looking.program(view),
      map: () => asking.map(),
    });
    const { element, strip, layers, knobs } = picture;
    page.show.append(element, strip, layers.element, knobs);
    return picture;
  }

  #editor(): Editor {
    const { asking, files, looking, tabs, turning } = this;
    const events = {
      typed: (name: string, text: string) => files.typed(name, text),
      moved: (name: string, line: number) => tabs.moved(name, line),
      pointed: (name: string, line: number | null, isMouse: boolean) => asking.pointed(name, line, isMouse),
      save: () => void files.save(),
      run: () => looking.run(),
      turn: turning.turned.bind(turning),
      release: () => turning.released(),
    };
    return new Editor(this.page.code, events, this.settings.nonce);
  }

  #emitted(): Emitted {
    const { page, tabs } = this;
    const goTo = (file: string, line: number) => {
      if (file in this.texts.files) tabs.goTo(file, line);
    };
    const emitted = new Emitted(this.settings.nonce, goTo, () => void tabs.emit());
    page.code.append(emitted.element);
    page.tabRow.append(emitted.menu);
    return emitted;
  }

  #cell(folder: string): CellChannel {
    const cell = new CellChannel(folder);
    cell.onProgress = (part) => {
      this.page.work.textContent = part < 1 ? `Loading Python: ${Math.round(100 * part)} %` : "Starting Python …";
    };
    // Python is large: it comes when somebody wants to change something.
    for (const kind of ["pointerdown", "focusin"]) {
      this.page.left.addEventListener(kind, () => void cell.start(), { once: true });
    }
    return cell;
  }

  #fillButtons(): void {
    const button = (text: string, title: string, act: () => void) =>
      make("button", { type: "button", title, onclick: act }, text);
    this.page.objects.onchange = () => {
      this.looking.object = this.page.objects.value;
      this.looking.look();
    };
    this.page.buttons.append(
      button("Gallery", "Open a copy of an example", () =>
        gallery(this.settings.gallery, (name) => void this.opening.open(name)),
      ),
      this.#costButton(),
      button("Export", "Make a page or a shader of it", () => this.sharing.export()),
      this.settings.python
        ? button("Share", "A link that has the code in it", () => void this.sharing.share())
        : button("Save", "Save the file (Mod S)", () => void this.save()),
      button("?", "Keys", () => help(this.settings.version)),
    );
  }

  #costButton(): HTMLElement {
    const title = "How often each line runs for a pixel";
    const toggle = make("button", { type: "button", title, "aria-pressed": "false" }, "Cost");
    toggle.onclick = () => {
      this.asking.counts = !this.asking.counts;
      toggle.setAttribute("aria-pressed", String(this.asking.counts));
      this.asking.showRuns();
      void this.channel.start?.();
      void this.asking.count();
    };
    return toggle;
  }
}
