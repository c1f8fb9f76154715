"""Vectors and matrices as plain Python values."""

from __future__ import annotations

import copy
import pickle

import pytest

from distal.lang import bvec2, ivec2, mat2, uint, uvec2, vec2, vec3, vec4


def test_made_like_in_scene_code() -> None:
    assert list(vec3(1)) == [1.0, 1.0, 1.0]
    assert list(vec4(vec2(1, 2), 3, 4)) == [1.0, 2.0, 3.0, 4.0]
    assert list(vec2((3, 4))) == [3.0, 4.0]
    assert repr(ivec2(1.9, -1.9)) == "ivec2(1, -1)"
    assert repr(uvec2(-1, 2)) == "uvec2(4294967295, 2)"
    for wrong in [(1, 2), (), ("a",), (1, 2, 3, 4)]:
        with pytest.raises(TypeError):
            vec3(*wrong)


def test_swizzles_and_elements() -> None:
    v = vec3(1, 2, 3)
    assert (v.x, v.b, v[1], len(v)) == (1.0, 3.0, 2.0, 3)
    assert repr(v.zyx) == "vec3(3.0, 2.0, 1.0)"
    with pytest.raises(AttributeError, match="has no component 'w'"):
        _ = v.w
    with pytest.raises(AttributeError, match="does not change"):
        v.x = 2.0


def test_arithmetic() -> None:
    assert repr(2 * vec2(1, 2) - vec2(1, 0) / 2) == "vec2(1.5, 4.0)"
    assert repr(ivec2(1, 2) / 2) == "vec2(0.5, 1.0)"
    assert repr(-vec2(1, 2)) == "vec2(-1.0, -2.0)"
    assert repr(vec2(1, 2) == vec2(1, 3)) == repr(bvec2(True, False))
    with pytest.raises(TypeError, match="must be of one type, but these are vec2 and vec3"):
        _ = vec2(1) + vec3(1)


def test_matrices() -> None:
    m = mat2(1, 2, 3, 4)
    assert repr(m[1]) == "vec2(3.0, 4.0)"
    assert repr(m @ vec2(1, 10)) == "vec2(31.0, 42.0)"
    assert repr((m @ mat2(1.0))[0]) == "vec2(1.0, 2.0)"
    assert repr((m * 2)[1]) == "vec2(6.0, 8.0)"


def test_uint_wraps_and_values_travel() -> None:
    assert uint(-1) == 2**32 - 1
    for value in [vec3(1, 2, 3), mat2(1.0)]:
        assert repr(pickle.loads(pickle.dumps(value))) == repr(value)
        assert repr(copy.deepcopy(value)) == repr(value)


def test_names_that_python_has_too_keep_their_meaning_outside_scene_code():
    from distal import lang  # noqa: PLC0415

    assert lang.round(2.36, 1) == 2.4
    assert lang.max([1, 5, 3], key=lambda x: -x) == 1
    assert lang.abs(-3) == 3
    assert lang.min("b", "a") == "a"
    assert tuple(lang.abs(lang.vec2(-1.0, 2.0))) == (1.0, 2.0)
