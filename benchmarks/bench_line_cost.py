"""Work and time by line: whether the estimate ranks lines as a clock does.

    python benchmarks/bench_line_cost.py [--browser] [--lines] [SCENE ...]

Draws with the native GLSL driver that EGL gives: llvmpipe on a machine without a graphics card,
where the clock is the CPU time of this process, so that a loaded machine gives the same numbers.
Prints for each scene the rank correlation (Spearman) of work and time over the lines whose time is
measurable: the median of seven slopes is larger than half the distance of the second and the sixth.
With --browser the studio measures itself, in a browser that draws in software: there the clock is
that of the wall, and other work on the machine makes lines unmeasurable.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from functools import partial
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from distal.example_files import gallery  # noqa: E402
from distal.loading import load  # noqa: E402
from distal.scene.viewing.viewable import viewable  # noqa: E402
from tests.editor.line_costs import LineCost, line_costs, spearman  # noqa: E402
from tests.editor.studio_page import SETTLED, studio  # noqa: E402
from tests.egl import renderer  # noqa: E402

SCENES = ("raymarcher", "melting", "sea", "course_4_materials", "raymarcher_objects", "city")
LIMIT_MS = 900_000


def in_browser(path: Path) -> tuple[float, list[LineCost]]:
    """Return the seconds of a picture and the costs of the lines, as the studio shows them."""
    with tempfile.TemporaryDirectory() as folder, studio(Path(folder), path.read_text()) as app:
        app.page.evaluate(SETTLED)
        app.page.get_by_role("button", name="Cost").click()
        means = []
        for label in ("Runs", "Work (estimated)"):
            app.page.get_by_label(label).check()
            app.page.wait_for_function("() => studio.costs.counts", timeout=LIMIT_MS)
            found = app.page.evaluate("() => studio.costs.counts.get('scene.py')")
            means.append({count["line"]: count["mean"] for count in found})
        app.page.get_by_label("Time (measured)").check()
        app.page.get_by_role("button", name="Measure").click()
        app.page.wait_for_function("() => studio.costs.times", timeout=LIMIT_MS)
        frame = app.page.evaluate("() => studio.costs.times.frame")
        lines = app.page.evaluate("() => studio.costs.times.lines.get('scene.py')")
    runs, work = means
    return frame / 1000, [
        LineCost(at := one["line"], runs[at], work[at], one["ms"] / 1000, one["error"] / 1000)
        for one in lines
    ]


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("--browser", action="store_true", help="measure in the studio, by WebGL 2")
    parser.add_argument("--lines", action="store_true", help="print each line")
    options = parser.parse_args()
    print("WebGL 2" if options.browser else renderer())
    for name in options.scenes:
        path = gallery()[name]
        native = partial(line_costs, viewable(load(path)), path.name)
        frame, found = in_browser(path) if options.browser else native()
        measured = [line for line in found if line.is_measured]
        rho = spearman([m.work for m in measured], [m.seconds for m in measured])
        print(
            f"{name:20} frame {1000 * frame:7.1f} ms  lines {len(found):3}  "
            f"measurable {len(measured):3}  Spearman {rho:.3f}",
            flush=True,
        )
        if options.lines:
            _print_lines(path.read_text().splitlines(), frame, found)


def _print_lines(text: list[str], frame: float, found: list[LineCost]) -> None:
    for line in sorted(found, key=lambda one: -one.seconds):
        share, error = 100 * line.seconds / frame, 100 * line.error / frame
        print(
            f"  {line.line:4} {line.runs:9.2f} {line.work:11.1f} "
            f"{share:8.2f} % ± {error:6.2f}  {text[line.line - 1].strip()[:60]}"
        )


if __name__ == "__main__":
    main()
