"""An instance of a scene function: the function for particular argument types."""

from __future__ import annotations

from dataclasses import dataclass

from distal.frontend.function_body import Variable
from distal.ir.nodes import FunctionRef
from distal.ir.types import FunctionType, Type


@dataclass(eq=False, slots=True)
class Instance:
    """A function that is lowered, or being lowered, for particular argument types.

    Attributes:
        name: Its name in the module.
        source_name: Its name in the author's source.
        params: The types of its parameters, without captures.
        result: The result type; None until it is known, and always None if an error prevents it.
        captures: The enclosing variables that a lifted function gets as its last parameters.
    """

    name: str
    source_name: str
    params: tuple[Type, ...]
    result: Type | None = None
    captures: tuple[Variable, ...] = ()

    def reference(self) -> FunctionRef:
        """Return the function as a value."""
        assert self.result is not None
        return FunctionRef(self.name, (), FunctionType(self.params, self.result))
