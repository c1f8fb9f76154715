/**
 * The page of `distal studio lesson.md`: the lesson in a frame, made again by the server, and what it says.
 *
 * Input: messages of the server. Output: the newest page at the place where one has read, and a line above it.
 */

import { Access, NOT_KEPT, REASONS } from "./access";

const line = document.querySelector("p")!;
const frame = document.querySelector("iframe")!;
let address = "";
let place = 0;

function tell(text: string): void {
  line.textContent = text;
  line.hidden = !text;
}

frame.onload = () => {
  document.title = frame.contentDocument?.title || document.title;
  frame.contentWindow?.scrollTo(0, place);
};
const access = new Access();
access.onOpen = (settings) => {
  const { name } = settings as { name: string };
  frame.title = name;
  if (!address) document.title = name;
};
access.onText = (data) => {
  const state = JSON.parse(data) as { text: string; address: string };
  tell(state.text || (access.isKept ? "" : NOT_KEPT));
  if (!state.address || state.address === address) return;
  address = state.address;
  place = frame.contentWindow?.scrollY ?? 0;
  frame.src = address;
};
access.onClosed = (reason) => tell(REASONS[reason]);
access.start();
