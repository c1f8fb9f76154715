"""How many of a scene's numbers fit among a stage's uniforms."""

from __future__ import annotations

import pytest

from distal.backends.glsl.uniforms import ROOM, beyond_room
from distal.ir.nodes import Origin, UniformDeclaration
from distal.ir.types import FLOAT, MAT2, MAT4, VEC2, VEC3, VEC4, Type


def declared(type: Type, count: int, origin: Origin = Origin.NUMBER) -> list[UniformDeclaration]:
    return [
        UniformDeclaration(f"{type}_{origin.value}_{n}", type, origin, 0.0) for n in range(count)
    ]


@pytest.mark.parametrize(
    ("type", "fitting"),
    [
        (FLOAT, 4 * ROOM),
        (VEC2, 2 * ROOM),
        (VEC3, ROOM),
        (VEC4, ROOM),
        (MAT2, ROOM // 2),
        (MAT4, ROOM // 4),
    ],
    ids=str,
)
def test_room_is_counted_in_vectors(type: Type, fitting: int) -> None:
    assert beyond_room(declared(type, fitting)) == frozenset()
    numbers = declared(type, fitting + 3)
    assert beyond_room(numbers) == {u.name for u in numbers[fitting:]}


def test_scalars_fill_what_vectors_leave() -> None:
    assert not beyond_room([*declared(VEC3, ROOM), *declared(FLOAT, ROOM)])
    assert len(beyond_room([*declared(VEC3, ROOM), *declared(FLOAT, ROOM + 1)])) == 1
    assert not beyond_room([*declared(VEC3, ROOM - 1), *declared(VEC2, 1), *declared(FLOAT, 2)])


def test_parameters_always_have_room() -> None:
    sliders = declared(VEC4, ROOM + 50, Origin.PARAMETER)
    assert beyond_room(sliders) == frozenset()
    assert len(beyond_room([*sliders, *declared(FLOAT, 3)])) == 3
    # A small number behind a large one that does not fit still does.
    mixed = [*declared(VEC4, ROOM - 1), *declared(MAT4, 1), *declared(FLOAT, 1)]
    assert beyond_room(mixed) == {"mat4_number_0"}
