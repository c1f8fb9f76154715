"""Classes with a quick ``__init__`` take the arguments of the dataclass, and stay frozen."""

from __future__ import annotations

import inspect
from dataclasses import FrozenInstanceError, dataclass, field, replace

import pytest

from distal.ir.quick_init import quick_init


@dataclass(frozen=True, slots=True)
class Plain:
    name: str
    value: int = 3
    place: object = field(default=None, repr=False, kw_only=True)


@quick_init
@dataclass(frozen=True, slots=True)
class Quick:
    name: str
    value: int = 3
    place: object = field(default=None, repr=False, kw_only=True)


def test_the_arguments_are_those_of_the_dataclass() -> None:
    one, other = inspect.signature(Plain), inspect.signature(Quick)
    assert [(p.name, p.kind, p.default) for p in one.parameters.values()] == [
        (p.name, p.kind, p.default) for p in other.parameters.values()
    ]
    made = Quick("a", place=5)
    assert (made.name, made.value, made.place) == ("a", 3, 5)
    assert replace(made, value=4) == Quick("a", 4, place=5)
    assert repr(made) == "Quick(name='a', value=3)"


def test_mistakes_are_those_of_a_function() -> None:
    with pytest.raises(TypeError, match="missing 1 required positional argument: 'name'"):
        Quick()  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="positional"):
        Quick("a", 1, 2)  # type: ignore[call-arg]
    with pytest.raises(FrozenInstanceError):
        Quick("a").value = 2  # type: ignore[misc]
