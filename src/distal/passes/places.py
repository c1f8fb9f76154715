"""Where in a function something is computed.

Input: blocks and positions, as ``versions`` numbers a function. Output: answers
to where a value that several statements use may be computed once, and whether it would have been
computed anyway.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

from distal.ir.nodes import Break, Const, Continue, For, If, Return, Stmt, While
from distal.ir.walk import blocks


@dataclass(eq=False, slots=True)
class Place:
    """A block, or the head of a ``while``: what its condition and its body share.

    Attributes:
        parent: The place around it, None for a function's body.
        position: Where in the parent it stands.
        repeats: It runs once for each round of a loop.
        is_head: It is the head of a ``while``; nothing can be bound there.
        body: Its statements.
        inner: The places of each statement that has blocks: both branches of an If, the body of
            a For, the head of a While (whose one inner place is the body).
        depth: How many places are around it.
    """

    parent: Place | None
    position: int
    repeats: bool = False
    is_head: bool = False
    body: tuple[Stmt, ...] = ()
    inner: dict[int, tuple[Place, ...]] = field(default_factory=dict)
    depth: int = 0

    def __post_init__(self) -> None:
        if self.parent is not None:
            self.depth = self.parent.depth + 1

    def outwards(self) -> Iterator[Place]:
        """This place and all around it."""
        place: Place | None = self
        while place is not None:
            yield place
            place = place.parent


class Site(NamedTuple):
    """One place of use: a statement, and whether the statement may skip the use."""

    place: Place
    position: int
    lazy: bool = False


Sites: TypeAlias = Mapping[Site, int]  # with how many uses there are at each


def within(place: Place, sites: Sites) -> tuple[dict[int, bool], dict[Place, dict[Site, int]]]:
    """Split sites: positions used directly (true: certainly), and the sites of inner places."""
    direct: dict[int, bool] = {}
    inner: dict[Place, dict[Site, int]] = {}
    for site, uses in sites.items():
        if site.place is place:
            direct[site.position] = direct.get(site.position, False) or not site.lazy
            continue
        child = site.place
        while child.parent is not place:
            assert child.parent is not None, "a site outside the place"
            child = child.parent
        inner.setdefault(child, {})[site] = uses
    return direct, inner


def cleared(sites: Sites) -> dict[Site, int]:
    """The sites as if no statement skipped any."""
    found: dict[Site, int] = {}
    for site, uses in sites.items():
        certain = site._replace(lazy=False)
        found[certain] = found.get(certain, 0) + uses
    return found


def first_position(place: Place, sites: Sites) -> int:
    """The first statement of ``place`` that uses, itself or inside."""
    direct, inner = within(place, sites)
    return min([*direct, *(child.position for child in inner)])


def in_loop(place: Place, site: Site) -> bool:
    """True when a site runs again and again while ``place`` runs once."""
    for around in site.place.outwards():
        if around is place:
            return False
        if around.repeats:
            return True
    raise AssertionError("a site outside the place")


def is_certain(place: Place, sites: Sites, start: int = 0) -> bool:
    """True when from ``start`` on one of the sites is reached whatever happens."""
    direct, inner = within(place, sites)
    if place.is_head:
        # The condition is computed once at least; the body perhaps never.
        (loop_body,) = place.inner[0]
        head = place.parent.body[place.position] if place.parent else None
        if direct.get(0):
            return True
        endless = isinstance(head, While) and _is_true(head)
        return endless and loop_body in inner and is_certain(loop_body, inner[loop_body])
    for position in range(start, len(place.body)):
        if direct.get(position):
            return True
        stmt = place.body[position]
        if _inner_certain(stmt, place.inner.get(position, ()), inner):
            return True
        if leaves((stmt,)):
            return False
    return False


def _inner_certain(
    stmt: Stmt, places: Collection[Place], inner: Mapping[Place, Mapping[Site, int]]
) -> bool:
    if not places or not all(p in inner for p in places):
        return False
    if isinstance(stmt, For) and not _runs_once(stmt):
        return False
    if isinstance(stmt, If) and len(places) < 2:
        return False
    return all(is_certain(p, inner[p]) for p in places)


def _is_true(loop: While) -> bool:
    return isinstance(loop.condition, Const) and bool(loop.condition.value)


def _runs_once(loop: For) -> bool:
    """True when a counted loop surely has a round."""
    if not isinstance(loop.start, Const) or not isinstance(loop.stop, Const):
        return False
    return bool(range(int(loop.start.value), int(loop.stop.value), loop.step))


def leaves(body: Collection[Stmt], *, in_loop: bool = False) -> bool:
    """True when a block may end other than by running through."""
    for stmt in body:
        match stmt:
            case Return():
                return True
            case Break() | Continue():
                if not in_loop:
                    return True
            case For() | While():
                if leaves(stmt.body, in_loop=True):
                    return True
            case _:
                if any(leaves(b, in_loop=in_loop) for b in blocks(stmt)):
                    return True
    return False
