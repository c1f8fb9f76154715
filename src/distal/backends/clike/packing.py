"""Pack per-frame values into few flat vectors, to pass them from the vertex to the fragment stage.

Input: names and types of values. Output: the vector and lane of each component; and GLSL
expressions that fill each vector and that extract each value. WebGL 2 guarantees 15 vectors of four
components between the stages. Floats are passed as floats; ints, uints and bools as ints, because
an int's bits as a float may be a denormal or a NaN and be changed on the way. If there are too few
vectors, the bits of floats fill unused lanes of int vectors, which is safe in this direction.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby

from distal.ir.types import Kind, Matrix, Scalar, Type, Vector, component_count, kind_of

MAX_VECTORS = 15
LANES = "xyzw"


@dataclass(frozen=True, slots=True)
class PackedLane:
    """The place of one component: lane 0 to 3 of ``vectors[vector]``."""

    integer: bool
    vector: int
    lane: int


@dataclass(frozen=True, slots=True)
class Packing:
    """The places of all values.

    Attributes:
        values: Names and types, in order.
        places: For each value, the place of each of its components.
        float_vectors: The number of vec4; they are numbered first.
        int_vectors: The number of ivec4.
    """

    values: tuple[tuple[str, Type], ...]
    places: dict[str, tuple[PackedLane, ...]]
    float_vectors: int
    int_vectors: int


def pack(values: tuple[tuple[str, Type], ...]) -> Packing:
    """Assign a place to every component.

    Raises:
        AssertionError: There are more than 60 components: the frequency pass selected too many.
    """
    floats = [(n, t) for n, t in values if kind_of(t) is Kind.FLOAT]
    ints = [(n, t) for n, t in values if kind_of(t) is not Kind.FLOAT]
    whole_floats, float_count = _whole(floats)
    whole_ints, int_count = _whole(ints)
    if float_count + int_count <= MAX_VECTORS:
        places = _placed(whole_floats, 0, integer=False)
        places |= _placed(whole_ints, float_count, integer=True)
        return Packing(values, places, float_count, int_count)
    return _dense(values, floats, ints)


def _whole(values: list[tuple[str, Type]]) -> tuple[dict[str, list[tuple[int, int]]], int]:
    """Place each vector or column within one packed vector: largest first, first fit."""
    pieces = [
        (_column_size(t), order, n, column)
        for order, (n, t) in enumerate(values)
        for column in range(t.size if isinstance(t, Matrix) else 1)
    ]
    used: list[int] = []
    found: dict[str, list[tuple[int, int]]] = {}
    for size, _, name, _ in sorted(pieces, key=lambda p: (-p[0], p[1], p[3])):
        vector = next((i for i, filled in enumerate(used) if filled + size <= 4), len(used))
        if vector == len(used):
            used.append(0)
        found.setdefault(name, []).extend((vector, used[vector] + i) for i in range(size))
        used[vector] += size
    return found, len(used)


def _column_size(type: Type) -> int:
    return type.size if isinstance(type, Matrix) else component_count(type)


def _placed(
    found: dict[str, list[tuple[int, int]]], first: int, *, integer: bool
) -> dict[str, tuple[PackedLane, ...]]:
    return {
        name: tuple(PackedLane(integer, first + vector, lane) for vector, lane in lanes)
        for name, lanes in found.items()
    }


def _dense(
    values: tuple[tuple[str, Type], ...],
    floats: list[tuple[str, Type]],
    ints: list[tuple[str, Type]],
) -> Packing:
    """Use every lane; a value may continue in the next vector."""
    float_lanes = [n for n, t in floats for _ in range(component_count(t))]
    int_lanes = [n for n, t in ints for _ in range(component_count(t))]
    float_count, int_count = -(-len(float_lanes) // 4), -(-len(int_lanes) // 4)
    spill = 0
    if float_count + int_count > MAX_VECTORS:
        spill = len(float_lanes) % 4
        float_count = len(float_lanes) // 4
        int_count = -(-(len(int_lanes) + spill) // 4)
    assert float_count + int_count <= MAX_VECTORS, "more per-frame values than vectors hold"
    kept = len(float_lanes) - spill
    places: dict[str, list[PackedLane]] = {name: [] for name, _ in values}
    for i, name in enumerate(float_lanes[:kept]):
        places[name].append(PackedLane(False, i // 4, i % 4))
    for i, name in enumerate(int_lanes + float_lanes[kept:]):
        places[name].append(PackedLane(True, float_count + i // 4, i % 4))
    frozen = {name: tuple(lanes) for name, lanes in places.items()}
    return Packing(values, frozen, float_count, int_count)


@dataclass(frozen=True, slots=True)
class _Component:
    base: str  # the scalar or vector that contains it
    whole: int  # the number of lanes of the base
    lane: int
    kind: Kind


def _components(text: str, type: Type) -> list[_Component]:
    kind = kind_of(type)
    assert kind is not None
    match type:
        case Matrix(size):
            return [
                _Component(f"{text}[{column}]", size, lane, kind)
                for column in range(size)
                for lane in range(size)
            ]
        case _:
            count = component_count(type)
            return [_Component(text, count, lane, kind) for lane in range(count)]


def vector_texts(packing: Packing, texts: dict[str, str]) -> list[str]:
    """Return the GLSL expression that fills each vector, from the texts of the values."""
    count = packing.float_vectors + packing.int_vectors
    lanes: list[list[_Component | None]] = [[None] * 4 for _ in range(count)]
    integer = [i >= packing.float_vectors for i in range(count)]
    for name, type in packing.values:
        for place, part in zip(packing.places[name], _components(texts[name], type), strict=True):
            lanes[place.vector][place.lane] = part
    return [_vector_text(vector, i) for vector, i in zip(lanes, integer, strict=True)]


def _vector_text(vector: list[_Component | None], integer: bool) -> str:
    parts = []
    for _, run in groupby(vector, lambda part: part and (part.base, part.kind)):
        group = list(run)
        first = group[0]
        if first is None:
            parts += ["0" if integer else "0.0"] * len(group)
            continue
        picked = "".join(LANES[part.lane] for part in group if part is not None)
        is_whole = len(group) == first.whole
        text = first.base if is_whole else f"{first.base}.{picked}"
        parts.append(_as_int(text, first.kind, len(group)) if integer else text)
    if len(parts) == 1 and all(part is not None and part.whole == 4 for part in vector):
        return parts[0]
    return f"{'ivec4' if integer else 'vec4'}({', '.join(parts)})"


def _as_int(text: str, kind: Kind, count: int) -> str:
    if kind is Kind.INT:
        return text
    if kind is Kind.FLOAT:
        return f"floatBitsToInt({text})"
    return f"{'int' if count == 1 else f'ivec{count}'}({text})"


def value_text(packing: Packing, name: str, type: Type, vectors: list[str]) -> str:
    """Return the GLSL expression that extracts a value from the vectors.

    Args:
        packing: The places of all values.
        name: The value's name.
        type: The value's type.
        vectors: The names of the vectors.
    """
    kind = kind_of(type)
    assert kind is not None
    places = packing.places[name]
    if isinstance(type, Matrix):
        size = type.size
        columns = [
            _taken(places[i * size : (i + 1) * size], Vector(Kind.FLOAT, size), vectors)
            for i in range(size)
        ]
        return f"{type}({', '.join(columns)})"
    return _taken(places, type, vectors)


def _taken(places: tuple[PackedLane, ...], type: Type, vectors: list[str]) -> str:
    """Return a scalar or vector, extracted from its lanes."""
    kind = kind_of(type)
    runs = []
    for (vector, integer), run in groupby(places, lambda place: (place.vector, place.integer)):
        lanes = "".join(LANES[place.lane] for place in run)
        text = vectors[vector] if lanes == LANES else f"{vectors[vector]}.{lanes}"
        if integer and kind is Kind.FLOAT:
            text = f"intBitsToFloat({text})"
        runs.append(text)
    if len(runs) == 1 and kind in (Kind.FLOAT, Kind.INT):
        return runs[0]
    if type is Scalar(Kind.BOOL):
        return f"{runs[0]} != 0"
    return f"{type}({', '.join(runs)})"
