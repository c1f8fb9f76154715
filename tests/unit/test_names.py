"""The names of the package: what is found, what a misspelt one is told, what stays Python's."""

from __future__ import annotations

import builtins

import pytest

import distal


def test_every_name_is_there():
    for name in distal.__all__:
        assert getattr(distal, name) is not None


def test_a_star_import_hides_no_built_in():
    assert not set(distal.__all__) & set(dir(builtins))


def test_a_misspelt_name_is_told_the_right_one():
    with pytest.raises(AttributeError, match="did you mean 'Sphere'"):
        _ = distal.Spher
    with pytest.raises(AttributeError, match=r"no attribute '__wrapped__'$"):
        _ = distal.__wrapped__
