/**
 * The gallery: pictures of the examples, searched by typing.
 *
 * Input: examples. Output: a sheet; a press opens a copy of one. A picture is fetched when it comes near the
 * window; the text below it says what it shows.
 */

import { make } from "../dom";
import type { Example } from "./settings";
import { sheet } from "./sheets";

export function openGallery(examples: readonly Example[], open: (name: string) => void): void {
  const search = make("input", { type: "search", placeholder: "Search", "aria-label": "Search the gallery" });
  // On a phone the keyboard would cover the pictures.
  search.autofocus = matchMedia("(hover: hover)").matches;
  const none = make("p", { className: "quiet", role: "status" });
  const list = make("ul", { className: "posters" });
  const cards = examples.map((example) => {
    const { name, title } = example;
    const image = make("img", { alt: "", width: 320, height: 240, loading: "lazy", decoding: "async" });
    image.src = `gallery/${encodeURIComponent(name)}.webp`;
    const heading = make("strong", {}, name.replaceAll("_", " "));
    const button = make("button", { type: "button" }, image, heading, make("span", {}, title));
    button.onclick = () => {
      dialog.close();
      open(name);
    };
    list.append(make("li", {}, button));
    return [button.parentElement!, `${name} ${heading.textContent} ${title}`.toLowerCase()] as const;
  });
  search.oninput = () => {
    const words = search.value.toLowerCase().split(/\s+/);
    for (const [card, text] of cards) card.hidden = !words.every((word) => text.includes(word));
    none.textContent = cards.every(([card]) => card.hidden) ? "No example of that name." : "";
  };
  const dialog = sheet("Gallery", search, none, list);
  dialog.classList.add("wide");
}
