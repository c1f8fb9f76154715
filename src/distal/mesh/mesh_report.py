"""What a mesh says about itself: sizes, errors, what is missing or not certain.

Input: a mesh and what was asked. Output: the report that ``docs/guide/meshes.md`` describes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from distal.mesh.parts import part_at, parts_at
from distal.mesh.refusals import shown_place
from distal.mesh.spacing import BALL_CELLS, Wanted
from distal.scene.tree.node import Node
from distal.scene.tree.part_names import PlacedPart, named

if TYPE_CHECKING:
    from distal.mesh.extract import Extracted
    from distal.mesh.leaf_check import LeafCheck
    from distal.mesh.meshing import MeshRequest

_MOST_NAMED: Final = 8  # parts that are named


def report_of(node: Node, found: Extracted, wanted: Wanted, request: MeshRequest) -> dict[str, Any]:
    """Return the report of a mesh.

    Args:
        node: The shape.
        found: The mesh.
        wanted: The tolerance and the feature size.
        request: What was asked.
    """
    accuracy = found.accuracy
    lost = _lost_parts(node, found, request)
    needed = found.looked_at.needed
    assert needed is not None
    return {
        "tolerance": wanted.tolerance,
        "angle": wanted.angle if math.isfinite(wanted.angle) else None,
        "feature": found.step * BALL_CELLS,
        "sure_to": needed.sure_to * BALL_CELLS,
        "unknown_widths": sorted({named(leaf) for leaf in needed.unknown})[:_MOST_NAMED],
        "spacing": found.step,
        "levels": found.levels,
        "joined": found.joined,
        "cells": found.cells,
        "bricks": found.sampled,
        "points": len(found.made.points),
        "triangles": len(found.made.triangles),
        "error": {
            "largest": found.error,
            "mean": accuracy.mean,
            "place": list(accuracy.place),
            "mesh_to_surface": accuracy.largest,
            "surface_to_mesh": accuracy.from_surface,
            "at_points": accuracy.at_points,
            "cut_corner": found.corner.distance,
        },
        "crease_points": found.creases,
        "cut_points": accuracy.cut,
        "fans": found.made.fans,
        "lost": lost,
        "warnings": list(_warnings(node, found, wanted, request, lost)),
    }


def _warnings(
    node: Node,
    found: Extracted,
    wanted: Wanted,
    request: MeshRequest,
    lost: Sequence[Mapping[str, Any]],
) -> Iterator[str]:
    """Yield what is wrong or not certain, in words; arguments as for ``report_of``."""
    for thin in lost:
        yield (
            f"{thin['name']} is thinner than {found.step * BALL_CELLS:.3g} at "
            f"{shown_place(thin['place'])}: parts of it are missing"
        )
    if found.error > wanted.tolerance:
        yield exceeded(wanted, found.error, found.accuracy.place)
    needed, corner = found.looked_at.needed, found.corner
    assert needed is not None
    if needed.narrower and not lost:
        near = ", ".join(sorted({named(leaf) for leaf in needed.narrower})[:_MOST_NAMED])
        yield (
            f"parts, walls or gaps of {near} are thinner than the smallest possible cells, "
            f"{needed.sure_to:.2g}: some may be missing"
        )
    if corner.distance > wanted.tolerance and not lost:
        part = part_at(node, np.array(corner.place), request.params, request.time)
        yield (
            f"a corner of {part.text} is cut by up to {corner.distance:.3g} at "
            f"{shown_place(corner.place)}: it ends between samples"
        )
    if found.exceeds_slope:
        part = part_at(node, found.steepest_at, request.params, request.time)
        yield (
            f"{part.text} changes {found.steepest:.3g} times as fast as its slope says, at "
            f"{shown_place(found.steepest_at)}: separate parts may be missing"
        )


def exceeded(wanted: Wanted, error: float, place: Sequence[float]) -> str:
    """Return the warning of an error that is larger than was wanted."""
    tolerance = wanted.tolerance
    return f"the tolerance {tolerance:g} is exceeded: {error:.3g} at {shown_place(place)}"


def _lost_parts(node: Node, found: Extracted, request: MeshRequest) -> list[dict[str, Any]]:
    """Return the shapes that are too thin in places: name, line, one place and how many."""
    places = found.lost
    parts: dict[PlacedPart, dict[str, Any]] = {}
    for part, place in zip(
        parts_at(node, places, request.params, request.time), places, strict=True
    ):
        first = {"name": part.text, "line": part.line, "place": place.tolist(), "count": 0}
        parts.setdefault(part, first)["count"] += 1
    return list(parts.values())[:_MOST_NAMED]


def record_leaves(report: dict[str, Any], leaves: LeafCheck, wanted: Wanted) -> None:
    """Add to the report what the comparison of leaves with the mesh found."""
    report["leaves"] = leaves.report()
    error = report["error"]
    known = max(wanted.tolerance, error["largest"], error["cut_corner"])
    if leaves.error_at is not None and leaves.error > known:
        error["surface_to_mesh"] = error["largest"] = leaves.error
        error["place"] = list(leaves.error_at)
        report["warnings"].append(exceeded(wanted, leaves.error, leaves.error_at))
    report["warnings"] += leaves.warnings()
