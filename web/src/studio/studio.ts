/**
 * The studio: code, picture and parameters side by side.
 *
 * Input: the settings in the page, a channel to the worker. Output: the running app. Here its parts are
 * made and connected: what a person does goes to the part that answers it.
 */

import type { LiteralValue } from "../generated/messages";
import { recallScheme } from "./appearance";
import { Asking } from "./asking";
import { CellChannel } from "./cell_channel";
import { SocketChannel, type Channel } from "./channel";
import { Client } from "./client";
import { CostBar } from "./cost_bar";
import { Commands } from "./command_keys";
import { Editor } from "./editor";
import { Emitted } from "./emitted";
import { Files } from "./files";
import { Jobs } from "./jobs";
import type { Keeping } from "./keeping";
import { Looking } from "./looking";
import { Opening } from "./opening";
import { Page } from "./page";
import { Picture } from "./picture";
import { Scenes } from "./scenes/scenes";
import type { Settings } from "./settings";
import { Sharing } from "./sharing";
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
  /** The playground's scenes; the local studio has files. */
  readonly scenes: Scenes | null;
  readonly keeping: Keeping;
  readonly costs: CostBar;
  readonly commands: Commands;
  readonly channel: Channel;
  readonly client: Client;
  readonly jobs: Jobs;
  readonly editor: Editor;
  readonly picture: Picture;
  readonly emitted: Emitted;

  constructor(readonly settings: Settings) {
    recallScheme();
    const { folder, main, python } = settings;
    this.texts = new Texts(folder);
    this.scenes = settings.python ? new Scenes(this) : null;
    this.keeping = this.scenes ?? this.#drafts();
    if (this.scenes?.isFrame) this.page.beFramed(() => this.sharing.whole());
    this.picture = this.#picture();
    this.costs = this.#costs();
    this.commands = new Commands(this);
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
    const announce = (text: string) => (this.page.announcer.textContent = text);
    this.jobs = new Jobs(this.client, announce, () => void this.sharing.export());
    this.page.work.after(this.jobs.chip);
    document.title = `${main} · distal`;
    if (settings.start) void this.opening.begin(settings.start);
    if (!this.scenes) addEventListener("beforeunload", () => this.keeping.keep());
  }

  save(): Promise<void> {
    return this.files.save();
  }

  #drafts(): Keeping {
    const { texts } = this;
    return { changed() {}, keep: () => texts.names.forEach((name) => texts.keepDraft(name)) };
  }

  #picture(): Picture {
    const { asking, looking, page } = this;
    const picture = new Picture({
      view: () => {
        void this.channel.start?.();
        looking.look();
      },
      clicked: (x, y) => void asking.probe(x, y),
      keepParameter: (name, value) =>
        void looking.write({ what: "parameter", name, value: value as LiteralValue }),
      keepCamera: (text) => {
        looking.keepsCamera = true;
        void looking.write({ what: "camera", text });
      },
      refused: (reason) => page.tell(reason, ["Close", () => {}]),
      drawn: (text) => (page.drawn.textContent = text),
      named: () => this.scenes?.name ?? "",
      guide: () => looking.guide(this.texts.revision),
      program: (view) => looking.program(view),
      map: () => asking.map(),
      button: (id) => this.commands.button(id),
      changed: () => this.commands.refresh(),
    });
    const { element, strip, layers, knobs } = picture;
    page.show.append(element, strip, layers.element, knobs);
    return picture;
  }

  #costs(): CostBar {
    const { asking, page } = this;
    const costs = new CostBar({
      count: (work) => asking.lineProgram("count", { work }),
      time: () => asking.lineProgram("time"),
      player: () => this.picture.player,
      file: () => this.editor.name,
      show: (figures) => this.editor.setFigures(figures),
      toggled: () => {
        this.commands.refresh();
        void this.channel.start?.();
      },
    });
    page.tabRow.after(costs.element);
    return costs;
  }

  #editor(): Editor {
    const { asking, files, tabs, turning } = this;
    const events = {
      typed: (name: string, text: string) => files.typed(name, text),
      moved: (name: string, line: number) => tabs.moved(name, line),
      pointed: (name: string, line: number | null, isMouse: boolean) => asking.pointed(name, line, isMouse),
      turn: turning.turned.bind(turning),
      release: () => turning.released(),
    };
    return new Editor(this.page.code, events, this.commands.ofCode, this.settings.nonce);
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
    const { commands, looking, page } = this;
    page.objects.onchange = () => looking.choose(page.objects.value);
    const ofStrip = ["layers", "keepCamera"];
    const own = commands.all.filter(({ id, button }) => button && !ofStrip.includes(id));
    page.buttons.append(...own.map(({ id }) => commands.button(id)));
  }
}
