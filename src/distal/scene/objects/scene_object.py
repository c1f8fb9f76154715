"""Base classes of lights, cameras, materials and backgrounds.

Input: the calls of scene functions that the objects hold. Output: the base classes, whose objects
show their arguments. Does not depend on how the calls are made.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

from distal.ir.nodes import Expr
from distal.lang.functions import Func
from distal.lang.immutable import Immutable
from distal.render.declarations import Declaration
from distal.scene.tree.calls import FunctionCall
from distal.scene.tree.value import CalledValue
from distal.scene.tree.varying import Composer


class SceneObject(CalledValue, Immutable):
    """An object that never changes after construction.

    Attributes:
        noun: The word for such objects in messages.
        declaration: The declaration that the class was made from, if it was made from one.
    """

    __slots__ = ("__weakref__", "_kept_digest", "_origin")

    noun: ClassVar[str]
    declaration: ClassVar[Declaration]

    def _keep(self, **attributes: Any) -> None:
        """Set attributes, on construction only."""
        for name, value in attributes.items():
            object.__setattr__(self, name, value)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a {self.noun} does not change; make another")


class CalledObject(SceneObject):
    """An object that is one call of a scene function.

    Attributes:
        call: The scene function and its values.
    """

    __slots__ = ("call",)

    call: FunctionCall

    def _checked(self) -> Iterator[Mapping[str, Any]]:
        yield self.call.values

    def _compared(self) -> tuple[Any, ...]:
        return self.noun, self.call

    def emit(self, composer: Composer, site: Mapping[str, Expr]) -> Expr:
        """Emit the call. ``site`` provides the function's other arguments (point, normal, cell)."""
        return self.call.emit(composer, site)

    def functions(self) -> Iterator[Func]:
        """Yield the scene functions that the object calls."""
        return self.call.functions()
