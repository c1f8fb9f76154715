"""From a field's text to its values and gradients.

Input: a ``Field`` and points. Output: what the CPU device and the reference make
of them in 64 bits, through the same front end as a file of an author's.
"""

from __future__ import annotations

import linecache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from distal.devices import reference
from distal.frontend import lower
from tests.gradients.fields import Field

Doubles = NDArray[np.float64]


def scope_of(text: str, name: str) -> dict[str, Any]:
    """The names that a module's text defines."""
    file = f"{name}.py"
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
    scope: dict[str, Any] = {"__name__": name}
    exec(compile(text, file, "exec"), scope)
    return scope


def points_of(field: Field, count: int, seed: int) -> Doubles:
    """Random points: (count, size), or (count,) for a float."""
    points = np.random.default_rng(seed).uniform(-1.5, 1.5, (count, field.size))
    return points[:, 0] if field.size == 1 else points


def on_reference(function: Any, points: Doubles) -> Any:
    """What the reference gives."""
    return reference.prepare(lower(function), precision=64).evaluate([points], {}, {})
