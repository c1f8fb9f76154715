/**
 * Requests with their answers.
 *
 * Input: requests without numbers. Output: for each the one message that answers it; null where nobody
 * will. All other messages are events.
 */

import type { Changed, Printed, Progress, Ready, Request, Response, Restarted } from "../generated/messages";
import type { Channel } from "./channel";

/** A request without its number, which the client gives. */
export type Asked = Request extends infer R ? (R extends Request ? Omit<R, "id"> : never) : never;

export interface ClientEvents {
  ready(message: Ready): void;
  changed(message: Changed): void;
  printed(message: Printed): void;
  restarted(message: Restarted): void;
  /** Whether somebody is there. */
  state(isOpen: boolean): void;
}

interface Waiting {
  resolve(response: Response | null): void;
  progress(message: Progress): void;
}

export class Client {
  #count = 0;
  #waiting = new Map<number, Waiting>();

  constructor(
    readonly channel: Channel,
    readonly events: ClientEvents,
  ) {
    channel.onMessage = (message) => this.#received(message);
    channel.onState = (isOpen) => {
      if (!isOpen) this.#giveUp();
      events.state(isOpen);
    };
  }

  /** Resolves to the answer, or to null where the request is lost. */
  ask(request: Asked): Promise<Response | null> {
    return this.begin(request).answer;
  }

  /** As `ask`, with the request's number and what is told before its answer. */
  begin(
    request: Asked,
    progress: Waiting["progress"] = () => {},
  ): { id: number; answer: Promise<Response | null> } {
    const id = ++this.#count;
    // What is not sent has no answer, also not from the server that comes next.
    if (this.channel.isOpen === false) return { id, answer: Promise.resolve(null) };
    const answer = new Promise<Response | null>((resolve) => {
      this.#waiting.set(id, { resolve, progress });
      this.channel.post({ ...request, id } as Request);
    });
    return { id, answer };
  }

  /** Sends a request that has no answer. */
  tell(request: Asked): void {
    this.channel.post({ ...request, id: ++this.#count } as Request);
  }

  #giveUp(): void {
    const waiting = [...this.#waiting.values()];
    this.#waiting.clear();
    for (const { resolve } of waiting) resolve(null);
  }

  #received(message: Response): void {
    switch (message.kind) {
      case "ready":
      case "changed":
      case "printed":
        return this.events[message.kind](message as never);
      case "restarted":
        this.events.restarted(message);
        return this.#answer(message.id ?? -1, null);
      case "progress":
        return this.#waiting.get(message.id)?.progress(message);
      default:
        return this.#answer(message.id, message);
    }
  }

  #answer(id: number, message: Response | null): void {
    this.#waiting.get(id)?.resolve(message);
    this.#waiting.delete(id);
  }
}
