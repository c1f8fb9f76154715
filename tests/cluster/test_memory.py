"""The memory of the machine that gives the command does not grow with the length of a film."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
# All cases: the length of a long film; else one that shows what a frame leaves as well.
FRAMES = 2000 if os.environ.get("DISTAL_ALL_CASES") else 520


def test_objects_and_memory_of_a_long_film():
    made = subprocess.run(
        [sys.executable, "-m", "tests.cluster.long_film", str(FRAMES)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert made.returncode == 0, made.stderr
    found = json.loads(made.stdout.splitlines()[-1])
    print(found)
    assert found["rendered"] == FRAMES
    assert found["kept"] <= 1  # the program
    # One object of any type for each frame would be a whole window, and its pixels 77 kB a frame.
    assert found["objects"] < found["window"] / 2
    assert found["bytes"] < 20e3 * found["window"]
