"""Pieces: boxes with short programs, each of which computes the solid of a tree within its box.

Input: the programs, functions of a leaf, functions that join two values. Output: the value of a
piece, and an attribute of a place on it. A part of a tree of boxes (``part_tree``) is the row of a
leaf that is a part by itself, or the number of a piece: rows come first.

Pieces are one buffer of whole numbers: three for each piece (where its steps start, how many there
are, its box or -1 if it is not cut by it), then the steps. A step has the row of a leaf, the number
of a join and a mode. Steps change a value: they load a leaf's, join a leaf's to it, change it, or
keep it aside and join what was kept (at most three at a time).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from distal.lang import Buffer, func, max, select, struct, vec2, vec3, vec4
from distal.render.material import Surface, mix_surfaces
from distal.render.part_tree import beyond_sides

Attribute = TypeVar("Attribute", Surface, float)

RECORD = 3  # numbers for each piece
# A step has its mode in the lowest bits, then the join, then the row.
MODE_MASK = 7
JOIN_AT = 3
JOIN_MASK = 127
ROW_AT = 10
# Modes, as ``scene.lowering.pieces.emission.StepMode``.
PUSH = 1
JOIN = 2
POP = 3
ONE = 4


@struct
class Aside:
    """Values that are kept aside.

    Attributes:
        count: How many there are.
        first: The first; and so on.
    """

    count: int
    first: float
    second: float
    third: float


@func
def put_aside(aside: Aside, value: float) -> Aside:
    """Return what is kept with one more value."""
    count = aside.count
    return Aside(
        count + 1,
        select(count == 0, value, aside.first),
        select(count == 1, value, aside.second),
        select(count == 2, value, aside.third),
    )


@func
def last_aside(aside: Aside) -> float:
    """Return the value that was put aside last."""
    return select(
        aside.count == 1, aside.first, select(aside.count == 2, aside.second, aside.third)
    )


@func
def value_of_piece(
    pieces: Buffer[int],
    leaf: Callable[[vec3, int], float],
    joined: Callable[[int, float, float], float],
    some_others: bool,
    p: vec3,
    piece: int,
) -> float:
    """Return the value of the tree's field, as far as it matters in the box of a piece.

    Args:
        pieces: The pieces.
        leaf: The value of a leaf, by its row.
        joined: Two values joined, by the number of the join; of one value its change.
        some_others: Whether some steps do something else than to join a leaf; a constant.
        p: The point.
        piece: The number of the piece.
    """
    start = pieces[RECORD * piece]
    if not some_others:
        value = leaf(p, pieces[start] >> ROW_AT)
        for i in range(1, pieces[RECORD * piece + 1]):
            step = pieces[start + i]
            value = joined((step >> JOIN_AT) & JOIN_MASK, value, leaf(p, step >> ROW_AT))
        return value
    aside = Aside(0, 0.0, 0.0, 0.0)
    value = 0.0
    for i in range(pieces[RECORD * piece + 1]):
        step = pieces[start + i]
        mode = step & MODE_MASK
        d = value
        if mode < POP:
            d = leaf(p, step >> ROW_AT)
        if mode == PUSH:
            aside = put_aside(aside, value)
        if mode < JOIN:
            value = d
        else:
            before = value
            if mode == POP:
                before = last_aside(aside)
                aside.count -= 1
            value = joined((step >> JOIN_AT) & JOIN_MASK, before, d)
    return value


@func
def value_of_part(
    pieces: Buffer[int],
    leaf: Callable[[vec3, int], float],
    joined: Callable[[int, float, float], float],
    first_piece: int,
    some_others: bool,
    p: vec3,
    part: int,
) -> float:
    """Return the value of a leaf or a piece.

    Args:
        pieces: The pieces.
        leaf: The value of a leaf, by its row.
        joined: Two values joined, by the number of the join.
        first_piece: The part that is the first piece.
        some_others: As for ``value_of_piece``.
        p: The point.
        part: The part.
    """
    if part < first_piece:
        return leaf(p, part)
    return value_of_piece(pieces, leaf, joined, some_others, p, part - first_piece)


@func
def within_box(value: Callable[[vec3, int], float], factor: float, p: vec3, part: int) -> float:
    """Return a value that is never more than the distance to a part, at a place within its box.

    Args:
        value: The value of a part.
        factor: The number that makes distances of values.
        p: The point.
        part: The part.
    """
    return factor * value(p, part)


@func
def distance_to_part(
    boxes: Buffer[vec4],
    pieces: Buffer[int],
    value: Callable[[vec3, int], float],
    first_piece: int,
    factor: float,
    p: vec3,
    part: int,
) -> float:
    """Return a value that is never more than the distance to the solid of a part within its box.

    Args:
        boxes: The tree.
        pieces: The pieces.
        value: The value of a part.
        first_piece: The part that is the first piece.
        factor: The number that makes distances of values.
        p: The point.
        part: The part.
    """
    d = factor * value(p, part)
    if part >= first_piece:
        box = pieces[RECORD * (part - first_piece) + 2]
        if box >= 0:
            d = max(d, beyond_sides(p, boxes[2 * box], boxes[2 * box + 1]))
    return d


@func
def value_of_whole(value: Callable[[vec3, int], float], whole: int, p: vec3) -> float:
    """Return the value of the tree's field at any place.

    Args:
        value: The value of a part.
        whole: The piece with the program of the whole tree, as a part.
        p: The point.
    """
    return value(p, whole)


@func
def distance_to_whole(
    value: Callable[[vec3, int], float], whole: int, factor: float, p: vec3
) -> float:
    """Return a value that is never more than the distance to the tree's solid, also within it."""
    return factor * value(p, whole)


