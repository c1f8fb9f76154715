"""The memory of the machine that gives the command does not grow with the length of a film."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
# All cases: the length of a long film; else one that shows what a frame leaves as well.
FRAMES = 2000 if os.environ.get("DISTAL_ALL_CASES") else 300


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
    assert found["objects"] < 2 * found["frames"]
    # A frame of this size has 4 kB; the first frames fill Dask's logs.
    assert found["bytes"] < 2048 * found["frames"] + 2**21
