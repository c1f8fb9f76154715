"""Trees in which large smooth unions have lists of their members for the cells of a grid.

Input: a tree. Output: the same tree, in which a node with a grid takes the place of each smooth
union of many solids; and why other smooth unions of many solids have none. Nothing here moves: a
union with members that depend on parameters or time is computed as a whole.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

from distal.diagnostics import CompileError
from distal.error_codes import ErrorCode
from distal.fields.guarantees import Operator
from distal.lang.lazy_module import LazyModule
from distal.lang.resources import Buffer
from distal.scene.lowering.parts.kinds import PartKind
from distal.scene.lowering.safe_parts import SafeParts
from distal.scene.lowering.smooth.chain import (
    Link,
    chain_of,
    first_linear,
    is_smooth_union,
    joined,
)
from distal.scene.tree.node import Node

if TYPE_CHECKING:
    from distal.scene.lowering.smooth import grid
else:
    grid = LazyModule("distal.scene.lowering.smooth.grid")  # needs NumPy

# Fewer members are not worth a grid; more kinds would be too much code.
LEAST_MEMBERS: Final = 48
MOST_KINDS: Final = 64
# The most members of a smooth union without a grid: with more, compilation takes minutes.
MOST_WITHOUT: Final = 2048

INFINITE: Final = "a shape of it has no finite box"
KINDS: Final = f"its shapes are of more than {MOST_KINDS} kinds"

# The rule of a node that stands for a smooth union with a grid.
CELLS: Final = Operator("smooth union")


@dataclass(frozen=True, slots=True)
class MemberGrid:
    """The members of a smooth union, and which of them matter in each cell of a grid.

    Attributes:
        kinds: The kinds of members. Above each stands a union of one shape (``chain.Link``).
        rows: The numbers of the members, a buffer of vec4.
        cells: The cells and their lists, a buffer of whole numbers (``render.smooth_cells``).
        low: The low corner of the grid.
        high: The high corner.
        blocks: How many blocks of 4 x 4 x 4 cells lie along each axis.
        per_unit: How many cells there are for each unit of length.
        all: The place of the list of all members.
        box: The corners of the box around the union.
        slope: Lipschitz bound (slope) of the union.
        growth: The growth of the box, and that of its sides (``fields.guarantees``).
        cell_count: The number of cells; a block that is not divided counts as one.
        longest: The number of members in the longest list of a cell.
        mean: The mean number of members in the list of a cell.
    """

    kinds: Sequence[PartKind]
    rows: Buffer
    cells: Buffer
    low: tuple[float, ...]
    high: tuple[float, ...]
    blocks: tuple[int, int, int]
    per_unit: float
    all: int
    box: tuple[tuple[float, ...], tuple[float, ...]]
    slope: float
    growth: tuple[float, float]
    cell_count: int
    longest: int
    mean: float

    @property
    def count(self) -> int:
        """The number of members."""
        return sum(len(kind.members) for kind in self.kinds)

    @property
    def bytes(self) -> int:
        """The size of both buffers."""
        return int(self.rows.data.nbytes + self.cells.data.nbytes)


@dataclass(frozen=True, slots=True, eq=False)
class CellNode(Node):
    """A node that stands for a smooth union with a grid.

    Attributes:
        grid: The grid.
        exact: Whether values outside of the grid are those of the union, too, not only bounds.
        source: The union in the author's tree.
    """

    grid: MemberGrid = None  # type: ignore[assignment]  # always given; the base class has defaults
    exact: bool = False
    source: Node = None  # type: ignore[assignment]

    @property
    def has_rows(self) -> bool:
        """Whether the numbers of its children are rows of a table."""
        return True


@dataclass(frozen=True, slots=True)
class CelledTree:
    """A tree with grids.

    Attributes:
        node: The tree; the given one if it has no grid.
        grids: The nodes with grids.
        linear: The smooth unions of many solids with members that are in none: how many, and why.
    """

    node: Node
    grids: Sequence[CellNode]
    linear: Sequence[tuple[Node, int, str]]


def celled(root: Node) -> CelledTree:
    """Return a tree with grids for its large smooth unions.

    Outside of a grid, values are bounds, unless what is above needs those of the union.

    Raises:
        PackageError: NumPy is missing, and the shapes are too many without grids.
    """
    return root.derived("grids", lambda: _with_grids(root))


def _with_grids(root: Node) -> CelledTree:
    rewriting = _GridInsertion()
    try:
        return CelledTree(rewriting.of(root), rewriting.grids, rewriting.linear)
    except RecursionError:
        return CelledTree(root, (), ())  # lowering reports a tree that is too deep
    except ImportError:  # also of the module itself
        if root.parts > MOST_WITHOUT:
            raise
        return CelledTree(root, (), ())  # texts are compiled without NumPy too


def celled_for(table_from: int | None, root: Node, *, exact: bool) -> Node:
    """Return the tree with grids, if a program can have them; else the tree itself.

    Args:
        table_from: The least number of members that is worth a grid; None if there are no buffers.
        root: The tree.
        exact: Whether values outside of a grid are those of the union, not only bounds.

    Raises:
        CompileError: A smooth union has no grid, and its members are too many without one.
    """
    if table_from is None or root.parts < table_from:
        return root
    found = celled(root)
    for union, count, reason in found.linear:
        if count > MOST_WITHOUT:
            raise CompileError.at(
                ErrorCode.TARGET,
                f"{count:,} shapes of a smooth union need lists for cells, but {reason}",
                union.place,
                f"without lists, {MOST_WITHOUT:,} shapes are possible",
            )
    return exact_cells(found.node) if exact and found.grids else found.node


def exact_cells(root: Node) -> Node:
    """Return a tree of ``celled`` in which values outside of grids are those of the unions, too."""
    if not any(isinstance(node, CellNode) for node in root.walk()):
        return root
    return root.derived("exact grids", lambda: _made_exact(root))


def _made_exact(node: Node) -> Node:
    if isinstance(node, CellNode):
        return replace(node, exact=True)
    children = tuple(map(_made_exact, node.children))
    same = all(a is b for a, b in zip(children, node.children, strict=True))
    return node if same else replace(node, children=children)


class _GridInsertion:
    """Replaces the large smooth unions of a tree."""

    def __init__(self) -> None:
        self.grids: list[CellNode] = []
        self.linear: list[tuple[Node, int, str]] = []
        self._known: dict[tuple[int, bool], Node] = {}
        self._safe = SafeParts()

    def of(self, node: Node, *, exact: bool = False) -> Node:
        """Return a tree with grids.

        Args:
            node: The root of the tree.
            exact: Whether values outside of grids must be those of the shape, because what is above
                has its surface elsewhere than where they are 0.
        """
        if node.parts < LEAST_MEMBERS:
            return node
        found = self._known.get((id(node), exact))
        if found is None:
            union = is_smooth_union(node)
            found = self._union(node, exact=exact) if union else self._other(node, exact=exact)
            self._known[id(node), exact] = found
        return found

    def _other(self, node: Node, *, exact: bool) -> Node:
        inner = exact or not self._safe.keeps_surfaces(node)
        children = tuple(self.of(child, exact=inner) for child in node.children)
        return node if _same(children, node.children) else replace(node, children=children)

    def _union(self, node: Node, *, exact: bool) -> Node:
        links = chain_of(node)
        inner = [self.of(link.node, exact=True) for link in links]
        if not _same(inner, _nodes(links)):
            node = joined(links, inner)
            links = [replace(a, node=b) for a, b in zip(links, inner, strict=True)]
        if len(links) < LEAST_MEMBERS:
            return node
        return self._gridded(node, links, exact=exact)

    def _gridded(self, node: Node, links: list[Link], *, exact: bool) -> Node:
        """Return a union with a grid for its first members, as many as possible."""
        found, count, reason = _grid_of(node, links)
        if reason:
            self.linear.append((node, len(links) - count, reason))
        if found is None:
            return node
        whole = count == len(links)
        first = self._cell_node(node, found, exact=exact or not whole, named=whole)
        return (
            first if whole else joined([links[0], *links[count:]], [first, *_nodes(links[count:])])
        )

    def _cell_node(self, node: Node, found: MemberGrid, *, exact: bool, named: bool) -> CellNode:
        """Return the node of a grid; it has the union's material and name if ``named``."""
        kinds: dict[str, Any] = {"children": tuple(kind.node for kind in found.kinds)}
        made = CellNode(
            CELLS,
            False,
            place=node.place,
            # The buffer tells grids of equal kinds apart.
            constants={"cells": found.cells},
            material=node.material if named else None,
            cut_material=node.cut_material if named else None,
            label=node.label if named else "",
            grid=found,
            exact=exact,
            source=node,
            **kinds,
        )
        self.grids.append(made)
        return made


def _grid_of(node: Node, links: list[Link]) -> tuple[MemberGrid | None, int, str]:
    """Return the grid of a union, of how many of its members, and why not of all."""
    return node.derived("grid", lambda: _new_grid(links))


def _new_grid(links: list[Link]) -> tuple[MemberGrid | None, int, str]:
    count, reason = first_linear(links)
    if count < LEAST_MEMBERS:
        return None, 0, reason
    made = grid.grid_of(links[:count])
    return (None, 0, made) if isinstance(made, str) else (made, count, reason)


def _nodes(links: Sequence[Link]) -> list[Node]:
    return [link.node for link in links]


def _same(a: Sequence[Node], b: Sequence[Node]) -> bool:
    return all(x is y for x, y in zip(a, b, strict=True))