@func
def chord_of_part(
    chord: Callable[[vec3, vec3, int], vec2], first_piece: int, p: vec3, direction: vec3, part: int
) -> vec2:
    """Return where a line enters and leaves a part that is a leaf.

    Args:
        chord: The same of a leaf, by its row.
        first_piece: The part that is the first piece.
        p: A point of the line.
        direction: Its direction.
        part: The part.
    """
    return chord(p, direction, select(part < first_piece, part, 0))


@func
def has_part_chord(has_chord: Callable[[int], bool], first_piece: int, part: int) -> bool:
    """Return whether a part is a leaf whose chords are known.

    Args:
        has_chord: The same of a leaf, by its row.
        first_piece: The part that is the first piece.
        part: The part.
    """
    return part < first_piece and has_chord(select(part < first_piece, part, 0))


@func
def first_row(pieces: Buffer[int], first_piece: int, part: int) -> int:
    """Return the row of the first leaf of a part."""
    if part < first_piece:
        return part
    return pieces[pieces[RECORD * (part - first_piece)]] >> ROW_AT


@func
def mixed_in_piece(
    pieces: Buffer[int],
    leaf: Callable[[vec3, int], float],
    joined: Callable[[int, float, float], float],
    share: Callable[[int, float, float], float],
    shown: Callable[[vec3, int], Attribute],
    mixed: Callable[[Attribute, Attribute, float], Attribute],
    of_first: Attribute,
    first_piece: int,
    names_cut: bool,
    p: vec3,
    part: int,
) -> Attribute:
    """Return an attribute of a part at a point: those of its leaves, mixed as they are joined.

    Args:
        pieces: The pieces.
        leaf: The value of a leaf, by its row.
        joined: Two values joined, by the number of the join.
        share: The share of the second of two values in the attribute, by the number of their join.
        shown: The attribute of a leaf.
        mixed: Two attributes, mixed by the share of the second.
        of_first: The attribute of the first leaf.
        first_piece: The part that is the first piece.
        names_cut: Whether faces of a cutter show what it cuts; a constant.
        p: The point.
        part: The part.
    """
    piece = max(part - first_piece, 0)
    start = pieces[RECORD * piece]
    found = of_first
    value = leaf(p, first_row(pieces, first_piece, part))
    aside = Aside(0, 0.0, 0.0, 0.0)
    first_found = found
    second_found = found
    third_found = found
    for i in range(1, 1 if part < first_piece else pieces[RECORD * piece + 1]):
        step = pieces[start + i]
        mode = step & MODE_MASK
        row = step >> ROW_AT
        d = value
        of = found
        if mode < POP or (mode == ONE and names_cut and row > 0):
            of = shown(p, select(mode == ONE, row - 1, row))
        if mode < POP:
            d = leaf(p, row)
        if mode == PUSH:
            if aside.count == 0:
                first_found = found
            elif aside.count == 1:
                second_found = found
            else:
                third_found = found
            aside = put_aside(aside, value)
        how = (step >> JOIN_AT) & JOIN_MASK
        if mode < JOIN:
            value = d
            found = of
        elif mode == ONE:
            value = joined(how, value, d)
            found = of
        else:
            before = value
            earlier = found
            if mode == POP:
                before = last_aside(aside)
                aside.count -= 1
                if aside.count == 0:
                    earlier = first_found
                elif aside.count == 1:
                    earlier = second_found
                else:
                    earlier = third_found
            found = mixed(earlier, of, share(how, before, d))
            value = joined(how, before, d)
    return found


@func
def surface_of_part(
    pieces: Buffer[int],
    leaf: Callable[[vec3, int], float],
    joined: Callable[[int, float, float], float],
    share: Callable[[int, float, float], float],
    shown: Callable[[vec3, int], Surface],
    first_piece: int,
    p: vec3,
    part: int,
) -> Surface:
    """Return the surface of a part at a point; arguments as for ``mixed_in_piece``."""
    of_first = shown(p, first_row(pieces, first_piece, part))
    return mixed_in_piece(
        pieces, leaf, joined, share, shown, mix_surfaces, of_first, first_piece, True, p, part
    )


@func
def number_of_part(
    pieces: Buffer[int],
    leaf: Callable[[vec3, int], float],
    joined: Callable[[int, float, float], float],
    share: Callable[[int, float, float], float],
    shown: Callable[[vec3, int], float],
    first_piece: int,
    p: vec3,
    part: int,
) -> float:
    """Return the number of the leaf with the largest share; arguments as for ``mixed_in_piece``."""

    def larger(before: float, number: float, part: float) -> float:
        return select(part > 0.5, number, before)

    of_first = shown(p, first_row(pieces, first_piece, part))
    return mixed_in_piece(
        pieces, leaf, joined, share, shown, larger, of_first, first_piece, False, p, part
    )
