/**
 * The sheet of links: text, QR code, or the HTML of a frame.
 *
 * Input: a link with the code, and one that has values, camera and time too. Output: a dialog.
 */

import { encode } from "uqr";
import { make } from "../dom";
import { sheet } from "./sheets";

/** Characters of a link that a code holds: of more, a phone would show squares smaller than two pixels. */
export const LONGEST_CODE = 2000;
/** Squares of white around a code, as its standard demands. */
const MARGIN = 4;
/** Pixels of a square at most, and of a code. A square has a whole number of them, so that all are equal. */
const SQUARE_PX = 4;
const CODE_PX = 480;

export function openShare(plain: string, full: string, title: string): void {
  const field = make("input", { type: "text", readOnly: true, "aria-label": "Link" });
  const isFull = make("input", { type: "checkbox" });
  const isFrame = make("input", { type: "checkbox" });
  const length = make("p", { className: "quiet" });
  const copied = make("button", { type: "button", autofocus: true }, "Copy");
  const code = make("div", { className: "code" });
  const show = () => {
    const link = isFull.checked ? full : plain;
    field.value = isFrame.checked ? frameOf(link, title) : link;
    length.textContent = `${field.value.length.toLocaleString("en")} characters. The link has the code in it: nothing is stored elsewhere.`;
    copied.textContent = "Copy";
    code.replaceChildren(codeOf(link));
  };
  isFull.onchange = isFrame.onchange = show;
  copied.onclick = async () => {
    field.select();
    await navigator.clipboard?.writeText(field.value).catch(() => document.execCommand("copy"));
    copied.textContent = "Copied";
  };
  show();
  const option = make("label", { className: "option" }, isFull, "With the sliders' values, the camera and the time");
  const frame = make("label", { className: "option" }, isFrame, "As a frame: the HTML that shows it in another page");
  sheet("Share", make("div", { className: "choices" }, field, copied), option, frame, length, code);
}

/** The QR code of a link, or a sentence where it is too long for one. */
function codeOf(link: string): Element {
  if (link.length > LONGEST_CODE) {
    const most = LONGEST_CODE.toLocaleString("en");
    return make("p", { className: "quiet" }, `No QR code: a phone's camera reads at most ${most} characters. Copy the link.`);
  }
  const { data, size } = encode(link, { ecc: "L", border: 0 });
  const space = "http://www.w3.org/2000/svg";
  const drawing = document.createElementNS(space, "svg");
  const whole = size + 2 * MARGIN;
  drawing.setAttribute("viewBox", `${-MARGIN} ${-MARGIN} ${whole} ${whole}`);
  drawing.setAttribute("shape-rendering", "crispEdges");
  drawing.style.width = `${whole * squareOf(whole)}px`;
  drawing.setAttribute("role", "img");
  drawing.setAttribute("aria-label", "QR code of the link");
  const squares = document.createElementNS(space, "path");
  squares.setAttribute("d", data.map((row, y) => runsOf(row, y)).join(""));
  drawing.append(squares);
  return drawing;
}

/** Pixels of a square, where the sheet has room for so many squares in a row. */
function squareOf(whole: number): number {
  const room = Math.min(CODE_PX, document.documentElement.clientWidth - 60);
  return Math.min(SQUARE_PX, Math.max(1, Math.floor(room / whole)));
}

/** The dark squares of a row, neighbors as one rectangle. */
function runsOf(row: readonly boolean[], y: number): string {
  let path = "";
  for (let x = 0; x < row.length; x++) {
    if (!row[x]) continue;
    const from = x;
    while (row[x + 1]) x++;
    path += `M${from} ${y}h${x + 1 - from}v1H${from}z`;
  }
  return path;
}

/** The HTML of a frame that shows a link. */
function frameOf(link: string, title: string): string {
  const [address, code] = link.split("#");
  const frame = make("iframe", { src: `${address!.split("?")[0]}?embed#${code}`, title, width: "800", height: "460" });
  frame.setAttribute("loading", "lazy");
  frame.style.border = "0";
  return frame.outerHTML;
}
