// The search of the site: words in titles count most, then those in texts.

(() => {
  const form = document.querySelector(".search");
  const field = form.querySelector("input");
  const hits = form.querySelector(".hits");
  const rows = window.SEARCHED ?? [];
  const MOST = 8;

  function found(words) {
    const scored = rows.map((row) => {
      const [title, page, , text] = row.map((part) => part.toLowerCase());
      let score = 0;
      for (const word of words) {
        const here = (title.includes(word) ? 8 : 0) + (page.includes(word) ? 3 : 0) + (text.includes(word) ? 1 : 0);
        if (!here) return [0, row];
        score += here + (title.startsWith(word) ? 4 : 0);
      }
      return [score, row];
    });
    return scored.filter(([score]) => score).sort((a, b) => b[0] - a[0]).slice(0, MOST);
  }

  function show() {
    const words = field.value.toLowerCase().split(/\s+/).filter(Boolean);
    const list = words.length ? found(words) : [];
    hits.hidden = !words.length;
    hits.replaceChildren(
      ...list.map(([, [title, page, address]]) => {
        const link = document.createElement("a");
        link.href = form.dataset.up + address;
        const where = document.createElement("span");
        where.textContent = page === title ? "" : page;
        link.append(title, where);
        return link;
      }),
    );
    if (words.length && !list.length) hits.textContent = "Nothing found.";
  }

  field.addEventListener("input", show);
  field.addEventListener("focus", show);
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    hits.querySelector("a")?.click();
  });
  form.addEventListener("keydown", (event) => {
    if (event.key === "Escape") {
      hits.hidden = true;
      field.focus();
    }
    const links = [field, ...hits.querySelectorAll("a")];
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    links[(links.indexOf(document.activeElement) + step + links.length) % links.length].focus();
  });
  document.addEventListener("click", (event) => {
    if (!form.contains(event.target)) hits.hidden = true;
  });
})();
