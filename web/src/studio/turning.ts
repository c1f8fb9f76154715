/**
 * Literals of the code while a hand turns them: the picture follows, and the text is written at the end.
 *
 * Input: a literal with its values, the end of a turn. Output: requests, one at a time, and at last edits. They are
 * those of the text in which the turn began: what is typed before they are there stays.
 */

import type { Change, Edit, LiteralValue, SourceLiteral } from "../generated/messages";
import { moved } from "./edits";
import type { Studio } from "./studio";

/** What a hand is turning. */
interface Turn {
  literal: SourceLiteral;
  /** The texts in which the literal is where it says. */
  files: Record<string, string>;
  value: LiteralValue;
  /** The name of the program's input that it is; of a number in a `@func`. */
  held: string | null;
  edits: Edit[];
  isDone: boolean;
  isBusy: boolean;
  /** The value of the last answer. */
  answered: LiteralValue | null;
}

export class Turning {
  #turn: Turn | null = null;
  /** Turns of other literals, which begin once this one is written. */
  #next: Turn[] = [];

  constructor(readonly studio: Studio) {}

  get isOn(): boolean {
    return this.#turn !== null;
  }

  /** Forgets what is turned: nobody answers any more. */
  drop(): void {
    this.#turn = null;
    this.#next = [];
  }

  turned(literal: SourceLiteral, value: LiteralValue): void {
    const { costs, texts } = this.studio;
    const last = this.#next.at(-1) ?? this.#turn;
    const isSame = last?.literal.file === literal.file && last.literal.start === literal.start;
    const turn: Turn = isSame
      ? last
      : { literal, files: texts.files, value, held: null, edits: [], isDone: false, isBusy: false, answered: null };
    turn.value = value;
    turn.isDone = false;
    if (!this.#turn) this.#turn = turn;
    else if (!isSame) {
      last!.isDone = true;
      this.#next.push(turn);
    }
    costs.changed();
    void this.#turnOn();
  }

  released(): void {
    const turn = this.#next.at(-1) ?? this.#turn;
    if (!turn) return;
    turn.isDone = true;
    void this.#turnOn();
  }

  /** While a literal is turned, the worker's last answer decides when the next request goes out. */
  async #turnOn(): Promise<void> {
    const turn = this.#turn;
    if (!turn || turn.isBusy) return;
    turn.isBusy = true;
    const { client, looking, picture } = this.studio;
    const { files } = turn;
    if (turn.literal.way === "hold" && turn.answered === null) await this.#hold(turn);
    while (!same(turn.answered, turn.value) || (turn.isDone && this.#turn === turn)) {
      if (turn.held && !turn.isDone) {
        turn.answered = turn.value;
        picture.setNumber(turn.held, turn.value as number);
        break;
      }
      const { value } = turn;
      const changes = [changeOf(turn, value)];
      const asked = { ...looking.source, files, known: looking.key, changes, lean: true, guided: false };
      const answer = await client.ask({ kind: "look", ...asked });
      turn.answered = value;
      if (!answer || answer.kind === "dropped") {
        if (turn.isDone) this.#end(turn);
        break;
      }
      if ("edits" in answer) turn.edits = answer.edits;
      await looking.take(answer, -1);
      if (this.#turn !== turn) break;
      if (turn.isDone && same(turn.answered, turn.value)) {
        this.#end(turn);
        this.#write(turn);
      }
    }
    turn.isBusy = false;
    if (this.#turn !== turn) void this.#turnOn();
  }

  #end(turn: Turn): void {
    if (this.#turn === turn) this.#turn = this.#next.shift() ?? null;
  }

  /** Writes what was turned into the text that is there now. */
  #write({ edits, files }: Turn): void {
    const { looking, page, texts } = this.studio;
    const [file = ""] = edits.map((edit) => edit.file);
    const isAsIt = texts.files === files;
    const now = isAsIt ? edits : moved(edits, files[file] ?? "", texts.files[file] ?? "");
    if (isAsIt) looking.settle();
    else looking.look();
    if (now) looking.apply(now);
    else page.tell("What was turned is not written: its place in the text has changed meanwhile.", ["Close", () => {}]);
  }

  /** A number of a `@func` becomes an input of the program, if it can. */
  async #hold(turn: Turn): Promise<void> {
    const { client, looking } = this.studio;
    const { file, start, end, type } = turn.literal;
    if (type !== "number") return;
    const answer = await client.ask({ kind: "hold", ...looking.source, files: turn.files, file, start, end });
    if (answer?.kind !== "scene" || !answer.held || this.#turn !== turn) return;
    await looking.showScene(answer);
    turn.held = answer.held;
  }
}

function changeOf({ literal }: Turn, value: LiteralValue): Change {
  const { file, start, end } = literal;
  return { what: "literal", file, start, end, value, name: null, text: null };
}

function same(a: LiteralValue | null, b: LiteralValue | null): boolean {
  return JSON.stringify(a) === JSON.stringify(b);
}
