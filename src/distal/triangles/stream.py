"""The file of a picture as triangles: used points, cuts, codes of points.

Input: a coder, and a picture's description when writing. Output: the description. Writing and
reading are the same functions, with a coder that writes or reads, so that they cannot differ.
``web/src/triangles/reading.ts`` reads the same order.

A file is its head (``HEAD``), then decisions of ``range_coder.py``:

1. for each point that may be used, step by step: whether it is used;
2. for each triangle that can have a cut, depth first: whether it has one, and where. A cut
   goes on in the next triangle, so places on sides that are known are predicted;
3. for each used point, in the order of 1: how its code differs from that of the side that it
   halves, in steps that depend on the area of the triangles around it. The side's code is the mean
   of its ends'; if these differ much, a decision says whether it is one of them instead.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from distal.foreign_files import check_time, need_pixels
from distal.triangles.arithmetic import PLACES
from distal.triangles.lattice import (
    HALVES,
    MOST_SIDE,
    Bools,
    MiddlePoints,
    TriangleLattice,
    candidates,
    lattice_of,
)
from distal.triangles.range_coder import (
    NUMBER_CONTEXTS,
    Coder,
    CoderError,
    RangeDecoder,
    RangeEncoder,
    code_number,
    code_signed,
)
from distal.triangles.shapes import can_be_cut

Codes = NDArray[np.float64]
Triangle = tuple[int, int, int]
Cut = tuple[int, int, int]  # corner, places on the sides from it

# Signature and version, width, height, step of the codes in quarters.
HEAD: Final = struct.Struct("<4sHHB")
SIGNATURE: Final = b"dtr1"
_PIXEL_BYTES: Final = 120  # of a pixel while a file is read
_LOOK: Final = 2**16  # points between two looks at the time
# Numbers of the contexts.
_USED: Final = 0
_CUT: Final = _USED + 32 * 4
_CORNER: Final = _CUT + 32 * 16
_SAME: Final = _CORNER + 27 * 2
_FARTHER: Final = _SAME + 1
_FARTHER_SIGN: Final = _FARTHER + NUMBER_CONTEXTS
_PLACE: Final = _FARTHER_SIGN + PLACES
_LUMA: Final = _PLACE + 2 * PLACES
_LUMA_SIGN: Final = _LUMA + 10 * NUMBER_CONTEXTS
_CHROMA: Final = _LUMA_SIGN + 1
_CHROMA_SIGN: Final = _CHROMA + 2 * 3 * 5 * 3 * NUMBER_CONTEXTS
_TILE: Final = _CHROMA_SIGN + 2 * 9
_TILE_SIGN: Final = _TILE + 3 * NUMBER_CONTEXTS
_CHOICE: Final = _TILE_SIGN + 3
CONTEXTS: Final = _CHOICE + 4
# Steps of codes: of a point amid triangles of so many square pixels together; chroma's are larger.
_AREA_PX: Final = 64.0
_FINEST: Final = 0.5
_COARSEST: Final = 36.0
_CHROMA_STEP: Final = 1.25
# Ends of a side differ much if they do by so many steps, over all channels.
_GAP: Final = 4.0
# Decisions are rounded toward 0 by this much: fewer bytes for the same error.
_ROUNDING: Final = 0.42


@dataclass(slots=True)
class Description:
    """What a file says of a picture.

    Attributes:
        lattice: Its lattice.
        step: The step of codes, in quarters of a display level.
        used: Which points are used.
        cuts: Cuts by the triangle's corners.
        codes: Codes of all points, of shape (points, 3).
    """

    lattice: TriangleLattice
    step: int
    used: Bools
    cuts: dict[Triangle, Cut]
    codes: Codes


def written(description: Description) -> bytes:
    """Return the file; ``codes`` become those that a reader gets."""
    coder = RangeEncoder(CONTEXTS)
    _code(coder, description, reading=False)
    lattice = description.lattice
    head = HEAD.pack(SIGNATURE, lattice.width, lattice.height, description.step)
    return head + coder.finished()


def read(data: bytes) -> Description:
    """Return what a file says.

    Raises:
        CoderError: It is no such file.
    """
    if len(data) < HEAD.size or data[:4] != SIGNATURE:
        raise CoderError("this is no picture as triangles of this version")
    _, width, height, step = HEAD.unpack_from(data)
    if not (0 < width <= MOST_SIDE and 0 < height <= MOST_SIDE and step):
        raise CoderError(f"a picture as triangles is not {width}x{height} with step {step}")
    need_pixels(width, height, _PIXEL_BYTES)
    lattice = lattice_of(width, height)
    used = np.zeros(lattice.shape, bool)
    codes = np.zeros((used.size, 3))
    found = Description(lattice, step, used, {}, codes)
    _code(RangeDecoder(data[HEAD.size :], CONTEXTS), found, reading=True)
    return found


def _code(coder: Coder, description: Description, *, reading: bool) -> None:
    side = description.lattice.side
    description.used[::side, ::side] = True
    steps = _code_points(coder, description)
    areas = np.zeros(description.used.size)
    edges: dict[tuple[int, int], int] = {}
    for triangle, side_px, kind, level in triangles(description):
        areas[list(triangle)] += side_px * side_px / (4 if kind else 2)
        if can_be_cut(side_px, kind):
            cut = description.cuts.get(triangle)
            found = _code_cut(coder, edges, triangle, level, cut)
            if reading and found is not None:
                description.cuts[triangle] = found
    _code_codes(coder, description, steps, areas, reading=reading)


def _code_points(coder: Coder, description: Description) -> list[MiddlePoints]:
    """Code which points are used; return the used ones by step."""
    used, found = description.used, []
    columns = used.shape[1]
    for step in candidates(description.lattice, used):
        base, side = _USED + 4 * step.level, step.side
        places = zip(step.places[0].tolist(), step.places[1].tolist(), strict=True)
        for number, (y, x) in enumerate(places):
            if not number % _LOOK:
                check_time()
            near = int(x >= side and used[y, x - side])
            if y >= side:
                near += int(used[y - side, x])
                near += int(x + side < columns and used[y - side, x + side])
            used[y, x] = coder.bit(base + near, int(used[y, x]))
        found.append(step)
    return found


def triangles(description: Description) -> Iterator[tuple[Triangle, int, int, int]]:
    """Yield each triangle that has a place in the picture, depth first.

    Yields:
        Its corners, the side of its square, the kind and the number of its step.
    """
    lattice, used = description.lattice, description.used.ravel()
    width = lattice.shape[1]
    for row in range(lattice.rows // lattice.side):
        for column in range(lattice.columns // lattice.side):
            for form in HALVES[(row + column) % 2]:
                corners = [((row + y) * width + column + x) * lattice.side for y, x in form]
                # Rows of points lie one apart, whatever the side of a tile.
                a, b, c = (int(corner) for corner in corners)
                stack = [(a, b, c, 0)]
                while stack:
                    a, b, c, level = stack.pop()
                    if min(a // width, b // width, c // width) >= lattice.height:
                        continue
                    if min(a % width, b % width, c % width) >= lattice.width:
                        continue
                    middle = (a + b) // 2
                    side, kind = lattice.side >> level // 2, level % 2
                    if side > 1 and used[middle]:
                        stack += [(b, c, middle, level + 1), (c, a, middle, level + 1)]
                    else:
                        yield (a, b, c), side, kind, level


def _code_cut(
    coder: Coder,
    edges: dict[tuple[int, int], int],
    triangle: Triangle,
    level: int,
    cut: Cut | None,
) -> Cut | None:
    """Code the cut of a triangle; ``edges`` has the places of cuts on sides, -1 for none."""
    sides = [_edge(triangle[k], triangle[(k + 1) % 3]) for k in range(3)]
    known = [edges.get(side) for side in sides]
    crossed = sum(1 for place in known if place is not None and place >= 0)
    whole = known.count(-1)
    edges.update((side, -1) for side in sides)
    if not coder.bit(_CUT + 16 * level + 4 * crossed + whole, int(cut is not None)):
        return None
    corner, *places = cut or (0, 0, 0)
    pattern = sum(3**k * (0 if p is None else 1 + (p < 0)) for k, p in enumerate(known))
    base = _CORNER + 2 * pattern
    if not coder.bit(base, int(corner == 0)):
        corner = 1 if coder.bit(base + 1, int(corner == 1)) else 2
    else:
        corner = 0
    found = []
    for number, place in enumerate(places):
        other = triangle[(corner + 1 + number) % 3]
        turned = triangle[corner] > other
        place = PLACES - 1 - place if turned else place
        side = _edge(triangle[corner], other)
        place = _code_place(coder, number, known[sides.index(side)], place)
        edges[side] = place
        found.append(PLACES - 1 - place if turned else place)
    return corner, found[0], found[1]


def _code_place(coder: Coder, number: int, known: int | None, place: int) -> int:
    """Code a cut's place on a side, from the side's lower point."""
    if known is not None and known >= 0:
        if coder.bit(_SAME, int(place == known)):
            return known
        far = code_number(coder, _FARTHER, abs(place - known) - 1) + 1
        place = known + (far if coder.bit(_FARTHER_SIGN + known, int(place > known)) else -far)
        if not 0 <= place < PLACES:
            raise CoderError("a cut leaves its triangle")
        return place
    node = 1
    for shift in (2, 1, 0):
        node = 2 * node + coder.bit(_PLACE + PLACES * number + node, place >> shift & 1)
    return node - PLACES


def _edge(a: int, b: int) -> tuple[int, int]:
    return (a, b) if a < b else (b, a)


def _code_codes(
    coder: Coder,
    description: Description,
    steps: list[MiddlePoints],
    areas: NDArray[np.float64],
    *,
    reading: bool,
) -> None:
    """Code the differences of codes; ``description.codes`` become those that a reader gets."""
    shape = description.lattice.shape
    used = description.used
    size = description.step / 4.0 * np.sqrt(_AREA_PX / np.maximum(areas, 0.25))
    luma = np.clip(size, _FINEST, _COARSEST).reshape(shape)
    sizes = luma[..., None] * np.array([1.0, _CHROMA_STEP, _CHROMA_STEP])
    wanted = description.codes.reshape(*shape, 3)
    got = np.zeros_like(wanted)
    _code_tiles(coder, description.lattice, wanted, got, sizes)
    busy = np.zeros(shape, np.int64)
    for step in steps:
        kept = np.flatnonzero(used[step.places])
        place, ends, parents = (
            (step.places[0][kept], step.places[1][kept]),
            [(y[kept], x[kept]) for y, x in step.ends],
            [(y[kept], x[kept]) for y, x in step.parents],
        )
        guesses = _guesses(got[ends[0]], got[ends[1]])
        steps_px = sizes[place]
        # Where the ends differ much, an edge is likely: the point may be like one of them.
        gap = (np.abs(got[ends[0]] - got[ends[1]]) / steps_px).sum(1) > _GAP
        off = (np.abs(wanted[place] - guesses) / steps_px).sum(2)
        choices = np.where(gap, off.argmin(0), 0).tolist()
        numbers = np.arange(len(kept))
        ratio = (wanted[place] - guesses[choices, numbers]) / steps_px
        levels = (np.sign(ratio) * np.floor(np.abs(ratio) + _ROUNDING)).astype(int).tolist()
        near = (busy[parents[0]] + busy[parents[1]] + 1).tolist()
        for number, row in enumerate(levels):
            if gap[number]:
                choices[number] = _code_choice(coder, step.kind, choices[number])
            levels[number] = _code_difference(coder, step.kind, near[number], row)
        found = np.array(levels, float).reshape(-1, 3)
        got[place] = guesses[choices, numbers] + found * steps_px
        amount = np.abs(found)
        busy[place] = 1 + np.minimum(amount[:, 0], 15) + np.minimum(amount[:, 1:].max(1), 15)
    description.codes = got.reshape(-1, 3)


def _guesses(first: Codes, second: Codes) -> Codes:
    """Return the mean of the codes at a side's ends, and each of them."""
    return np.stack([(first + second) / 2.0, first, second])


