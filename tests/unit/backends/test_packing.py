"""Per-frame values find a place in at most fifteen vectors, and their way back out."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from distal.backends.clike.packing import MAX_VECTORS, Packing, pack, value_text, vector_texts
from distal.ir.types import (
    BOOL,
    BVEC3,
    FLOAT,
    INT,
    IVEC2,
    MAT2,
    MAT3,
    MAT4,
    UINT,
    UVEC4,
    VEC2,
    VEC3,
    VEC4,
    Kind,
    Type,
    component_count,
    kind_of,
)

TYPES = (FLOAT, INT, UINT, BOOL, VEC2, VEC3, VEC4, IVEC2, UVEC4, BVEC3, MAT2, MAT3, MAT4)


def check(packing: Packing, values: tuple[tuple[str, Type], ...]) -> None:
    places = [place for name, _ in values for place in packing.places[name]]
    assert len(set(places)) == len(places) == sum(component_count(t) for _, t in values)
    assert packing.float_vectors + packing.int_vectors <= MAX_VECTORS
    for name, type in values:
        assert len(packing.places[name]) == component_count(type)
        for place in packing.places[name]:
            assert place.integer == (place.vector >= packing.float_vectors)
            assert place.integer or kind_of(type) is Kind.FLOAT


@given(st.lists(st.sampled_from(TYPES), max_size=30))
def test_everything_has_its_own_place(types: list[Type]) -> None:
    while sum(component_count(t) for t in types) > 60:
        types = types[:-1]
    values = tuple((f"v{i}", t) for i, t in enumerate(types))
    packing = pack(values)
    check(packing, values)
    texts = vector_texts(packing, {name: name for name, _ in values})
    assert len(texts) == packing.float_vectors + packing.int_vectors
    for name, type in values:
        assert value_text(packing, name, type, [f"frame_{i}" for i in range(len(texts))])


def test_small_values_share_a_vector() -> None:
    packing = pack((("forward", VEC3), ("sway", FLOAT), ("on", BOOL)))
    assert vector_texts(packing, {n: n for n in ("forward", "sway", "on")}) == [
        "vec4(forward, sway)",
        "ivec4(int(on), 0, 0, 0)",
    ]
    names = ["frame_0", "frame_1"]
    assert value_text(packing, "forward", VEC3, names) == "frame_0.xyz"
    assert value_text(packing, "on", BOOL, names) == "frame_1.x != 0"


def test_a_matrix_travels_by_columns() -> None:
    packing = pack((("turn", MAT3),))
    assert vector_texts(packing, {"turn": "turn"}) == [
        *("vec4(turn[0], 0.0)", "vec4(turn[1], 0.0)", "vec4(turn[2], 0.0)")
    ]
    text = value_text(packing, "turn", MAT3, ["a", "b", "c"])
    assert text == "mat3(a.xyz, b.xyz, c.xyz)"


def test_values_run_over_when_vectors_are_short() -> None:
    values = tuple((f"v{i}", VEC3) for i in range(20))
    packing = pack(values)
    check(packing, values)
    assert packing.float_vectors == 15


def test_floats_fill_lanes_of_ints_by_their_bits() -> None:
    values = (*((f"f{i}", FLOAT) for i in range(57)), *((f"i{i}", INT) for i in range(3)))
    packing = pack(values)
    assert (packing.float_vectors, packing.int_vectors) == (14, 1)
    texts = vector_texts(packing, {name: name for name, _ in values})
    assert texts[14] == "ivec4(i0, i1, i2, floatBitsToInt(f56))"
    vectors = [f"frame_{i}" for i in range(15)]
    assert value_text(packing, "f56", FLOAT, vectors) == "intBitsToFloat(frame_14.w)"
