/**
 * The commands of the app, each declared once: what it is called, its key, its button, what it does.
 *
 * Input: the studio. Output: a list. The palette, the buttons, the keys and the list of keys are made from
 * it (`command_keys.ts`, `palette.ts`, `sheets.ts`); a command that is not possible now says so.
 */

import { redo, undo } from "@codemirror/commands";
import { startCompletion } from "@codemirror/autocomplete";
import { openSearchPanel } from "@codemirror/search";
import type { EditorView } from "@codemirror/view";
import { SCHEMES, schemeNow, useScheme } from "./appearance";
import { openGallery } from "./gallery";
import { dialAtCaret } from "./literals";
import { openPalette } from "./palette";
import { openScenes } from "./scenes/list";
import { openVersions } from "./scenes/versions";
import { EXPORTS, help } from "./sheets";
import type { Studio } from "./studio";

export interface Command {
  id: string;
  /** What it does, as the palette and the list of keys say it. */
  text: string;
  /** As CodeMirror writes keys; "Mod" is Ctrl, or Command on a Mac. */
  keys?: string;
  /** Whether the keys are those of the code, and something else elsewhere. */
  isOfCode?: true;
  /** The text of its button, if it has one; the hint is its longer name. */
  button?: string;
  /** A drawing before the text, which alone stays on a phone. */
  icon?: string;
  hint?: string;
  /** Other words that it is found by. */
  words?: string;
  /** Left out of what only tells of keys that others have. */
  act?: () => void;
  isPossible?: () => boolean;
  /** Whether it is on, of one that is turned on and off. */
  isOn?: () => boolean;
}

/** Commands that are always there, in the order of the palette and of the buttons. */
export function commandsOf(studio: Studio): Command[] {
  return [...ofApp(studio), ...ofCode(studio), ...ofPicture(studio), ...ofAppearance()];
}

/** Commands for what is there now: files, views, formats, examples. */
export function commandsNow(studio: Studio): Command[] {
  const { looking, opening, page, picture, settings, sharing, tabs, texts } = studio;
  const { player } = picture;
  const views = player?.payload.views ?? [];
  const objects = [...page.objects.options].map(({ value }) => value);
  return [
    ...texts.names.map((name) => command(`file:${name}`, `Go to ${name}`, () => tabs.goToFile(name), "file")),
    ...(views.length < 2 ? [] : views).map(({ name, label }) =>
      command(`view:${name}`, `View: ${label}`, () => player!.setView(name), "layer", () => player!.view === name),
    ),
    ...(objects.length < 2 ? [] : objects).map((name) =>
      command(`object:${name}`, `Picture of the file: ${name}`, () => looking.choose(name)),
    ),
    ...sharing.formats.map((format) =>
      command(
        `export:${format}`,
        `Export: ${EXPORTS[format] ?? format}`,
        () => void sharing.exportAs(format).then((text) => page.tell(text, ["Close", () => {}])),
        `${format} download`,
      ),
    ),
    ...settings.gallery.map(({ name, title }) =>
      command(`example:${name}`, `Open example ${name.replaceAll("_", " ")}`, () => void opening.open(name), title),
    ),
  ];
}

function command(id: string, text: string, act: () => void, words = "", isOn?: () => boolean): Command {
  return { id, text, act, words, ...(isOn && { isOn }) };
}

function ofApp(studio: Studio): Command[] {
  const { settings, sharing } = studio;
  const isLocal = !settings.python;
  return [
    {
      id: "commands",
      text: "Find a command",
      keys: "Mod-k",
      button: "Commands",
      icon: "M8.5 14a5.5 5.5 0 1 0 0-11 5.5 5.5 0 0 0 0 11zM12.5 12.5 17 17",
      act: () => openPalette([...studio.commands.all, ...commandsNow(studio)].filter(({ id }) => id !== "commands")),
    },
    ...ofScenes(studio),
    {
      id: "gallery",
      text: "Open the gallery",
      button: "Gallery",
      icon: "M3 4h14v12H3zM3 13l4-4 4 4 2.5-2.5L17 14M13 7.5h.2",
      hint: isLocal ? "Open a copy of an example" : "Open an example as a scene of its own",
      words: "examples pictures",
      act: () => openGallery(settings.gallery, (name) => void studio.opening.open(name)),
    },
    {
      id: "cost",
      text: "Show what each line costs",
      button: "Cost",
      hint: "What each line costs: runs, work, time",
      words: "count speed runs work time",
      act: () => studio.costs.toggle(),
      isOn: () => studio.costs.isOpen,
    },
    {
      id: "export",
      text: "Export",
      button: "Export",
      hint: "Make a page or a shader of it",
      words: "download page shader html glsl wgsl",
      act: () => void sharing.export(),
    },
    {
      id: "save",
      text: isLocal ? "Save the files" : "Keep the text in this browser",
      keys: "Mod-s",
      ...(isLocal && { button: "Save" }),
      act: () => void studio.save(),
    },
    isLocal ? versionsOf(studio) : shareOf(studio),
    {
      id: "help",
      text: "Show all keys",
      button: "?",
      hint: "Keys",
      words: "help shortcuts version",
      act: () => help(studio.commands.all, settings.version),
    },
  ];
}

