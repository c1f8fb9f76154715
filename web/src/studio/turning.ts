/**
 * Literals of the code while a hand turns them: the picture follows, and the text is written at the end.
 *
 * Input: a literal with its values, the end of a turn. Output: requests, one at a time, and at last edits.
 */

import type { Change, Edit, LiteralValue, SourceLiteral } from "../generated/messages";
import type { Studio } from "./studio";

/** What a hand is turning. */
interface Turn {
  literal: SourceLiteral;
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

  constructor(readonly studio: Studio) {}

  get isOn(): boolean {
    return this.#turn !== null;
  }

  /** Forgets what is turned: nobody answers any more. */
  drop(): void {
    this.#turn = null;
  }

  turned(literal: SourceLiteral, value: LiteralValue): void {
    this.#turn ??= { literal, value, held: null, edits: [], isDone: false, isBusy: false, answered: null };
    this.#turn.value = value;
    this.#turn.isDone = false;
    this.studio.costs.changed();
    void this.#turnOn();
  }

  released(): void {
    if (!this.#turn) return;
    this.#turn.isDone = true;
    void this.#turnOn();
  }

  /** While a literal is turned, the worker's last answer decides when the next request goes out. */
  async #turnOn(): Promise<void> {
    const turn = this.#turn;
    if (!turn || turn.isBusy) return;
    turn.isBusy = true;
    const { client, looking, picture } = this.studio;
    if (turn.literal.way === "hold" && turn.answered === null) await this.#hold(turn);
    while (!same(turn.answered, turn.value) || (turn.isDone && this.#turn === turn)) {
      if (turn.held && !turn.isDone) {
        turn.answered = turn.value;
        picture.setNumber(turn.held, turn.value as number);
        break;
      }
      const { value } = turn;
      const changes = [changeOf(turn, value)];
      const asked = { ...looking.source, known: looking.key, changes, lean: true, guided: false };
      const answer = await client.ask({ kind: "look", ...asked });
      turn.answered = value;
      if (!answer || answer.kind === "dropped") {
        if (turn.isDone) this.#turn = null;
        break;
      }
      if ("edits" in answer) turn.edits = answer.edits;
      await looking.take(answer, -1);
      if (turn.isDone && same(turn.answered, turn.value)) {
        this.#turn = null;
        looking.settle();
        looking.apply(turn.edits);
      }
    }
    turn.isBusy = false;
  }

  /** A number of a `@func` becomes an input of the program, if it can. */
  async #hold(turn: Turn): Promise<void> {
    const { client, looking } = this.studio;
    const { file, start, end, type } = turn.literal;
    if (type !== "number") return;
    const answer = await client.ask({ kind: "hold", ...looking.source, file, start, end });
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
