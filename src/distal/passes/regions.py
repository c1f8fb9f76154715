"""The regions of a function, and where a value can be computed once for several uses.

Input: blocks and positions, as numbered by ``versions``. Output: where a value that several
statements use may be computed once, and whether every execution would compute it anyway.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

from distal.ir.exits import may_exit
from distal.ir.nodes import Const, For, If, Stmt, While


@dataclass(eq=False, slots=True)
class Region:
    """A block, or the head of a ``while``, which contains its condition and its body.

    Attributes:
        parent: The region around it, None for a function's body.
        position: Its statement's position in the parent.
        repeats: Whether it runs once for each iteration of a loop.
        is_head: Whether it is the head of a ``while``; nothing can be bound there.
        body: Its statements.
        inner: The regions of each statement that has blocks: both branches of an If, the body of
            a For, the head of a While (whose only inner region is the body).
        depth: The number of regions around it.
    """

    parent: Region | None
    position: int
    repeats: bool = False
    is_head: bool = False
    body: tuple[Stmt, ...] = ()
    inner: dict[int, tuple[Region, ...]] = field(default_factory=dict)
    depth: int = 0

    def __post_init__(self) -> None:
        if self.parent is not None:
            self.depth = self.parent.depth + 1

    def outwards(self) -> Iterator[Region]:
        """Yield this region and all regions around it, innermost first."""
        region: Region | None = self
        while region is not None:
            yield region
            region = region.parent


class UseSite(NamedTuple):
    """A place where a value is used: a statement, and whether the statement may skip the use."""

    region: Region
    position: int
    lazy: bool = False


UseSites: TypeAlias = Mapping[UseSite, int]  # the sites and the number of uses at each


def within(
    region: Region, sites: UseSites
) -> tuple[dict[int, bool], dict[Region, dict[UseSite, int]]]:
    """Split sites into the positions used directly in ``region`` and the sites in inner regions.

    The value for a position is True if the statement always uses the value.
    """
    direct: dict[int, bool] = {}
    inner: dict[Region, dict[UseSite, int]] = {}
    for site, uses in sites.items():
        if site.region is region:
            direct[site.position] = direct.get(site.position, False) or not site.lazy
            continue
        child = site.region
        while child.parent is not region:
            assert child.parent is not None, "a site outside the region"
            child = child.parent
        inner.setdefault(child, {})[site] = uses
    return direct, inner


def cleared(sites: UseSites) -> dict[UseSite, int]:
    """Return the sites with ``lazy`` cleared, as if no statement skipped a use."""
    found: dict[UseSite, int] = {}
    for site, uses in sites.items():
        certain = site._replace(lazy=False)
        found[certain] = found.get(certain, 0) + uses
    return found


def first_position(region: Region, sites: UseSites) -> int:
    """Return the position of the first statement of ``region`` with a use, itself or inside it."""
    direct, inner = within(region, sites)
    return min([*direct, *(child.position for child in inner)])


def in_loop(region: Region, site: UseSite) -> bool:
    """Return whether a site runs repeatedly while ``region`` runs once.

    Raises:
        AssertionError: The site is outside the region.
    """
    for around in site.region.outwards():
        if around is region:
            return False
        if around.repeats:
            return True
    raise AssertionError("a site outside the region")


def is_certain(region: Region, sites: UseSites, start: int = 0) -> bool:
    """Return whether every path from position ``start`` reaches one of the sites.

    Args:
        region: The region that contains the sites.
        sites: The sites where a value is used.
        start: The position of the statement to start from.
    """
    direct, inner = within(region, sites)
    if region.is_head:
        # The condition is computed at least once; the body may never run.
        (loop_body,) = region.inner[0]
        head = region.parent.body[region.position] if region.parent else None
        if direct.get(0):
            return True
        endless = isinstance(head, While) and _is_true(head)
        return endless and loop_body in inner and is_certain(loop_body, inner[loop_body])
    for position in range(start, len(region.body)):
        if direct.get(position):
            return True
        stmt = region.body[position]
        if _inner_certain(stmt, region.inner.get(position, ()), inner):
            return True
        if may_exit(stmt):
            return False
    return False


def _inner_certain(
    stmt: Stmt, regions: Collection[Region], inner: Mapping[Region, Mapping[UseSite, int]]
) -> bool:
    if not regions or not all(p in inner for p in regions):
        return False
    if isinstance(stmt, For) and not _runs_once(stmt):
        return False
    if isinstance(stmt, If) and len(regions) < 2:
        return False
    return all(is_certain(p, inner[p]) for p in regions)


def _is_true(loop: While) -> bool:
    return isinstance(loop.condition, Const) and bool(loop.condition.value)


def _runs_once(loop: For) -> bool:
    """Return whether a counted loop has at least one iteration."""
    if not isinstance(loop.start, Const) or not isinstance(loop.stop, Const):
        return False
    return bool(range(int(loop.start.value), int(loop.stop.value), loop.step))