function ofScenes(studio: Studio): Command[] {
  const { opening, scenes } = studio;
  if (!scenes || scenes.isFrame) return [];
  return [
    {
      id: "scenes",
      text: "Your scenes",
      button: "Scenes",
      hint: "Your scenes: open, rename, duplicate, delete, save all",
      icon: "M3 4h6v5H3zM11 4h6v5h-6zM3 11h6v5H3zM11 11h6v5h-6z",
      words: "list files saved open zip",
      act: () => openScenes(studio),
    },
    { id: "new", text: "New scene", words: "empty file", act: () => void opening.goTo("#new") },
    {
      id: "fork",
      text: "Edit a copy as a scene of your own",
      words: "fork duplicate copy",
      act: () => void scenes.fork(),
    },
    {
      id: "rename",
      text: "Rename the scene",
      words: "name title",
      act: () => scenes.heading.edit(),
      isPossible: () => !scenes.isReader,
    },
    {
      id: "versions",
      text: "Versions of the scene",
      words: "history restore before",
      act: () => void openVersions(studio, scenes.record!),
      isPossible: () => scenes.isKept,
    },
  ];
}

function versionsOf(studio: Studio): Command {
  return {
    id: "versions",
    text: "Show the versions of this file",
    words: "history backup restore earlier draft",
    act: () => void studio.versions.open(studio.editor.name),
  };
}

function shareOf({ sharing }: Studio): Command {
  return {
    id: "share",
    text: "Share a link that has the code in it",
    button: "Share",
    words: "qr code frame embed",
    act: () => void sharing.share(),
  };
}

function ofCode(studio: Studio): Command[] {
  const inCode = (act: (view: EditorView) => unknown) => () => {
    studio.editor.view.focus();
    act(studio.editor.view);
  };
  return [
    {
      id: "run",
      text: "Run the code now",
      keys: "Mod-Enter",
      act: () => {
        studio.looking.run();
        void studio.scenes?.write("run");
      },
    },
    {
      id: "dial",
      text: "Turn the number, color or switch at the caret",
      keys: "Mod-.",
      isOfCode: true,
      words: "dial slider literal",
      act: inCode(dialAtCaret),
    },
    { id: "undo", text: "Undo", keys: "Mod-z", isOfCode: true, act: inCode(undo) },
    { id: "redo", text: "Redo", keys: "Mod-y", isOfCode: true, act: inCode(redo) },
    { id: "find", text: "Search in the code", keys: "Mod-f", isOfCode: true, words: "find replace", act: inCode(openSearchPanel) },
    { id: "complete", text: "Complete a name", keys: "Ctrl-Space", isOfCode: true, act: inCode(startCompletion) },
    {
      id: "mistake",
      text: "Go to the next mistake",
      keys: "F8",
      words: "error problem",
      act: () => studio.tabs.nextMistake(),
      isPossible: () => studio.tabs.hasMistakes,
    },
    { id: "parts", text: "Go to the next part of the page", keys: "F6", act: () => studio.page.nextPart() },
    { id: "leave", text: "Leave the code", keys: "Escape, then Tab" },
    {
      id: "text",
      text: "Show the emitted text",
      words: "shader glsl wgsl target",
      act: () => studio.tabs.toggleText(),
      isOn: () => studio.tabs.isText,
    },
    {
      id: "source",
      text: "Save a copy of the code as a file",
      words: "download py python",
      act: () => studio.sharing.saveSource(),
    },
  ];
}

function ofPicture({ picture }: Studio): Command[] {
  const player = () => picture.player;
  return [
    {
      id: "layers",
      text: "Show small pictures of all views",
      button: "Layers",
      act: () => picture.toggleLayers(),
      isOn: () => picture.layers.isOpen,
      isPossible: () => (player()?.payload.views.length ?? 0) > 1,
    },
    {
      id: "keepCamera",
      text: "Write the camera's place into the code",
      button: "Keep camera",
      words: "keep",
      act: () => void picture.keepCamera(),
      isPossible: () => !!player()?.camera?.moved,
    },
    {
      id: "resetCamera",
      text: "Put the camera back",
      words: "reset",
      act: () => player()!.resetCamera(),
      isPossible: () => !!player()?.camera?.moved,
    },
    {
      id: "resetValues",
      text: "Put all sliders back",
      words: "reset values parameters",
      act: () => player()!.resetAll(),
      isPossible: () => !!player()?.payload.parameters.length,
    },
    {
      id: "play",
      text: "Play or pause the time",
      words: "animation stop",
      act: () => player()!.toggle(),
      isPossible: () => !!player()?.payload.time.animated,
    },
    {
      id: "picture",
      text: "Save a picture",
      words: "png screenshot download image",
      act: () => void player()!.saveScreenshot(),
      isPossible: () => !!player(),
    },
    {
      id: "full",
      text: "Show the picture on the full screen",
      words: "fullscreen",
      act: () => player()!.toggleFullScreen(),
      isPossible: () => !!player() && document.fullscreenEnabled,
    },
  ];
}

function ofAppearance(): Command[] {
  return SCHEMES.map(([scheme, text]) => ({
    id: `colors:${scheme}`,
    text,
    words: "theme dark light night appearance",
    act: () => useScheme(scheme),
    isOn: () => schemeNow() === scheme,
  }));
}
