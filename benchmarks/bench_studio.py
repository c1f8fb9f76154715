"""The studio and the playground: how long until something is to be seen.

    python benchmarks/bench_studio.py [--site FOLDER]

Prints a table of medians, by the clock of an otherwise quiet machine: the first picture, from a key
to the new text, pictures a second while a number is dragged, a worker that loops; with a built site
the same for Python in the browser. The browser draws in software; what is counted where the GPU
would be the limit are messages, not pixels.
"""

from __future__ import annotations

import argparse
import functools
import gzip
import http.server
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from distal.editor.local.server import APP  # noqa: E402
from distal.example_files import gallery  # noqa: E402
from tests.browser import SWIFTSHADER, browser  # noqa: E402

# An installed package has bytecode, wherever the checkout has none.
COMPILED = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
COMPILED.setdefault("PYTHONPYCACHEPREFIX", str(Path(tempfile.gettempdir()) / "distal_bytecode"))
RUNS = 5
DRAG_S = 2.0
NUMBER = re.compile(r"(?<![\w.#\"])\d+\.\d+(?![\w.])")
_PLAYER = "() => document.querySelector('.picture .host')?.distal"
_FRAME = "() => / ms| fps/.test(document.querySelector('.drawn').textContent)"
_IDLE = "() => /\\d ms$/.test(document.querySelector('.work').textContent)"
_ASK = """async ([text, count, source]) => {
  const all = [...text.matchAll(new RegExp(source, "g"))];
  const times = [];
  for (let i = 0; i < count; i++) {
    const found = all[(7 * i + 3) % all.length];
    const changed = (Number(found[0]) * 1.01 + 0.01).toFixed(4);
    const end = found.index + found[0].length;
    const files = { "scene.py": text.slice(0, found.index) + changed + text.slice(end) };
    const begin = performance.now();
    const answer = await studio.client.ask(
      { kind: "look", revision: 1, files, main: "scene.py", guided: false });
    if (answer?.kind === "scene") times.push(performance.now() - begin);
  }
  return times;
}"""
_DRAG = """async ([text, seconds]) => {
  const ask = (more) => studio.client.ask({ kind: "look", revision: 1, guided: false,
    files: { "scene.py": text }, main: "scene.py", ...more });
  const first = await ask({});
  const isPlain = ({ way, type, whole, call }) =>
    way === "numbers" && type === "number" && !whole && /translate|Sphere|rotate/.test(call);
  const all = first.literals.filter(isPlain);
  const { start, end, value: old } = all[Math.floor(all.length / 2)];
  let known = first.key;
  let count = 0;
  let begin = 0;
  for (let turn = 0; turn === 0 || performance.now() - begin < 1000 * seconds; turn++) {
    const value = old + 0.001 * (turn + 1);
    const place = { file: "scene.py", start, end, name: null, text: null };
    const changes = [{ what: "literal", ...place, value }];
    const answer = await ask({ known, changes, lean: true });
    known = answer.key ?? known;
    // The first may be a new program: numbers that were equal are two.
    if (turn === 0) begin = performance.now();
    else if (answer.kind === "numbers") count += 1;
  }
  return count / ((performance.now() - begin) / 1000);
}"""


@contextmanager
def local(scene: str) -> Iterator[tuple[str, float]]:
    """The studio as a process: its address, and when it was started."""
    begin = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        process = subprocess.Popen(
            [sys.executable, "-m", "distal.cli", "studio", scene, "--no-browser"],
            cwd=folder,
            env=COMPILED,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert process.stdout is not None
        try:
            yield process.stdout.readline().split(" at ")[1].strip(), begin
        finally:
            process.terminate()
            process.wait()


@contextmanager
def served(folder: Path) -> Iterator[str]:
    """The playground of a built site."""

    class Quiet(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *_: object) -> None:
            pass

    handler = functools.partial(Quiet, directory=str(folder))
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}/playground/"
    server.shutdown()


def page_of(address: str) -> Any:
    """A page; the first one starts the browser, which is not measured."""
    page = browser(*SWIFTSHADER).new_context(viewport={"width": 1180, "height": 700}).new_page()
    page.set_default_timeout(120_000)
    page.goto(address)
    return page


