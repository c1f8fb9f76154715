/** What the page is given: the file that is edited, the gallery, and where Python is in the playground. */

import type { Payload } from "../payload";

export interface Example {
  name: string;
  title: string;
}

export interface Settings {
  main: string;
  folder: string;
  isNew: boolean;
  gallery: Example[];
  /** Of the page's policy, for the editor's style sheet. */
  nonce: string;
  version: string;
  /** Of the playground: the folder of Python's files, what it begins with, and what a new scene has. */
  python?: string;
  start?: Opened;
  starter?: Opened;
}

/** A scene that is opened; its picture needs no Python where there is a payload. */
export interface Opened {
  main: string;
  files: Record<string, string>;
  payload?: Payload;
}
