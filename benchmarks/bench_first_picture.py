"""The time to a first picture, to a second structure, and of a long first run, in a fresh process.

The kernel cache is empty. In turn with plain code first (the default) and with optimized code alone
(``DISTAL_LLVM_LEVEL=2``): the least and the median by the clock, and the time of the processors
without that of the process that optimizes. Other work on the machine changes the latter less.

    python benchmarks/bench_first_picture.py [--cases first long] [--runs 7]
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile

CASES = {
    "first": "the first picture, with imports",
    "second": "a second structure",
    "long": "the sea at 960x540, with imports",
}
LEVELS = {"plain first": "", "optimized alone": "2"}

MEASURED = """
import json, sys, time
from time import perf_counter, process_time

begin = perf_counter(), process_time()
from distal import *


def elapsed(since):
    return perf_counter() - since[0], process_time() - since[1]


if sys.argv[1] == "long":
    load("example:sea").render((960, 540))
    seconds = elapsed(begin)
else:
    (Sphere(1) - Box(1)).render((64, 48))
    seconds = elapsed(begin)
if sys.argv[1] == "second":
    time.sleep(1.5)  # the first structure has been optimized
    begin = perf_counter(), process_time()
    (Torus(1, 0.3) | Box(1)).render((64, 48))
    seconds = elapsed(begin)
print(json.dumps(seconds))
"""


def measured(case: str, level: str) -> tuple[float, float]:
    """Return seconds by the clock and of the processors, in a fresh process."""
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "DISTAL_CACHE_DIR": cache, "DISTAL_LLVM_LEVEL": level}
        environment.pop("DISTAL_VERIFY", None)
        command = [sys.executable, "-W", "ignore", "-c", MEASURED, case]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    clock, processors = json.loads(done.stdout)
    return clock, processors


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cases", nargs="+", default=list(CASES), choices=list(CASES))
    parser.add_argument("--runs", type=int, default=7)
    asked = parser.parse_args()
    print(f"{'least and median, s':52}{'clock':>14}{'processors':>16}")
    for case in asked.cases:
        runs: dict[str, list[tuple[float, float]]] = {name: [] for name in LEVELS}
        for _ in range(asked.runs):
            for name, level in LEVELS.items():
                runs[name].append(measured(case, level))
        for name, pairs in runs.items():
            clock, processors = (
                f"{min(row):.3f} {statistics.median(row):.3f}" for row in zip(*pairs, strict=True)
            )
            print(f"{CASES[case] + ', ' + name:52}{clock:>14}{processors:>16}", flush=True)


if __name__ == "__main__":
    main()
