"""Objects that build their own IR function: shapes, scenes and views of them.

Input: an object. Output: a function of the IR, built when the object is compiled. The compiler,
the executor and scene code accept such an object wherever they accept a ``Func``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, ClassVar

from distal.ir.nodes import EntryKind
from distal.ir.types import Type
from distal.lang.functions import Func
from distal.lang.immutable import Immutable
from distal.lang.runtime_access import executor

if TYPE_CHECKING:
    from distal.lang.parameters import Parameter


class Composed(Immutable, ABC):
    """An object that builds its own IR function. It is immutable.

    Attributes:
        name: Its name in messages.
        kind: Whether the function is evaluated at points or as a picture.
        signature: Names and types of its parameters.
        result: The type of its result.
        display: For a picture with linear light: the function ``(vec4) -> vec4`` that encodes
            its pixels for display. None if the pixels are already encoded.
        adaptive: Whether it is a picture of linear light that is rendered in the two passes of
            ``runtime.sampling``.
        refined: Whether it is a picture of linear light that gets ever more samples
            (``runtime.accumulation``).
        photons: For a refined picture: the programs of its photons (``runtime.photons``); None if
            it has none.
        glow: For a picture with linear light: how much of the halo of ``runtime.glow`` is added.
    """

    kind: ClassVar[EntryKind] = EntryKind.FUNCTION
    name: str
    signature: tuple[tuple[str, Type], ...]
    result: Type
    display: Composed | None = None
    adaptive: bool = False
    refined: bool = False
    photons: tuple[Composed, Composed] | None = None
    glow: float = 0.0

    @abstractmethod
    def compose(self, assembly: Any) -> str:
        """Add the function to a program and return its name there.

        ``assembly`` is the front end's object that collects the functions of a program.

        Raises:
            CompileError: The object cannot be expressed in scene code.
        """

    def emitted(self) -> Composed:
        """Return the object to emit as text: for a picture, one with display values."""
        return self

    def functions(self) -> Iterable[Func]:
        """Return the author's functions that the object contains, to detect changes of them."""
        return ()

    def parameters(self) -> list[Parameter]:
        """Return the parameters (sliders and so on) that the object reads."""
        return executor().parameters(self)

    def __repr__(self) -> str:
        return f"<{type(self).__name__.lower()} {self.name}>"
