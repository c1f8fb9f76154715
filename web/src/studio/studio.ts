/**
 * The studio: code, picture and parameters side by side.
 *
 * Input: the settings, a channel to the worker. Output: the running app. Here its parts are
 * made and connected: what a person does goes to the part that answers it.
 */

import type { LiteralValue } from "../generated/messages";
import { recallScheme } from "./appearance";
import { Asking } from "./asking";
import { CellChannel } from "./cell_channel";
import type { Channel } from "./channel";
import { Client } from "./client";
import { Conflicts } from "./conflicts";
import { CostBar } from "./cost_bar";
import { Commands } from "./command_keys";
import { Drafts } from "./drafts";
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
import { Versions } from "./versions";

export class Studio {
  readonly texts = new Texts();
  readonly page = new Page(document.body);
  readonly looking = new Looking(this);
  readonly turning = new Turning(this);
  readonly asking = new Asking(this);
  readonly files = new Files(this);
  readonly conflicts = new Conflicts(this);
  readonly versions = new Versions(this);
  readonly keeping: Keeping;
  readonly tabs = new Tabs(this);
  readonly opening = new Opening(this);
  readonly sharing = new Sharing(this);
  /** The playground's scenes; the local studio has files. */
  readonly scenes: Scenes | null;
  readonly costs: CostBar;
  readonly commands: Commands;
  readonly client: Client;
  readonly jobs: Jobs;
  readonly editor: Editor;
  readonly picture: Picture;
  readonly emitted: Emitted;

  constructor(
    readonly settings: Settings,
    readonly channel: Channel,
  ) {
    recallScheme();
    const { main, python } = settings;
    this.scenes = python ? new Scenes(this) : null;
    const drafts = python ? null : new Drafts(this);
    this.keeping = this.scenes ?? drafts!;
    if (this.scenes?.isFrame) this.page.beFramed(() => this.sharing.whole());
    this.picture = this.#picture();
    this.costs = this.#costs();
    this.commands = new Commands(this);
    this.editor = this.#editor();
    this.emitted = this.#emitted();
    this.#fillButtons();
    if (channel instanceof CellChannel) this.#watch(channel);
    this.client = new Client(this.channel, {
      ready: (message) => this.looking.started(message),
      changed: (message) => this.files.changed(message),
      printed: ({ text }) => this.page.print(text),
      restarted: ({ reason }) => this.looking.restarted(reason),
      state: (isOpen) => {
        this.looking.connected(isOpen);
        if (!drafts) return;
        this.files.connected(isOpen);
        void drafts.connected(isOpen);
      },
    });
    const announce = (text: string) => (this.page.announcer.textContent = text);
    this.jobs = new Jobs(this.client, announce, () => void this.sharing.export());
    this.page.work.after(this.jobs.chip);
    document.title = `${main} · distal`;
    if (settings.start) void this.opening.begin(settings.start);
    if (!drafts) return;
    addEventListener("pagehide", () => drafts.keep());
    addEventListener("beforeunload", (event) => {
      drafts.keep();
      if (drafts.isHereOnly) event.preventDefault();
    });
  }

  save(): Promise<void> {
    return this.files.save();
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

  #watch(cell: CellChannel): void {
    cell.onProgress = (part) => {
      this.page.work.textContent = part < 1 ? `Loading Python: ${Math.round(100 * part)} %` : "Starting Python …";
    };
    // Python is large: it comes when somebody wants to change something.
    for (const kind of ["pointerdown", "focusin"]) {
      this.page.left.addEventListener(kind, () => void cell.start(), { once: true });
    }
  }

  #fillButtons(): void {
    const { commands, looking, page } = this;
    page.objects.onchange = () => looking.choose(page.objects.value);
    const ofStrip = ["layers", "keepCamera"];
    const own = commands.all.filter(({ id, button }) => button && !ofStrip.includes(id));
    page.buttons.append(...own.map(({ id }) => commands.button(id)));
  }
}
