"""A scene function made for certain argument types."""

from __future__ import annotations

from dataclasses import dataclass

from distal.frontend.function_body import Variable
from distal.ir.nodes import FunctionRef
from distal.ir.types import FunctionType, Type


@dataclass(eq=False, slots=True)
class Instance:
    """A function lowered, or being lowered, for certain types.

    Attributes:
        name: Its name in the module.
        source_name: What the author calls it.
        params: The types of its own parameters, captures not counted.
        result: None until it is known; stays None where a mistake hides it.
        captures: The enclosing variables that its last parameters are, for a lifted function.
    """

    name: str
    source_name: str
    params: tuple[Type, ...]
    result: Type | None = None
    captures: tuple[Variable, ...] = ()

    def reference(self) -> FunctionRef:
        """The function as a value."""
        assert self.result is not None
        return FunctionRef(self.name, (), FunctionType(self.params, self.result))
