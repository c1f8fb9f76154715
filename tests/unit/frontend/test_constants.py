"""Constants that scene code captures from Python."""

from __future__ import annotations

from enum import Enum, IntEnum
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from distal.diagnostics import CompileError
from distal.frontend import lower, type_of_value
from distal.ir.types import BOOL, FLOAT, INT, MAT3, UINT, VEC3
from distal.lang import Vectors, func, mat3, uint, vec3
from tests.unit.frontend.evaluation import body, from_text


class Wood(IntEnum):
    OAK = 3


class Speed(Enum):
    SLOW = 0.5
    NAMED = "fast"


@func
def GENERIC(v: Vectors) -> Vectors:  # noqa: N802
    return v * 2.0


def returned(expression: str, result: str, **names: Any) -> str:
    text = f"@func\ndef scene(p: vec3, i: int) -> {result}:\n    return {expression}\n"
    return body(from_text(text, **names)).rpartition("return ")[2].strip()


@pytest.mark.parametrize(
    ("value", "expression", "result", "expected"),
    [
        (3, "C", "int", "3"),
        (3, "C", "float", "3.0"),
        (3, "C * p.x", "float", "(mul 3.0 p.x)"),
        (True, "C", "bool", "true"),
        (uint(4000000000), "C", "uint", "4000000000u"),
        (2.5, "C", "float", "2.5"),
        (Wood.OAK, "C", "int", "3"),
        (Speed.SLOW, "C", "float", "0.5"),
        (Wood, "C.OAK", "int", "3"),
        (np.float32(0.5), "C", "float", "0.5"),
        (np.float64(0.25), "C * p", "vec3", "(mul (splat vec3 0.25) p)"),
        (np.int64(7), "C", "int", "7"),
        (np.uint32(7), "C", "uint", "7u"),
        (np.bool_(True), "C", "bool", "true"),
        (np.array(1.5), "C", "float", "1.5"),
        (vec3(1, 2, 3) * 2, "C", "vec3", "(vec3 2.0 4.0 6.0)"),
        ((1, 2.0, 3), "p + C", "vec3", "(add p (vec3 1.0 2.0 3.0))"),
        ((1, 2.0, 3), "length(C)", "float", "(length (vec3 1.0 2.0 3.0))"),
        ((1, 2.0, 3), "C.xzy", "vec3", "(vec3 1.0 2.0 3.0).xzy"),
        ((1, 2.0, 3), "vec3(C)", "vec3", "(vec3 1.0 2.0 3.0)"),
        ((1, 2.0, 3), "C", "vec3", "(vec3 1.0 2.0 3.0)"),
        ((1, 2.0, 3), "mat3(2) @ C", "vec3", None),
        ((1, 2.0, 3), "GENERIC(C)", "vec3", "GENERIC((vec3 1.0 2.0 3.0))"),
        ([1.5, 2.0], "C[1]", "float", "2.0"),
        ([1.5, 2.0], "float(len(C))", "float", "2.0"),
        ([1.5, 2], "C[i]", "float", "C[i]"),
        ([(0, 1.0), (2, 3)], "C[1]", "vec2", "(vec2 2.0 3.0)"),
        (np.array([1.0, 2.0, 3.0]), "p * C", "vec3", "(mul p (vec3 1.0 2.0 3.0))"),
        (SimpleNamespace(radius=2.0), "C.radius", "float", "2.0"),
    ],
)
def test_values(value: object, expression: str, result: str, expected: str | None) -> None:
    found = returned(expression, result, C=value, GENERIC=GENERIC)
    assert found.endswith("(vec3 1.0 2.0 3.0))") if expected is None else found == expected


def test_numpy_matrices_are_transposed_on_entry() -> None:
    rows = np.array([[1.0, 2.0], [3.0, 4.0]])
    assert returned("C", "mat2", C=rows) == "(mat2 (vec2 1.0 3.0) (vec2 2.0 4.0))"
    turned = mat3(1, 2, 3, 4, 5, 6, 7, 8, 9)
    assert returned("C[1]", "vec3", C=turned).endswith("[1]")


def test_constants_of_a_closure() -> None:
    scene = from_text("""
        def made(radius):
            @func
            def scene(p: vec3) -> float:
                return length(p) - radius
            return scene

        scene = made(0.25)
        """)
    assert body(scene) == "\n  return (sub (length p) 0.25)\n"


def test_types_of_a_closure_named_only_in_annotations() -> None:
    scene = from_text("""
        def made():
            @struct
            class Local:
                t: float

            @func
            def scene(x: float) -> "Local":
                return other(x)

            @func
            def other(x: float) -> "Local":
                return Local(x)

            return scene

        scene = made()
        """)
    assert body(scene) == "\n  return other(x)\n"


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (float("nan"), "is not a number"),
        (float("-inf"), "is infinite"),
        (1e300, "larger than a 32-bit float"),
        (2**40, "out of the range of int"),
        ("text", "is text"),
        (None, "is a NoneType, not a value"),
        ({}, "is a dict"),
        ([], "is empty"),
        ([1.0, "a"], "is text"),
        ([vec3(1), 1.0], "the elements of an array must be of one type"),
        (Speed.NAMED, "whose value is not a number"),
        (np.array([1 + 2j]), "is an array of complex128"),
        (np.zeros((7, 7)), "is an array of shape"),
        (vec3(float("nan")), "is not a number"),
        (object(), "is a object, not a value"),
    ],
)
def test_refused(value: object, message: str) -> None:
    scene = from_text("@func\ndef scene(i: int):\n    x = C\n    return x\n", C=value)
    with pytest.raises(CompileError, match=message):
        lower(scene)


def test_types_of_values_from_python() -> None:
    expected = {1: INT, 1.5: FLOAT, float("inf"): FLOAT}
    assert {v: type_of_value(v) for v in expected} == expected
    assert type_of_value(True) is BOOL
    assert type_of_value(uint(1)) is UINT
    assert type_of_value(vec3(1)) is VEC3
    assert type_of_value(mat3(1)) is MAT3
    assert type_of_value((1.0, 2.0, 3.0)) is VEC3
    assert type_of_value("text") is None


def test_a_short_array_becomes_a_vector_by_the_constructor() -> None:
    scene = from_text("""
        @func
        def scene(x: float) -> vec3:
            values = [x, 1, 2]
            return vec3(values)
        """)
    assert body(scene).endswith("return (vec3 values[0] values[1] values[2])\n")
