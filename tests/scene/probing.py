"""What an object that emits scene code gives at places, computed on a device."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from distal.ir.build import field
from distal.ir.nodes import Param, Read, Return
from distal.ir.types import FLOAT, VEC2, VEC3
from distal.lang.composed import Composed
from distal.lang.runtime_access import executor

TYPES = {"uv": VEC2, "facing": FLOAT}


class Probe(Composed):
    """One value (a field of a struct, by name) of what an object emits, as a function."""

    def __init__(self, emitting: Any, names: tuple[str, ...], part: str, result: Any) -> None:
        self.emitting, self.part, self.result = emitting, part, result
        self.name = "probe"
        self.signature = tuple((name, TYPES.get(name, VEC3)) for name in names)

    def compose(self, assembly: Any) -> str:
        site = {name: Read(name, type) for name, type in self.signature}
        value = self.emitting.emit(SimpleNamespace(assembly=assembly), site)
        if self.part:
            value = field(value, self.part)
        params = [Param(name, type) for name, type in self.signature]
        return assembly.define("probe", params, value.type, (Return(value),))


def emitted(
    emitting: Any,
    part: str = "",
    type: Any = VEC3,
    params: dict[str, Any] | None = None,
    time: float = 0.0,
    **site: Any,
) -> Any:
    """The value at a place, as a NumPy array."""
    probe = Probe(emitting, tuple(site), part, type)
    places = tuple(np.asarray(value, np.float64)[None] for value in site.values())
    return np.asarray(executor().call(probe, places, {}, params=params, time=time))[0]
