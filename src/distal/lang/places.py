"""Numbers that differ from place to place: from cell to cell of a repetition, over a surface.

Input: nothing. Output: ``cell`` and ``place``, expressions as ``time`` is one, and numbers that are
random for each cell. In an expression they are uniforms with names that no program declares: what
makes the function of a shape or of a material replaces them by the cell or the point there.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Final

from distal.ir.nodes import Expr, Uniform
from distal.ir.types import FLOAT, VEC3
from distal.ir.walk import nodes_in, substitute
from distal.lang.expressions import Expression, Symbolic, composed_value

CELL: Final = "cell"
POINT: Final = "p"
PLACES: Final = frozenset((CELL, POINT))

_CELL: Final = Uniform("cell.index", VEC3)
_PLACE: Final = Uniform("place.point", VEC3)
_RANDOM: Final = "cell.random."
_LARGEST_SEED: Final = 1_000_000

# The index of the repetition that contains a shape: 0, 1, 2 … along each axis.
cell: Final = Expression(_CELL)
# The point: in the coordinates of the shape or operator with the number, or of what is painted.
place: Final = Expression(_PLACE)


def random_by_cell(
    low: float | Symbolic = 0.0, high: float | Symbolic = 1.0, *, seed: int = 0
) -> Expression:
    """Return a number that is random for each cell of the repetition around a shape.

    It is the same on every target and in every run.

    Args:
        low: The smallest number; may be a parameter.
        high: The largest one.
        seed: A whole number from 0; numbers with different seeds are independent.

    Raises:
        TypeError: An argument is of another kind.
        ValueError: The seed is below 0 or too large.
    """
    if isinstance(seed, bool) or not isinstance(seed, int):
        raise TypeError(f"a seed is a whole number, not {seed!r:.40}")
    if not 0 <= seed <= _LARGEST_SEED:
        raise ValueError(f"a seed is a whole number from 0 to {_LARGEST_SEED}, not {seed}")
    for name, value in (("low", low), ("high", high)):
        if isinstance(value, bool | str) or not (
            isinstance(value, int | float | Symbolic) or hasattr(value, "__float__")
        ):
            raise TypeError(f"'{name} of random_by_cell' is a number, not {value!r:.40}")
    share = Expression(Uniform(f"{_RANDOM}{seed}", FLOAT))
    ends = (end if isinstance(end, Symbolic) else float(end) for end in (low, high))
    return composed_value("mix", (*ends, share))


def places_in(expression: Expression) -> frozenset[str]:
    """Return what an expression depends on besides parameters and time: "cell", "p"."""
    return _places_in(expression.node)


@lru_cache(maxsize=4096)
def _places_in(node: Expr) -> frozenset[str]:
    found = set()
    for inner in nodes_in(node):
        if isinstance(inner, Uniform):
            if inner is _PLACE:
                found.add(POINT)
            elif inner is _CELL or inner.name.startswith(_RANDOM):
                found.add(CELL)
    return frozenset(found)


def random_numbers_in(expression: Expression) -> frozenset[str]:
    """Return the names of the random numbers that an expression contains."""
    found = (n.name for n in nodes_in(expression.node) if isinstance(n, Uniform))
    return frozenset(name for name in found if name.startswith(_RANDOM))


def at_place(node: Expr, site: Mapping[str, Expr], random: Callable[[Expr, int], Expr]) -> Expr:
    """Return an expression at a place.

    Args:
        node: The expression.
        site: The index of the cell and the point, by ``CELL`` and ``POINT``; random numbers that
            are known, by their names.
        random: Returns a number from 0 to 1 for a cell and a seed.
    """
    known: dict[Expr, Expr] = {}
    for inner in nodes_in(node):
        if not isinstance(inner, Uniform):
            continue
        if inner is _CELL:
            known[inner] = site[CELL]
        elif inner is _PLACE:
            known[inner] = site[POINT]
        elif inner.name in site:
            known[inner] = site[inner.name]
        elif inner.name.startswith(_RANDOM):
            known[inner] = random(site[CELL], int(inner.name.removeprefix(_RANDOM)))
    return substitute(node, known, {}) if known else node
