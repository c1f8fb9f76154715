"""The value of an expression as a function, so that it can be computed or bounded."""

from __future__ import annotations

from typing import Any

from distal.ir.nodes import Return
from distal.lang.composed import Composed
from distal.lang.expressions import Expression
from distal.lang.places import places_in


class ValueOf(Composed):
    """A function without parameters that returns the value of an expression."""

    def __init__(self, expression: Expression) -> None:
        """Keep the expression.

        Raises:
            TypeError: It depends on the cell or on the place.
        """
        if places_in(expression):
            raise TypeError("the cell and the place are known only where a shape is evaluated")
        self._expression = expression
        self.name, self.signature, self.result = "value", (), expression.type

    def compose(self, assembly: Any) -> str:
        """Add the function to a program and return its name there."""
        value = assembly.expression(self._expression)
        name: str = assembly.define("value", (), self.result, (Return(value),))
        return name
