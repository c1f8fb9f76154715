/**
 * The script of a page to inspect: the player, with a plane that cuts the scene open and a ruler.
 *
 * Input: the payloads of the document, with the programs of an inspection. Output: players, and groups in
 * their panels. It uses what the player gives to editors: other programs and numbers in place.
 */

import { make } from "../dom";
import { HELP, KEYS } from "../generated/bindings";
import { INSPECT_HELP, INSPECT_KEYS } from "../generated/inspect";
import { programsOf, type Payload, type Program, type View } from "../payload";
import { Player } from "../player";
import { save } from "../taking";
import { drawRuler } from "./drawing";
import { Inspection, type Inspecting } from "./inspection";
import { inspectorOf } from "./panel";
import { Sight } from "./sight";

type Inspected = Payload & { inspect: Inspecting };

Object.assign(KEYS, INSPECT_KEYS);
(HELP as unknown[]).splice(-3, 0, ...INSPECT_HELP);

for (const script of document.querySelectorAll('script[type="application/distal+json"]')) {
  const host = script.previousElementSibling;
  if (!(host instanceof HTMLElement) || !host.matches("[data-distal]")) continue;
  // One that is broken is not the others' end.
  await mount(host, JSON.parse(script.textContent ?? "") as Inspected).catch(reportError);
}

async function mount(host: HTMLElement, payload: Inspected): Promise<void> {
  // Unpacked once: what is drawn, kept and read are the same programs.
  const data = await programsOf(payload);
  const player = new Player(host, { ...payload, programs: { encoding: "plain", data } });
  const end = player.on("frame", () => {
    performance.mark("distal:first-frame");
    end();
  });
  const inspection = inspectionOf(player, data, payload.inspect);
  Object.assign(host, { distal: Object.assign(player, { inspection }) });
}

/** Adds what cuts a player's scene open and measures it. */
function inspectionOf(player: Player, data: Program[], facts: Inspecting): Inspection {
  const sight = new Sight(player);
  const { views } = player.payload;
  let loading = Promise.resolve();
  const use = async () => {
    const isCut = !!inspection.plane;
    if (player.payload.views !== viewsOf(isCut)) {
      await player.load({ ...player.payload, views: viewsOf(isCut) });
    }
    player.setNumbers(inspection.numbers as Parameters<Player["setNumbers"]>[0]);
  };
  // A cut scene has direct light: nothing would be seen while it is moved.
  const cutViews = views.map((view): View => {
    const program = facts.cuts[view.name];
    const { film: _, ...rest } = view;
    return program === undefined ? view : { ...rest, program };
  });
  const viewsOf = (isCut: boolean) => (isCut ? cutViews : views);
  const inspection = new Inspection(facts, {
    get size() {
      return sight.frame().size;
    },
    rest: async () => player.camera?.rest(),
    changed: () => (loading = loading.then(use)),
    async read(program, given, count) {
      const source = data[program];
      const numbers = { ...inspection.numbers, ...given };
      const bytes = source && (await player.drawn(source, numbers, [count, 1]));
      if (!bytes) return null;
      const view = new DataView(bytes.buffer, bytes.byteOffset);
      return Array.from({ length: count }, (_, i) => view.getFloat32(4 * i, true));
    },
  });
  Object.assign(player.actions, {
    section: () => !inspection.facts.why && (inspection.next(), true),
    sectionSide: () => !!inspection.plane && (inspection.turn(), true),
    ruler: () => (inspection.measure(), true),
  });
  player.on("frame", inspectorOf(player.host.shadowRoot!, inspection, sight));
  player.on("parameter", () => void inspection.refresh());
  player.saveScreenshot = () => saveWithRuler(player, inspection, sight);
  return inspection;
}

/** Saves the picture as it is seen: with the ruler over it. */
async function saveWithRuler(player: Player, inspection: Inspection, sight: Sight): Promise<void> {
  const picture = await player.screenshot();
  if (!picture) return;
  const { name } = player.payload;
  const title = `${name}${player.view === "color" ? "" : ` ${player.view}`}`;
  const { size, offset } = sight.whole();
  const ruler = inspection.ends.length === 2 && (await inspection.seen(size));
  if (!ruler) return save(picture, title);
  const bitmap = await createImageBitmap(picture);
  const canvas = make("canvas", { width: bitmap.width, height: bitmap.height });
  const context = canvas.getContext("2d")!;
  context.drawImage(bitmap, 0, 0);
  drawRuler(context, ruler, offset, sight.ratio);
  canvas.toBlob((made) => made && save(made, title));
}