def _code_choice(coder: Coder, kind: int, choice: int) -> int:
    """Code which of the guesses a point's code is near."""
    context = _CHOICE + 2 * kind
    if coder.bit(context, int(choice == 0)):
        return 0
    return 1 if coder.bit(context + 1, int(choice == 1)) else 2


def _code_tiles(
    coder: Coder, lattice: TriangleLattice, wanted: Codes, got: Codes, sizes: NDArray[np.float64]
) -> None:
    """Code the corners of tiles by their difference from the one to the left, or above."""
    side = lattice.side
    for y in range(0, lattice.rows + 1, side):
        for x in range(0, lattice.columns + 1, side):
            guess = got[y, x - side] if x else got[y - side, 0] if y else np.zeros(3)
            for k in range(3):
                level = int(np.rint((wanted[y, x, k] - guess[k]) / sizes[y, x, k]))
                context = _TILE + NUMBER_CONTEXTS * k
                level = code_signed(coder, context, _TILE_SIGN + k, level)
                got[y, x, k] = guess[k] + level * sizes[y, x, k]


def _code_difference(coder: Coder, kind: int, near: int, levels: list[int]) -> list[int]:
    """Code the differences of one point.

    Args:
        coder: The coder.
        kind: The kind of its step.
        near: One more than how much its parents differed.
        levels: Differences of luma and both chromas, in steps.
    """
    busy = min(4, near.bit_length() - 1)
    luma, first, second = levels
    luma = code_signed(coder, _LUMA + (2 * busy + kind) * NUMBER_CONTEXTS, _LUMA_SIGN, luma)
    amount, way = min(2, abs(luma)), (luma > 0) - (luma < 0) + 1
    context = _CHROMA + (amount * 5 + busy) * 3 * NUMBER_CONTEXTS
    first = code_signed(coder, context, _CHROMA_SIGN + 3 * way + 1, first)
    turn = (first > 0) - (first < 0) + 1
    context += (3 * 5 * 3 + min(2, abs(first))) * NUMBER_CONTEXTS
    return [luma, first, code_signed(coder, context, _CHROMA_SIGN + 9 + 3 * way + turn, second)]
