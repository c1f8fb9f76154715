"""A public name of distal stays what it is, whatever else is imported."""

from __future__ import annotations

import pkgutil

import distal


def test_no_module_has_the_name_of_a_public_name():
    """An import of ``distal.name`` sets this attribute, in the place of a function."""
    modules = {module.name for module in pkgutil.iter_modules(distal.__path__)}
    assert "scene" in modules
    assert modules & {*distal.__all__} == set()
