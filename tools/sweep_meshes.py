"""Mesh every solid of the catalogue, the printable examples and random fields, and report faults.

Input: the names of groups, a share of the shape's size as the tolerance, a limit of processor time
for each solid. Output: a line for each solid; the exit code is 1 if one has a fault. A fault is an
open edge, a pinched point, a pair of triangles that intersect, or an error above the tolerance that
the report does not state. Shapes without an end are cut by a box.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

ROOT: Final = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

import distal  # noqa: E402
from distal.devices.base import Cancelled  # noqa: E402
from distal.mesh.checks import checked  # noqa: E402
from distal.scene.tree.errors import SceneValueError  # noqa: E402
from tests.mesh.noise_fields import at_spacing, noise  # noqa: E402
from tools.catalogue_cells import cells  # noqa: E402

GROUPS: Final = ("solids", "operators", "blends", "examples", "noise")
EXAMPLES: Final = (
    ("enclosure", "base"),
    ("enclosure", "lid"),
    ("enclosure", "case"),
    ("bolt_and_nut", "bolt"),
    ("bolt_and_nut", "nut"),
    ("bolt_and_nut", "whole"),
    ("gears", "small"),
    ("gears", "large"),
    ("lithophane", "part"),
    ("gyroid_part", "part"),
    ("bunny", "bunny"),
)
FIELDS: Final = 100
BOX: Final = 1.2  # scene units: what is left of a shape without an end
NOISE_STEP: Final = 0.05
UNFINISHED: Final = "not finished"
_SAMPLES: Final = 20_000  # points of the mesh whose distance is checked again
_LIBRARY: Final = ("solids", "operators", "blends")


@dataclass(frozen=True, slots=True)
class Subject:
    """A solid of the sweep.

    Attributes:
        group: One of ``GROUPS``.
        name: Its name in the output.
        make: Makes the solid.
    """

    group: str
    name: str
    make: Callable[[], Any]


def subjects(groups: tuple[str, ...] = GROUPS) -> Iterator[Subject]:
    """Yield the solids of some groups."""
    for cell in cells([group for group in groups if group in _LIBRARY]):
        yield Subject(cell.group, cell.title, cell.make)
    if "examples" in groups:
        for file, name in EXAMPLES:
            path = ROOT / "examples" / f"{file}.py"
            yield Subject(
                "examples", f"{file}:{name}", lambda path=path, name=name: distal.load(path, name)
            )
    if "noise" in groups:
        for seed in range(FIELDS):
            kind = ("linear", "cubes")[seed % 2]
            size, slope = 0.04 + 0.0017 * (seed % 41), 1.5 + 0.7 * (seed % 7)
            yield Subject(
                "noise",
                f"{kind} {seed}",
                lambda k=kind, n=seed, a=size, s=slope: noise(k, n + 1, a, s),
            )


def solid(subject: Subject) -> Any:
    """Return the solid; None for a flat shape."""
    shape = subject.make()
    if shape.flat:
        return None
    low, high = shape.bounds()
    if all(math.isfinite(b - a) for a, b in zip(low, high, strict=True)):
        return shape
    return shape & distal.Box(BOX)


def faults_of(
    subject: Subject, shape: Any, share: float, limit: float
) -> tuple[list[str], dict[str, Any]]:
    """Mesh a solid, and return its faults and the report.

    Args:
        subject: What it is.
        shape: The solid.
        share: The tolerance, as a share of the largest side of the box.
        limit: Seconds of processor time.

    Raises:
        Cancelled: The time is over.
        SceneValueError: The solid has no mesh; the message says why.
    """
    if subject.group == "noise":
        return _faults_of_noise(shape)
    low, high = (np.array(corner) for corner in shape.bounds())
    tolerance = share * float((high - low).max())
    begin = time.process_time()
    over = lambda: time.process_time() - begin > limit  # noqa: E731
    made = shape.mesh(tolerance, cancel=over, check=True)
    report = made.report
    found = [f"{count} {kind}" for kind, count in report["check"].items() if count]
    single = made.points.astype(np.float32).astype(np.float64)
    rounded = checked(single, made.triangles)
    found += [f"{n} {kind} in 32 bits" for kind, n in rounded.items() if n and not found]
    error = report["error"]["largest"]
    stated = any("tolerance" in w or "changes" in w for w in report["warnings"])
    if error > tolerance and not stated:
        found.append(f"error {error:.3g} above {tolerance:.3g} without a warning")
    beyond = _beyond(shape, made) - max(tolerance, error)
    # The report has measured seven points of each triangle; others may be a little farther.
    if beyond > 0.5 * tolerance and not stated:
        found.append(f"a point of the mesh is {beyond:.3g} beyond the reported error")
    return found, report


def _faults_of_noise(shape: Any) -> tuple[list[str], dict[str, Any]]:
    """Mesh noise at one spacing: it has details of any size, so no tolerance can be kept."""
    made = at_spacing(shape, NOISE_STEP, tolerance=0.02).made
    single = made.points.astype(np.float32).astype(np.float64)
    found = []
    for points, bits in ((made.points, 64), (single, 32)):
        faults = checked(points, made.triangles)
        found += [f"{n} {kind} in {bits} bits" for kind, n in faults.items() if n]
    return found, {"triangles": len(made.triangles), "warnings": []}


def _beyond(shape: Any, made: Any) -> float:
    """Return how far points of the triangles are from the surface, at least."""
    rng = np.random.default_rng(1)
    rows = made.triangles[rng.integers(0, len(made.triangles), _SAMPLES)]
    weights = rng.dirichlet((1.0, 1.0, 1.0), _SAMPLES)
    points = np.einsum("ij,ijk->ik", weights, made.points[rows])
    return float(np.abs(shape(points)).max()) / max(float(shape.slope), 1e-300)


def line_of(subject: Subject, share: float, limit: float) -> tuple[bool, str]:
    """Return whether a solid passes, and the line about it."""
    begin = time.process_time()
    try:
        shape = solid(subject)
        if shape is None:
            return True, "flat"
        found, report = faults_of(subject, shape, share, limit)
    except Cancelled:
        return True, f"{UNFINISHED} in {limit:g} CPU s"
    except SceneValueError as refusal:
        return True, f"refused: {refusal.diagnostics[0].message}"
    except Exception as error:  # the sweep goes on, and names it
        return False, f"FAULT {type(error).__name__}: {error}"
    spent = time.process_time() - begin
    what = f"{report['triangles']:,} triangles, {spent:.1f} CPU s"
    if "error" in report:
        what += f", error {report['error']['largest']:.2g} of {report['tolerance']:.2g}"
    notes = "".join(f"\n    note: {warning}" for warning in report["warnings"])
    return not found, ("FAULT " + "; ".join(found) + ": " if found else "") + what + notes


def main() -> int:
    """Run the sweep."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("groups", nargs="*", default=[], metavar="GROUP", help=", ".join(GROUPS))
    parser.add_argument("--tolerance", type=float, default=0.01, help="a share of the size")
    parser.add_argument("--limit", type=float, default=240.0, help="CPU seconds for each solid")
    given = parser.parse_args()
    if unknown := set(given.groups) - set(GROUPS):
        parser.error(f"unknown group {', '.join(sorted(unknown))}: use {', '.join(GROUPS)}")
    count, failed, unfinished = 0, [], []
    for subject in subjects(tuple(given.groups) or GROUPS):
        passed, line = line_of(subject, given.tolerance, given.limit)
        print(f"{subject.group} {subject.name}: {line}", flush=True)
        count += 1
        if not passed:
            failed.append(f"{subject.group} {subject.name}")
        if line.startswith(UNFINISHED):
            unfinished.append(f"{subject.group} {subject.name}")
    print(f"{count} solids, {len(failed)} with faults: {', '.join(failed) or 'none'}")
    if unfinished:
        print(
            f"not checked, since they take more than {given.limit:g} CPU s: {', '.join(unfinished)}"
        )
    return bool(failed)


if __name__ == "__main__":
    sys.exit(main())
