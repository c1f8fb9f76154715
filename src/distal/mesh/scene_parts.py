"""The parts of a scene, each a mesh of its own: what the author has named.

Input: a tree and a request. Output: meshes, and what has none. Unions are divided, also below rigid
moves; what is joined smoothly or cut stays whole. No formula is here.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from typing import TYPE_CHECKING

from distal.fields.combine import joins
from distal.fields.guarantees import Operator, ended
from distal.lang.runtime_access import executor
from distal.mesh.files import formats
from distal.mesh.meshing import MeshRequest, mesh_of_node
from distal.mesh.solid import Mesh
from distal.scene.lowering.attributes import paints
from distal.scene.lowering.derived import BoundsOf
from distal.scene.tree.errors import refuse
from distal.scene.tree.node import Node
from distal.scene.tree.part_names import named

if TYPE_CHECKING:
    from distal.scene.scene import Scene

# The name of what has no name, beside parts that have one.
REST = "rest"


@dataclass(frozen=True, slots=True)
class SceneParts:
    """The meshes of a scene.

    Attributes:
        meshes: One for each part.
        endless: What has no end, and so no mesh, in words.
    """

    meshes: tuple[Mesh, ...]
    endless: tuple[str, ...] = ()

    def save(self, path: str | PathLike[str], *, unit: str = "mm", bed: bool = False) -> None:
        """Save the meshes as parts of one file.

        Args:
            path: The file; see ``Mesh.save``.
            unit: The length of one scene unit.
            bed: Move all parts together, so that they stand on 0 and are centered there.

        Raises:
            SaveError: The suffix or the unit is unknown, or the file cannot be written.
        """
        finishes = [mesh.finish for mesh in self.meshes]
        formats.write(path, list(self.meshes), unit=unit, bed=bed, finishes=finishes)


def saved(
    scene: Scene, path: str | PathLike[str], request: MeshRequest, *, unit: str, bed: bool
) -> SceneParts:
    """Save the parts of a scene; see ``Scene.save``.

    Args:
        scene: The scene; its default material is that of a scene without any.
        path: The file.
        request: What is asked of each mesh.
        unit: The length of one scene unit.
        bed: Whether the parts are moved to stand on 0.

    Raises:
        SaveError: The suffix or the unit is unknown, or the file cannot be written.
    """
    formats.check_output(path, unit)
    node = scene.subject.node
    found = meshes_of(node if paints(node) else node.with_material(scene.material), request)
    found.save(path, unit=unit, bed=bed)
    return found


def meshes_of(node: Node, request: MeshRequest, *, parts: bool = True) -> SceneParts:
    """Return the meshes of the named parts of a tree, and of the rest.

    Args:
        node: The tree.
        request: What is asked of each mesh.
        parts: False for one mesh of the whole tree.

    Raises:
        Cancelled: ``request.cancel`` stopped the work.
        SceneValueError: No part has an end, or a part cannot be meshed.
    """
    if not parts:
        return SceneParts((mesh_of_node(node, request),))
    finite, endless = with_end(node, request)
    grouped = _grouped(finite)
    meshes = []
    for index, part in enumerate(grouped):
        meshes.append(mesh_of_node(part, _in_turn(request, index, len(grouped))))
    return SceneParts(tuple(meshes), tuple(endless))


def with_end(node: Node, request: MeshRequest) -> tuple[list[Node], list[str]]:
    """Return the parts of a tree that have an end, and in words those that have none.

    Parts that are not shown for these values of parameters are in neither.

    Args:
        node: The tree.
        request: The values of parameters and the time.

    Raises:
        SceneValueError: No part has an end.
    """
    finite: list[Node] = []
    endless: list[str] = []
    empty: list[Node] = []
    for part in parts_of(node):
        low, high = _corners(part, request)
        if any(a > b for a, b in zip(low, high, strict=True)):
            empty.append(part)
        elif all(math.isfinite(b - a) for a, b in zip(low, high, strict=True)):
            finite.append(part)
        else:
            endless.append(named(part))
    if empty and not finite and not endless:
        finite = empty[:1]  # its mesh is refused with the reason
    if not finite:
        refuse(
            f"nothing of '{node.name}' has an end, so there is no part to mesh",
            "intersect it with a box: shape & Box(…)",
            node.place,
        )
    return finite, endless


def parts_of(node: Node) -> Iterator[Node]:
    """Yield the parts of a tree, the named ones and what is beside them."""
    if node.label:
        yield node
    elif node.rule is joins.UNION:
        for child in node.children:
            for part in parts_of(child):
                yield _painted(part, node)
    elif isinstance(node.rule, Operator) and node.rule.turn and len(node.children) == 1:
        for part in parts_of(node.children[0]):
            yield replace(node, children=(part,), label=part.label)
    else:
        yield node


def _painted(part: Node, around: Node) -> Node:
    """Return a part with the material of the node that it was taken from: the outermost counts."""
    if around.material is None:
        return part
    return part.with_material(around.material)


def _grouped(parts: Sequence[Node]) -> list[Node]:
    """Return the named parts and, as one part, all others."""
    labeled = [part for part in parts if part.label]
    others = [part for part in parts if not part.label]
    if not others:
        return labeled
    rest = united(others)
    return [*labeled, replace(rest, label=REST) if labeled else rest]


def united(parts: Sequence[Node]) -> Node:
    """Return the union of parts."""
    if len(parts) == 1:
        return parts[0]
    return Node(joins.UNION, False, tuple(parts), place=parts[0].place)


def _corners(node: Node, request: MeshRequest) -> tuple[list[float], list[float]]:
    """Return the corners of a part's box; infinite along axes without an end."""
    bounds = executor().call(BoundsOf(node), (), {}, params=request.params, time=request.time)
    low, high = ([ended(number) for number in corner] for corner in bounds[2:4])
    return low, high


def _in_turn(request: MeshRequest, index: int, count: int) -> MeshRequest:
    """Return the request for one of several parts, with its share of the progress."""
    shown = request.progress
    if shown is None:
        return request
    return replace(request, progress=lambda share: shown((index + share) / count))
