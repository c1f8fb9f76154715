"""Objects that are functions of scene code without a ``def``: shapes, scenes, their views.

Input: an object. Output: a function of the IR, which the object builds itself when it is compiled.
The compiler, the executor and scene code take such an object wherever they take a ``Func``.
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
    """A function of the IR that an object builds itself. It never changes once it is made.

    Attributes:
        name: Its name in messages.
        kind: Whether it is run over points, or as a picture.
        signature: Its parameters, by name and type.
        result: The type of its result.
        display: For a picture whose pixels are linear light: the function ``(vec4) -> vec4`` that
            encodes them for display; None where they are encoded already.
    """

    kind: ClassVar[EntryKind] = EntryKind.FUNCTION
    name: str
    signature: tuple[tuple[str, Type], ...]
    result: Type
    display: Composed | None = None

    @abstractmethod
    def compose(self, assembly: Any) -> str:
        """Add the function to a program; its name there. ``assembly`` is the front end's.

        Raises:
            CompileError: The object says what scene code cannot say.
        """

    def text(self) -> Composed:
        """What an emitted text shows: for a picture, display values."""
        return self

    def functions(self) -> Iterable[Func]:
        """The author's own functions within, for whoever must know whether they changed."""
        return ()

    def parameters(self) -> list[Parameter]:
        """The parameters (sliders and the like) that it reads."""
        return executor().parameters(self)

    def __repr__(self) -> str:
        return f"<{type(self).__name__.lower()} {self.name}>"
