"""Frames of the gallery against those of another checkout, frame by frame in turn.

Two processes, one for each checkout, draw one example after another in direct light on one thread,
with optimized code. Prints the ratio of the fastest frames, of the first compilations without a
cache, and of the bytes of the WebGL text, for each example and as geometric means.

    git worktree add ../before HEAD~10
    python benchmarks/bench_frames.py ../before [--rounds 7] [--mode path] [--names NAME ...]
"""

from __future__ import annotations

import argparse
import json
import math
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
SIZE = (480, 360)
WORKER = """
import json, sys, time, warnings
warnings.simplefilter("ignore")
import distal
for line in sys.stdin:
    name, mode, size = json.loads(line)
    scene = distal.load(f"example:{name}")
    given = {"mode": mode, "samples": 1, "threads": 1, "size": size}
    if not isinstance(scene, distal.Scene):
        print(json.dumps(None), flush=True)
        continue
    compile_s = scene.render(**{**given, "size": (8, 8)}).stats["compile_s"]
    text = distal.compile(scene, "glsl-es300").text
    print(json.dumps([compile_s, len(text)]), flush=True)
    for line in sys.stdin:
        if json.loads(line) == "next":
            break
        begin = time.process_time()
        scene.render(**given)
        print(json.dumps(time.process_time() - begin), flush=True)
"""


class Checkout:
    """A process that draws with the source of a checkout."""

    def __init__(self, root: Path) -> None:
        given = {
            "PYTHONPATH": str(root / "src"),
            "DISTAL_LLVM_LEVEL": "2",
            "DISTAL_CACHE_DIR": "off",
        }
        self._process = subprocess.Popen(
            [sys.executable, "-c", WORKER],
            env={**os.environ, **given},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def say(self, value: Any) -> None:
        """Send a request."""
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps(value) + "\n")
        self._process.stdin.flush()

    def ask(self, value: Any) -> Any:
        """Send a request and return the answer."""
        self.say(value)
        assert self._process.stdout is not None
        return json.loads(self._process.stdout.readline())


def main() -> None:
    """Measure and print."""
    told = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    told.add_argument("before", type=Path)
    told.add_argument("--names", nargs="+", default=[])
    told.add_argument("--rounds", type=int, default=7)
    told.add_argument("--mode", default="direct")
    given = told.parse_args()
    before, now = Checkout(given.before.resolve()), Checkout(ROOT)
    names = given.names or sorted(p.stem for p in (given.before / "examples").glob("[!_]*.py"))
    logs = [0.0, 0.0]
    count = 0
    print("example             frame  compile  bytes")
    for name in names:
        request = [name, given.mode, SIZE]
        old, new = before.ask(request), now.ask(request)
        if old is None or new is None:
            continue
        frames = [(before.ask(""), now.ask("")) for _ in range(given.rounds)]
        for checkout in (before, now):
            checkout.say("next")
        frame = min(n for _, n in frames) / min(o for o, _ in frames)
        compiled = new[0] / old[0]
        print(f"{name:20}{frame:5.2f}    {compiled:5.2f}  {new[1] - old[1]:+6}", flush=True)
        logs = [logs[0] + math.log(frame), logs[1] + math.log(compiled)]
        count += 1
    print(
        f"geometric mean      {math.exp(logs[0] / count):5.3f}    {math.exp(logs[1] / count):5.3f}"
    )


if __name__ == "__main__":
    main()
