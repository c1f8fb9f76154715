/**
 * What carries messages to the worker and back.
 *
 * Input: requests. Output: responses, and whether anybody is there to answer. The local studio has a
 * socket to its server, which comes back by itself after the server has.
 */

import type { Request, Response } from "../generated/messages";
import type { Access } from "./access";

export interface Channel {
  /** Makes ready for requests, where that costs something; `ready` follows. */
  start?(): Promise<void>;
  post(request: Request): void;
  /** An answer could not be shown, though its form is right: whoever sent it is ended, where that can be. */
  refuse?(place: string): void;
  /** False while another program may answer at the page's address; undefined where there is no server. */
  readonly isOpen?: boolean;
  /** Called with every response. */
  onMessage: (response: Response) => void;
  /** Called when the connection opens or closes. */
  onState: (isOpen: boolean) => void;
}

/** The channel of the local studio. */
export class SocketChannel implements Channel {
  onMessage: Channel["onMessage"] = () => {};
  onState: Channel["onState"] = () => {};

  constructor(readonly access: Access) {
    access.onText = (text) => this.onMessage(JSON.parse(text) as Response);
  }

  get isOpen(): boolean {
    return this.access.isOpen;
  }

  post(request: Request): void {
    this.access.send(JSON.stringify(request));
  }
}
