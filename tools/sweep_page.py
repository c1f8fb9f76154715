"""Save a printable example from its page in Chromium, and report how long it took and what it is.

Input: a file and a name, the number of cells. Output: a line for each save: seconds, the longest
time without an animation frame, triangles, faults. The exit code is 1 if the file has a fault, or
other points or triangles than Python's mesh at the same spacing.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path
from typing import Final

import numpy as np

ROOT: Final = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

import distal  # noqa: E402
from distal.export.page import write  # noqa: E402
from distal.export.page_options import PageOptions  # noqa: E402
from distal.mesh.checks import checked  # noqa: E402
from distal.polygons.reading import read_mesh  # noqa: E402
from distal.scene.viewing.viewable import viewable  # noqa: E402
from tests.page import test_print as pages  # noqa: E402

LIMIT_MS: Final = 900_000
# The page has drawn its own picture: what it compiles is not part of a save.
_SETTLED: Final = """async () => {
  await document.querySelector("[data-distal]").distal.settled();
  await new Promise((resolve) => setTimeout(resolve, 2000));
  window.gap = 0;
}"""


def faults_of(example: str, cells: int) -> list[str]:
    """Save an example, print a line about it, and return its faults.

    Args:
        example: The file of an example and a name in it, "enclosure:case".
        cells: How many cells there are along its largest side.
    """
    file, _, name = example.partition(":")
    path = ROOT / "examples" / f"{file}.py"
    seen = viewable(distal.load(path, name or None))
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "part.html"
        write(seen, target, PageOptions(printable=True, poster=False, views=["color"]))
        with pages.opened(target) as watched:
            page = pages.ready(watched)
            page.locator("#print").select_option(str(cells))
            page.evaluate(_SETTLED)
            begin = time.perf_counter()
            mesh = read_mesh(pages.saved(page, "3MF", Path(folder), LIMIT_MS))
            spent, gap = time.perf_counter() - begin, page.evaluate("window.gap")
            found = list(watched.complaints)
    points, triangles = np.asarray(mesh.points), np.asarray(mesh.triangles)
    found += [f"{count} {kind}" for kind, count in checked(points, triangles).items() if count]
    expected = pages.meshed_at(seen, cells)
    ours, known = len(triangles), len(expected.made.triangles)
    if ours != known:
        found.append(f"Python has {known:,} triangles")
    print(
        f"{example}, {cells} cells: {spent:.1f} s, at most {gap:.0f} ms without a frame, "
        f"{ours:,} triangles: {'; '.join(found) or 'no fault'}",
        flush=True,
    )
    return found


def main() -> int:
    """Save the examples."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("examples", nargs="*", default=["enclosure:case"], metavar="FILE:NAME")
    parser.add_argument("--cells", type=int, default=128, choices=(64, 128, 256))
    given = parser.parse_args()
    return int(any([faults_of(example, given.cells) for example in given.examples]))


if __name__ == "__main__":
    sys.exit(main())
