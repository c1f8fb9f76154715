"""Mesh random solids with narrow parts, and report those whose topology is wrong.

Input: how many of each kind, the first seed, the kinds. Output: a line for each kind and for each
solid that is wrong; the exit code is 1 if one is wrong without a warning. Each solid is meshed at
three tolerances.
"""

from __future__ import annotations

import argparse
import sys
import time
import warnings
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from distal.scene.tree.errors import SceneValueError  # noqa: E402
from tests.mesh.narrow_solids import KINDS, narrow_solid, topology_of  # noqa: E402

TOLERANCES: Final = (None, 0.1, 1.5)


def swept(kind: str, count: int, seed: int) -> tuple[int, int]:
    """Mesh solids of one kind; return how many are wrong, and how many of these without a warning.

    Args:
        kind: One of ``KINDS``.
        count: How many.
        seed: The first seed.
    """
    wrong = silent = meshes = 0
    began = time.process_time()
    for number in range(seed, seed + count):
        solid = narrow_solid(kind, number)
        for tolerance in TOLERANCES:
            try:
                made = solid.shape.mesh(colors=False, tolerance=tolerance)
            except SceneValueError as error:
                print(f"  {kind} {number}, tolerance {tolerance}: {error}", flush=True)
                wrong += 1
                continue
            meshes += 1
            found = topology_of(made)
            if found != (solid.surfaces, solid.handles):
                wrong += 1
                silent += not made.report["warnings"]
                said = "; ".join(made.report["warnings"]) or "no warning"
                print(
                    f"  {kind} {number}, tolerance {tolerance}: {found} surfaces and handles, not "
                    f"{solid.surfaces, solid.handles}; {said}",
                    flush=True,
                )
    cpu = time.process_time() - began
    print(f"{kind}: {wrong} of {3 * count} wrong, {silent} without a warning, {cpu:.1f} CPU s")
    return wrong, silent


def main() -> int:
    """Sweep, and return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("kinds", nargs="*", choices=[[], *KINDS], default=[])
    parser.add_argument("--count", type=int, default=30, help="solids of each kind")
    parser.add_argument("--seed", type=int, default=0, help="the first seed")
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    found = [swept(kind, given.count, given.seed) for kind in given.kinds or KINDS]
    wrong, silent = (sum(numbers) for numbers in zip(*found, strict=True))
    print(f"{wrong} wrong, {silent} without a warning")
    return 1 if silent else 0


if __name__ == "__main__":
    raise SystemExit(main())
