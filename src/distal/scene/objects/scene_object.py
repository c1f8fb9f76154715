"""Base classes of lights, cameras, materials and backgrounds.

Input: the calls of scene functions that the objects hold. Output: the base classes, whose objects
show their arguments, and are placed by them. Does not depend on how the calls are made.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Self

from distal.fields.guarantees import Operator
from distal.ir.nodes import Expr
from distal.lang.functions import Func
from distal.lang.immutable import Immutable
from distal.lang.source_places import author_place
from distal.render.declarations import Declaration, Family
from distal.scene.objects.binding import bound
from distal.scene.objects.movable import Movable, MovableSolid
from distal.scene.tree.calls import FunctionCall
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.placement import AffinePlacement, placement_of
from distal.scene.tree.value import CalledValue
from distal.scene.tree.varying import Composer, VaryingNumber


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


class PlacedObject(MovableSolid, SceneObject):
    """An object in space, which is placed by its arguments: a light, a camera.

    Attributes:
        family: The family of its declaration, which says how each argument moves.
    """

    __slots__ = ()

    family: ClassVar[Family]

    def _with(self, operator: Operator, *args: Any, **kwargs: Any) -> Self:
        place = author_place()
        numbers, constants = bound(operator, args, kwargs, place)
        for name, value in constants.items():
            if isinstance(value, VaryingNumber):
                hint = "place it by numbers, parameters and time"
                refuse(f"a {self.noun} is one: its {name} differs from place to place", hint, place)
        placement = placement_of(operator, numbers, constants)
        assert placement is not None, f"'{operator.name}' is no placement"
        return self._placed(placement)

    if not TYPE_CHECKING:  # a checker reports the operator itself

        def __ror__(self, other):
            if isinstance(other, Movable):
                hint = f"group(shape, {self.noun}) places them together"
                refuse_kind(f"shapes are united by |, and this is a {self.noun}", hint)
            return NotImplemented

    def _placed(self, placement: AffinePlacement) -> Self:
        """Return the same object elsewhere."""
        declaration: Declaration | None = getattr(type(self), "declaration", None)
        moves = {**self.family.moves, **(declaration.moves if declaration else {})}
        changes = {
            name: placement.argument(moves[name], value)
            for name, value in self.arguments.items()
            if name in moves and value is not None
        }
        return self.replace(**changes) if changes else self


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
