"""Values of objects by identity: equal objects have their own, and it is forgotten with them."""

from __future__ import annotations

import gc

from distal.lang.identity_map import IdentityMap


class Named:
    """Objects that are equal if their names are."""

    def __init__(self, name: str) -> None:
        self.name = name

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Named) and self.name == other.name

    def __hash__(self) -> int:
        return hash(self.name)


def test_equal_objects_have_their_own_values():
    values: IdentityMap[int] = IdentityMap()
    one, other = Named("a"), Named("a")
    assert one == other
    values[one] = 1
    assert other not in values and values.get(other) is None and values.get(other, 5) == 5
    assert values.setdefault(other, 2) == 2 and values.setdefault(one, 3) == 1
    assert (values.get(one), values.get(other), len(values)) == (1, 2, 2)


def test_values_are_forgotten_with_their_objects():
    values: IdentityMap[int] = IdentityMap()
    kept = Named("kept")
    values[kept] = 0
    for i in range(1000):  # many get the address of one that died
        passing = Named("passing")
        assert passing not in values
        values[passing] = i
        values[passing] = i + 1
        assert values.get(passing) == i + 1
        del passing
    gc.collect()
    assert len(values) == 1 and values.get(kept) == 0