def median(measure: Callable[[], float], runs: int = RUNS) -> float:
    """Return the median of several measurements."""
    return statistics.median(measure() for _ in range(runs))


def first_picture() -> float:
    """Seconds from the command to the first frame of the raymarcher."""
    with local("example:raymarcher") as (address, begin):
        page = page_of(address)
        page.wait_for_function(_FRAME)
        taken = time.perf_counter() - begin
        page.context.close()
    return taken


def row(name: str, value: float, unit: str, goal: str) -> None:
    """Print a row of the table."""
    print(f"| {name} | {value:.3g} {unit} | {goal} |", flush=True)


def in_page(page: Any, where: str, goals: dict[str, str]) -> None:
    """Print what is measured in a page whose worker is ready."""
    for name in ("raymarcher", "bunny"):
        text = gallery()[name].read_text(encoding="utf-8")
        page.evaluate(_ASK, [text, 1, NUMBER.pattern])
        times = page.evaluate(_ASK, [text, 9, NUMBER.pattern])
        row(
            f"{where}: a changed number to the new text, {name}",
            statistics.median(times),
            "ms",
            goals[name],
        )
    if "drag" in goals:
        goals_of = {"raymarcher_objects": "30", "sdfray_row": "30", "bunny": "10"}
        for name, goal in goals_of.items():
            text = gallery()[name].read_text(encoding="utf-8")
            rate = page.evaluate(_DRAG, [text, DRAG_S])
            row(f"{where}: answers a second while a literal is dragged, {name}", rate, "/s", goal)


def loop(page: Any) -> float:
    """Seconds from the end of a looping worker to the next answer."""
    page.evaluate("() => studio.editor.replace(studio.settings.main, 'while True: pass\\n')")
    page.wait_for_function("() => !document.querySelector('.notice').hidden")
    begin = time.perf_counter()
    text = gallery()["melting"].read_text(encoding="utf-8")
    page.evaluate("(text) => studio.editor.replace(studio.settings.main, text)", text)
    page.wait_for_function(_IDLE)
    return time.perf_counter() - begin


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Measure the studio.")
    parser.add_argument("--site", type=Path, help="a site, built by `make site`")
    site = parser.parse_args().site
    browser(*SWIFTSHADER)
    print("| what | median | goal |\n|---|---|---|")
    size = sum(
        len(gzip.compress((APP / name).read_bytes())) for name in ("studio.js", "studio.css")
    )
    row("the app with its editor, packed", size / 1000, "kB", "230")
    first_picture()  # writes bytecode
    row(
        "`distal studio example:raymarcher` to the first picture", median(first_picture), "s", "1.5"
    )
    with local("example:melting") as (address, _):
        page = page_of(address)
        page.wait_for_function(_IDLE)
        in_page(page, "local", {"raymarcher": "100", "bunny": "600", "drag": ""})
        row("local: a loop ended to the next answer", loop(page), "s", "5")
        page.context.close()
    if site is not None:
        with served(site) as address:
            playground(address, site / "playground")


def playground(address: str, folder: Path) -> None:
    """Print what is measured of the playground."""
    files = [p for p in folder.rglob("*") if p.is_file() and p.parent.name != "gallery"]
    size = sum(len(gzip.compress(p.read_bytes(), 6)) for p in files)
    row("playground: download, packed", size / 1e6, "MB", "8")
    page = page_of(address)
    page.wait_for_function(_PLAYER)
    begin = time.perf_counter()
    page.locator(".cm-content").first.click()
    page.wait_for_function(_IDLE)
    row(
        "playground: Python ready and the first answer",
        time.perf_counter() - begin,
        "s",
        "2.5 of CPU",
    )
    in_page(page, "playground", {"raymarcher": "250", "bunny": "1200"})
    row("playground: a loop ended to the next answer", loop(page), "s", "5")
    print(json.dumps({"browser": browser(*SWIFTSHADER).version}))


if __name__ == "__main__":
    main()
