"""Track the lanes of a call when they take different branches: scopes with locals of some lanes.

Input: values that the interpreter binds and assigns. Output: these values in some lanes. Does not
depend on nodes.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from distal.backends.numpy import operations
from distal.backends.numpy.operations import Value


class Way:
    """How a lane continues after a statement; ON continues with the next statement."""

    # Not an enum: NumPy takes several times as long to compare an array with a member of one.
    ON: Final = np.int8(0)
    BREAK: Final = np.int8(1)
    CONTINUE: Final = np.int8(2)
    RETURN: Final = np.int8(3)


@dataclass(slots=True)
class ActiveCall:
    """One call of a function.

    Attributes:
        lanes: The number of lanes.
        result: The value returned so far, by some or all lanes; None: by no lane.
    """

    lanes: int
    result: Value | None = None

    def give(self, value: Value, lanes: NDArray[np.intp] | None) -> None:
        """Set the returned value in some lanes of the call (None: all)."""
        if lanes is None or self.result is None:
            # Lanes that have not returned yet will overwrite the zeros.
            if lanes is None:
                self.result = value
                return
            self.result = operations.blank(value)
        self.result = operations.scatter(self.result, lanes, value, self.lanes)


@dataclass(slots=True)
class Scope:
    """The locals of some lanes of a call.

    A narrowed scope reads its parent's locals in its own lanes, keeps the changes, and copies them
    to the parent in ``close``.

    Attributes:
        frame: The call.
        lanes: The number of lanes.
        parent: The scope that contains this one, or None.
        within: The positions of the lanes among the parent's.
        absolute: Their positions among the call's lanes; None: all lanes of the call.
        values: Locals bound or read here.
        bound: Names of the locals that were bound here.
        changed: Names of the parent's locals that were assigned here.
    """

    frame: ActiveCall
    lanes: int
    parent: Scope | None = None
    within: NDArray[np.intp] | None = None
    absolute: NDArray[np.intp] | None = None
    values: dict[str, Value] = field(default_factory=dict)
    bound: set[str] = field(default_factory=set)
    changed: set[str] = field(default_factory=set)

    def narrowed(self, within: NDArray[np.intp]) -> Scope:
        """Return a scope with some of the lanes."""
        absolute = within if self.absolute is None else self.absolute[within]
        return Scope(self.frame, len(within), self, within, absolute)

    def bind(self, name: str, value: Value) -> None:
        """Declare a local of this scope."""
        self.values[name] = value
        self.bound.add(name)

    def read(self, name: str) -> Value:
        """Return the value of a local in this scope's lanes."""
        if name not in self.values:
            assert self.parent is not None and self.within is not None, f"no local {name}"
            self.values[name] = operations.gather(self.parent.read(name), self.within)
        return self.values[name]

    def assign(self, name: str, value: Value) -> None:
        """Change a local."""
        self.values[name] = value
        if name not in self.bound:
            self.changed.add(name)

    def close(self) -> None:
        """Copy the changed locals to the parent."""
        assert self.parent is not None and self.within is not None
        for name in sorted(self.changed):
            before = self.parent.read(name)
            after = operations.scatter(before, self.within, self.values[name], self.parent.lanes)
            self.parent.assign(name, after)
