"""Numbers become constants where a text or a kernel is final."""

from __future__ import annotations

from distal.ir.build import add, multiply, splat
from distal.ir.nodes import Origin, Return, Uniform, UniformDeclaration
from distal.ir.printer import print_module
from distal.ir.types import BOOL, FLOAT, INT, MAT2, VEC2, VEC3
from distal.ir.verify import verify
from distal.passes.numbers import constant, freeze
from tests.unit.passes.sample_target import function, program


def test_numbers_become_constants_and_parameters_stay():
    uniforms = (
        UniformDeclaration("size", FLOAT, Origin.PARAMETER, 0.5),
        UniformDeclaration("Radius", FLOAT, Origin.NUMBER, 0.25),
        UniformDeclaration("Center", VEC3, Origin.NUMBER, (1.0, 2.0, 3.0)),
    )
    scaled = multiply(Uniform("size", FLOAT), Uniform("Radius", FLOAT))
    value = add(splat(scaled, VEC3), Uniform("Center", VEC3))
    module = program(function("f", {}, VEC3, Return(value)), uniforms=uniforms)
    frozen = freeze(module)
    verify(frozen)
    text = print_module(frozen)
    assert "return (add (splat vec3 (mul @size 0.25)) (vec3 1.0 2.0 3.0))" in text
    assert [u.name for u in frozen.uniforms] == ["size"]
    assert freeze(frozen) is frozen


def test_constants_of_every_kind():
    assert constant(3, INT).value == 3
    assert constant(True, BOOL).value is True
    assert [p.value for p in constant((1, 2), VEC2).parts] == [1.0, 2.0]
    matrix = constant((1.0, 2.0, 3.0, 4.0), MAT2)
    assert [[c.value for c in column.parts] for column in matrix.parts] == [[1.0, 2.0], [3.0, 4.0]]
