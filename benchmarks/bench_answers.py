"""The studio's worker: processor time of its answers, without a browser.

    python benchmarks/bench_answers.py [NAME ...]

Prints milliseconds of the processor, medians: a changed number of the text until the new text is
written as a message (``look``), and a dragged number until its answer (``drag``). The processor's
time is comparable on a machine that does other work, unlike that of the clock.
"""

from __future__ import annotations

import gc
import re
import statistics
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from distal.editor.messages import Change, LookRequest, encoded
from distal.editor.worker import StudioWorker
from distal.example_files import gallery

NAMES = ("raymarcher", "raymarcher_objects", "sdfray_row", "bunny")
NUMBER = re.compile(r"(?<![\w.#\"])\d+\.\d+(?![\w.])")
DRAGGED = re.compile("translate|Sphere|rotate")
WARM, RUNS = 3, 15


def ask(worker: StudioWorker, text: str, **more: Any) -> tuple[Any, float]:
    """Return the answer to a request about a text, and its milliseconds."""
    files = {"scene.py": text}
    request = LookRequest(id=1, revision=1, files=files, main="scene.py", guided=False, **more)
    begin = time.thread_time_ns()
    answer = worker.answers(request)[-1]
    encoded(answer)
    return answer, (time.thread_time_ns() - begin) / 1e6


def look(worker: StudioWorker, text: str) -> float:
    """Return the median of answers, each to another changed number of the text."""
    found = list(NUMBER.finditer(text))
    taken = []
    for i in range(WARM + RUNS):
        match = found[(7 * i + 3) % len(found)]
        changed = f"{float(match[0]) * 1.01 + 0.01:.4f}"
        taken.append(ask(worker, text[: match.start()] + changed + text[match.end() :])[1])
    return statistics.median(taken[WARM:])


def drag(worker: StudioWorker, text: str) -> float | None:
    """Return the median of answers while one number is dragged; None if none is a uniform."""
    first, _ = ask(worker, text)
    able = [x for x in first.literals if x.way == "numbers" and x.type == "number"]
    able = [x for x in able if not x.whole and DRAGGED.search(x.call)]
    if not able:
        return None
    literal, known, taken = able[len(able) // 2], first.key, []
    for i in range(WARM + RUNS):
        value = literal.value + 0.001 * (i + 1)
        place = {"file": literal.file, "start": literal.start, "end": literal.end}
        change = Change(what="literal", value=value, **place)
        answer, ms = ask(worker, text, known=known, changes=(change,), lean=True)
        known = answer.key
        taken.append(ms)
    return statistics.median(taken[WARM:])


def main() -> None:
    """Print the table."""
    gc.disable()  # as the worker does
    print("| example | look, ms | drag, ms |\n|---|---|---|")
    for name in sys.argv[1:] or NAMES:
        text = gallery()[name].read_text(encoding="utf-8")
        with tempfile.TemporaryDirectory() as folder:
            worker = StudioWorker(Path(folder))
            looked, dragged = look(worker, text), drag(worker, text)
        shown = "-" if dragged is None else f"{dragged:.1f}"
        print(f"| {name} | {looked:.1f} | {shown} |", flush=True)


if __name__ == "__main__":
    main()
