"""Refusals of shapes that cannot be meshed: what is wrong, and what to write instead.

Input: a shape, and what was found out about it. Output: an error at the author's line.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Final, NoReturn

from distal.mesh.leaf_spacing import LEAST_WALL
from distal.mesh.parts import part_at
from distal.mesh.problems import MeshProblem, ThinWall
from distal.mesh.requests import box_of
from distal.mesh.solid import Floats
from distal.mesh.spacing import BALL_CELLS, TooFine, Wanted
from distal.scene.tree.errors import refuse
from distal.scene.tree.node import Node

if TYPE_CHECKING:
    from distal.mesh.extract import Extent, Nothing
    from distal.mesh.meshing import MeshRequest

_MOST_ASKED: Final = 100  # members of a union that are asked for their ends


def refuse_endless(node: Node, low: Floats, high: Floats, request: MeshRequest) -> None:
    """Refuse a shape that has no end, or no inside.

    Args:
        node: The shape.
        low: The lowest corner of its box.
        high: The highest.
        request: What was asked.

    Raises:
        SceneValueError: It has none.
    """
    endless = _axes_without_end(low, high)
    if endless:
        refuse(
            f"'{node.name}' has no end along {' and '.join(endless)}, and a mesh is of a part of "
            "space with an end",
            _endless_hint(node, request),
            node.place,
        )
    if (low >= high).any():
        refuse(f"'{node.name}' is empty: its box has no volume", None, node.place)


def _axes_without_end(low: Floats, high: Floats) -> list[str]:
    return [axis for axis, a, b in zip("xyz", low, high, strict=True) if not math.isfinite(b - a)]


def _endless_hint(node: Node, request: MeshRequest) -> str:
    """Return what to write: a union without its infinite members, or a box."""
    members = node.children if node.rule.name == "union" else ()
    endless = []
    for member in members[:_MOST_ASKED]:
        _, low, high = box_of(member, request.params, request.time)
        if _axes_without_end(low, high):
            endless.append(f"'{member.name}'")
    if 0 < len(endless) < len(members):
        names = ", ".join(dict.fromkeys(endless))
        return f"leave out {names}; distal mesh FILE:NAME meshes one shape of a file"
    return "intersect it with a box: shape & Box(…); an own function takes bounds=(low, high)"


def refuse_problem(node: Node, extent: Extent, problem: MeshProblem) -> NoReturn:
    """Refuse a shape that cannot be meshed, with what to write instead.

    Args:
        node: The shape.
        extent: Its box.
        problem: What prevents a mesh.

    Raises:
        SceneValueError: Always.
    """
    where = "" if problem.place is None else f" at {shown_place(problem.place)}"
    if isinstance(problem, ThinWall):
        one, other = problem.leaves
        # Walls below a share of the tolerance are not looked for.
        without = problem.thickness * BALL_CELLS / LEAST_WALL
        refuse(
            f"{one.text} and {other.text} are {problem.thickness:.2g} apart{where}: a wall or a "
            "gap that is so thin and so large needs too many triangles",
            f"make it thicker; tolerance={above(without):.2g} leaves it out",
            one.leaf.place,
        )
    match problem.kind:
        case "no number":
            refuse(
                f"the value of '{node.name}'{where} is no finite number",
                "avoid divisions by 0, and roots and logarithms of negative numbers",
                node.place,
            )
        case "leaves its box":
            refuse(
                f"the surface of '{node.name}' leaves its box: it goes on{where}",
                f"give larger bounds than {shown_place(extent.low)} to {shown_place(extent.high)}",
                node.place,
            )
        case "too far":
            x, y, z = (-float(number) for number in (extent.low + extent.high) / 2.0)
            refuse(
                f"'{node.name}' is too far from the origin for so fine a mesh: files hold 7 digits",
                f"mesh it at the origin: .translate({x:.4g}, {y:.4g}, {z:.4g})",
                node.place,
            )
        case "too many":
            hint = "give a smaller slope=, smaller bounds=, or a larger feature= and tolerance="
            refuse(
                f"the surface of '{node.name}' is in too many places to look at", hint, node.place
            )


def refuse_too_fine(node: Node, found: TooFine, wanted: Wanted) -> NoReturn:
    """Refuse a tolerance or a feature that needs too many triangles.

    Args:
        node: The shape.
        found: What was found out.
        wanted: What was wanted.

    Raises:
        SceneValueError: Always.
    """
    many = f"a mesh of '{node.name}' with this"
    about = f"needs about {rounded(found.triangles):,.0f} triangles"
    if found.by_feature:
        feature = found.step * BALL_CELLS
        refuse(f"{many} feature {about}", f"feature={above(feature):.2g}", node.place)
    assert found.tolerance is not None
    hint = f"tolerance={above(found.tolerance):.2g}"
    refuse(f"{many} tolerance, {wanted.tolerance:g}, {about}", hint, node.place)


def refuse_nothing(node: Node, found: Nothing, request: MeshRequest) -> NoReturn:
    """Refuse a shape without a mesh, with what to write instead.

    Args:
        node: The shape.
        found: What was looked at.
        request: What was asked.

    Raises:
        SceneValueError: Always.
    """
    if not len(found.lost):
        refuse(f"'{node.name}' has no inside: its values are positive everywhere", None, node.place)
    part = part_at(node, found.lost[0], request.params, request.time)
    thin = found.step * BALL_CELLS
    refuse(
        f"nothing of '{node.name}' is as thick as {thin:.2g}: {part.text} is thinner at "
        f"{shown_place(found.lost[0])}",
        f"a smaller feature=, such as {thin / 4.0:.2g}",
        node.place,
    )


def shown_place(place: Sequence[float] | Floats) -> str:
    """Return a place for messages."""
    return f"({', '.join(f'{number:.4g}' for number in place)})"


def rounded(number: float) -> float:
    """Return a number rounded to one digit."""
    return float(f"{number:.1g}")


def above(number: float) -> float:
    """Return a number rounded up to two digits."""
    unit = 10.0 ** (math.floor(math.log10(number)) - 1)
    return math.ceil(number / unit) * unit
