"""Waiting times: import, cold and warm compile of the raymarcher, the whole command.

Every figure is of fresh processes, the median of several; cold means an empty kernel cache. Prints
a table with the project's goal beside each.

    python benchmarks/bench_compile.py [--runs 7]
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

IMPORT = """
import time
begin = time.perf_counter()
import distal
print(time.perf_counter() - begin)
"""

LANGUAGE = IMPORT.replace("import distal\n", "import distal, distal.lang\n")

# What the first picture costs once the packages are imported: lowering, passes, LLVM, linking.
COMPILE = """
import time
import numpy, llvmlite.binding, distal.runtime.executor, distal.devices.cpu
import distal
image = distal.load("example:raymarcher")
begin = time.perf_counter()
picture = image.render(size=(64, 48), threads=1)
print(time.perf_counter() - begin - picture.stats["render_s"], picture.stats["cache_hit"])
"""


def run(words: list[str], cache: str) -> tuple[float, str]:
    """Seconds that a process took, and what it printed."""
    environment = {**os.environ, "DISTAL_CACHE_DIR": cache}
    environment.pop("DISTAL_VERIFY", None)
    begin = time.perf_counter()
    done = subprocess.run(words, env=environment, check=True, capture_output=True, text=True)
    return time.perf_counter() - begin, done.stdout.strip()


def compile_times(runs: int, *, cold: bool) -> list[float]:
    """Seconds from a loaded image to a running kernel."""
    times = []
    with tempfile.TemporaryDirectory() as shared:
        if not cold:
            run([sys.executable, "-c", COMPILE], shared)
        for _ in range(runs):
            with tempfile.TemporaryDirectory() as fresh:
                _, printed = run([sys.executable, "-c", COMPILE], fresh if cold else shared)
            seconds, hit = printed.split()
            assert hit == str(not cold), f"cache hit: {hit}"
            times.append(float(seconds))
    return times


def command_times(runs: int, *, cold: bool) -> list[float]:
    """Seconds of the whole command."""
    times = []
    with tempfile.TemporaryDirectory() as folder:
        words = [sys.executable, "-m", "distal.cli", "render", "example:raymarcher"]
        words += ["-o", os.path.join(folder, "picture.png"), "--stats"]
        if not cold:
            run(words, folder)
        for i in range(runs):
            cache = os.path.join(folder, f"cold{i}") if cold else folder
            seconds, printed = run(words, cache)
            assert json.loads(printed)["cache_hit"] is (not cold)
            times.append(seconds)
    return times


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--runs", type=int, default=7)
    runs = parser.parse_args().runs
    with tempfile.TemporaryDirectory() as cache:
        imports = [
            [float(run([sys.executable, "-c", code], cache)[1]) for _ in range(runs)]
            for code in (IMPORT, LANGUAGE)
        ]
    rows = [
        ("import distal", imports[0], 0.1),
        ("import distal, distal.lang", imports[1], 0.1),
        ("compile, cold", compile_times(runs, cold=True), 0.5),
        ("compile, warm cache", compile_times(runs, cold=False), 0.05),
        ("whole command, cold", command_times(runs, cold=True), None),
        ("whole command, warm cache", command_times(runs, cold=False), 1.0),
    ]
    print(f"{'raymarcher':28} {'median s':>9} {'fastest':>8} {'goal':>6}")
    for name, times, goal in rows:
        wanted = f"{goal:6.2f}" if goal is not None else "     -"
        print(f"{name:28} {statistics.median(times):9.3f} {min(times):8.3f} {wanted}")


if __name__ == "__main__":
    main()
