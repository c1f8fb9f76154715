"""Size of pages, and time to their first picture.

The goals: at most 60 kB; the first frame in headless Chromium on SwiftShader within 1.5 s of the
navigation, at 320x240. The page itself marks the moment its first picture is finished
(``distal:first-frame``); times count from the start of the navigation. Each run is a context of its
own, so that no compiled shader is left from the run before.

Besides examples there are ``sphere``, one in the default look, and a number, so many parts of three
kinds.

    .venv/bin/python benchmarks/bench_page.py [EXAMPLE | sphere | NUMBER …]
"""

from __future__ import annotations

import statistics
import sys
import tempfile
from pathlib import Path
from typing import Any

# The tests' browser is looked for where the repository is, wherever this is started from.
sys.path.insert(0, str(Path(__file__).parents[1]))

import distal
from distal import Box, Camera, DistantLight, Plane, Scene, Sphere, Torus, union
from tests.browser import SWIFTSHADER, BrowserUnavailableError, offline_page

RUNS = 7
SIZE = {"width": 320, "height": 240}
MOST_KB, MOST_S = 60.0, 1.5
LIMIT_MS = 60_000
MARK = "() => performance.getEntriesByName('distal:first-frame')[0]?.startTime"


def first_frame_s(page: Path) -> float:
    """From the start of the navigation to a finished first picture."""
    with offline_page(page, flags=SWIFTSHADER, viewport=SIZE) as watched:
        found = watched.page.wait_for_function(MARK, timeout=LIMIT_MS)
        return float(found.json_value()) / 1000.0


def parts(count: int) -> Scene:
    """So many parts of three kinds on a floor, in the sun."""
    side = round(count**0.5)
    step = 4.0 / side
    shapes = (Sphere(0.3 * step), Box(0.3 * step), Torus(0.3 * step, 0.1 * step).rotate(x=1.0))
    placed = [
        shapes[i % 3].translate((i % side + 0.5) * step - 2.0, 0.5 * step, i // side * step - 2.0)
        for i in range(count)
    ]
    camera = Camera((3.0, 3.0, 4.0), target=(0.0, 0.0, 0.0))
    sun = DistantLight((1.0, 2.0, 1.5), angle=0.01)
    return Scene(union(placed) | Plane(), camera=camera, lights=sun)


def seen(name: str) -> Any:
    """The object of a word of the command line."""
    if name == "sphere":
        return Scene(Sphere(0.5))
    return parts(int(name)) if name.isdigit() else distal.load(f"example:{name}")


def main() -> int:
    """Measure and print; 1 where a goal is missed."""
    names = sys.argv[1:] or ["raymarcher"]
    reached = True
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            page = Path(folder, f"{name}.html")
            made = seen(name).export(page)
            print(made)
            try:
                first_frame_s(page)  # starts the browser
                times = sorted(first_frame_s(page) for _ in range(RUNS))
            except BrowserUnavailableError as error:
                print(f"  no browser: {error}")
                return 1
            median = statistics.median(times)
            size = page.stat().st_size / 1000.0
            print(f"  first frame: median {median:.2f} s, {times[0]:.2f} to {times[-1]:.2f} s")
            if name == "raymarcher":
                reached = size <= MOST_KB and median <= MOST_S
                print(f"  goals: {size:.1f} of {MOST_KB:.0f} kB, {median:.2f} of {MOST_S:.1f} s")
    return 0 if reached else 1


if __name__ == "__main__":
    sys.exit(main())
