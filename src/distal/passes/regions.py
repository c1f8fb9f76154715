"""Where in a function something is computed.

Input: blocks and positions, as ``versions`` numbers a function. Output: answers to where a value
that several statements use may be computed once, and whether it would have been computed anyway.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

from distal.ir.exits import may_exit
from distal.ir.nodes import Const, For, If, Stmt, While


@dataclass(eq=False, slots=True)
class Region:
    """A block, or the head of a ``while``: what its condition and its body share.

    Attributes:
        parent: The region around it, None for a function's body.
        position: Its statement's position in the parent.
        repeats: It runs once for each round of a loop.
        is_head: It is the head of a ``while``; nothing can be bound there.
        body: Its statements.
        inner: The regions of each statement that has blocks: both branches of an If, the body of
            a For, the head of a While (whose one inner region is the body).
        depth: How many regions are around it.
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
        """This region and all around it."""
        region: Region | None = self
        while region is not None:
            yield region
            region = region.parent


class UseSite(NamedTuple):
    """Where a value is used: a statement, and whether the statement may skip the use."""

    region: Region
    position: int
    lazy: bool = False


UseSites: TypeAlias = Mapping[UseSite, int]  # with how many uses there are at each


def within(
    region: Region, sites: UseSites
) -> tuple[dict[int, bool], dict[Region, dict[UseSite, int]]]:
    """Split sites: positions used directly (true: certainly), and the sites of inner regions."""
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
    """The sites as if no statement skipped any."""
    found: dict[UseSite, int] = {}
    for site, uses in sites.items():
        certain = site._replace(lazy=False)
        found[certain] = found.get(certain, 0) + uses
    return found


def first_position(region: Region, sites: UseSites) -> int:
    """The first statement of ``region`` that uses, itself or inside."""
    direct, inner = within(region, sites)
    return min([*direct, *(child.position for child in inner)])


def in_loop(region: Region, site: UseSite) -> bool:
    """True when a site runs repeatedly while ``region`` runs once."""
    for around in site.region.outwards():
        if around is region:
            return False
        if around.repeats:
            return True
    raise AssertionError("a site outside the region")


def is_certain(region: Region, sites: UseSites, start: int = 0) -> bool:
    """True when from ``start`` on one of the sites is reached whatever happens."""
    direct, inner = within(region, sites)
    if region.is_head:
        # The condition is computed once at least; the body perhaps never.
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
    """True when a counted loop surely has a round."""
    if not isinstance(loop.start, Const) or not isinstance(loop.stop, Const):
        return False
    return bool(range(int(loop.start.value), int(loop.stop.value), loop.step))
