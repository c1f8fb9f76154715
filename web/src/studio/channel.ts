/**
 * What carries messages to the worker and back.
 *
 * Input: requests. Output: responses, and whether anybody is there to answer. The local studio has a
 * socket to its server, which comes back by itself after the server has.
 */

import type { Request, Response } from "../generated/messages";

export interface Channel {
  /** Makes ready for requests, where that costs something; `ready` follows. */
  start?(): Promise<void>;
  post(request: Request): void;
  /** An answer could not be shown, though its form is right: whoever sent it is ended, where that can be. */
  refuse?(place: string): void;
  /** Called with every response. */
  onMessage: (response: Response) => void;
  /** Called when the connection opens or closes. */
  onState: (isOpen: boolean) => void;
}

const RETRY_MS = 1500;

export class SocketChannel implements Channel {
  onMessage: Channel["onMessage"] = () => {};
  onState: Channel["onState"] = () => {};
  #socket: WebSocket | null = null;

  constructor(readonly address: string) {
    this.#open();
  }

  post(request: Request): void {
    if (this.#socket?.readyState === WebSocket.OPEN) this.#socket.send(JSON.stringify(request));
  }

  #open(): void {
    const socket = new WebSocket(this.address);
    this.#socket = socket;
    socket.onopen = () => this.onState(true);
    socket.onmessage = ({ data }) => this.onMessage(JSON.parse(String(data)) as Response);
    socket.onclose = () => {
      this.onState(false);
      setTimeout(() => this.#open(), RETRY_MS);
    };
  }
}
