"""The one hook through which scene code runs when Python calls it.

``lang`` only records functions. What compiles and runs them stands far above; it gives a loader
here, and the loader is called the first time something is really run.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

if TYPE_CHECKING:
    from distal.ir.intrinsics import Intrinsic
    from distal.lang.composed import Composed
    from distal.lang.expressions import Expression
    from distal.lang.functions import Func, Image
    from distal.lang.names import LangFunction
    from distal.lang.parameters import Parameter


class Executor(Protocol):
    """Runs scene code for Python."""

    def call(
        self,
        function: Func | Composed | LangFunction,
        args: tuple[Any, ...],
        kwargs: Mapping[str, Any],
        params: Mapping[str, Any] | None = None,
        time: float = 0.0,
        device: str = "cpu",
    ) -> Any:
        """The function's value for numbers, vectors or arrays of points."""
        ...

    def render(self, image: Image | Composed, **options: Any) -> Any:
        """The picture of an image or a scene; the options are those of ``Image.render``."""
        ...

    def reads_time(self, image: Image | Composed) -> bool:
        """Whether a picture depends on the time."""
        ...

    def draw(self, image: Image | Composed, view: Any, **options: Any) -> dict[str, Any]:
        """Draw an image of display values into a texture view of wgpu."""
        ...

    def parameters(self, function: Func | Composed) -> list[Parameter]:
        """The parameters that the function and what it calls read, by first use."""
        ...

    def value(self, expression: Expression, params: Mapping[str, Any], time: float) -> Any:
        """The value of an expression of parameters and time."""
        ...


class Presenter(Protocol):
    """Shows pictures elsewhere than in a file of their own."""

    def show(self, obj: Any, **options: Any) -> Any:
        """A live picture in a notebook."""
        ...

    def export(self, obj: Any, path: str | PathLike[str], **options: Any) -> Any:
        """A page, or a text."""
        ...

    def video(self, obj: Any, path: str | PathLike[str], **options: Any) -> Any:
        """A video, or a sequence of pictures."""
        ...


# An operator or built-in by name, and its operands; None where one is no value of scene code.
Combiner: TypeAlias = "Callable[[str, Sequence[Any]], Expression | None]"
# The value of a built-in of plain numbers and vectors, without a device; None where unknown.
Calculator: TypeAlias = "Callable[[Intrinsic, Sequence[Any]], Any | None]"

_calculator: Callable[[], Calculator] | None = None
_combiner: Callable[[], Combiner] | None = None
_presenter: Callable[[], Presenter] | None = None
_loader: Callable[[], Executor] | None = None
_executor: Executor | None = None


def set_executor_loader(loader: Callable[[], Executor]) -> None:
    """Say how the executor is made when it is first needed."""
    global _loader, _executor
    _loader, _executor = loader, None


def set_calculator_loader(loader: Callable[[], Calculator]) -> None:
    """Say where built-ins of constants are computed."""
    global _calculator
    _calculator = loader


def set_combiner_loader(loader: Callable[[], Combiner]) -> None:
    """Say who knows the rules of operators between expressions."""
    global _combiner
    _combiner = loader


def set_presenter_loader(loader: Callable[[], Presenter]) -> None:
    """Say who shows pictures."""
    global _presenter
    _presenter = loader


def presenter() -> Presenter:
    """Who shows pictures."""
    if _presenter is None:
        raise RuntimeError("nothing here shows pictures: no presenter was set")
    return _presenter()


def combined(operation: str, operands: Sequence[Any]) -> Expression | None:
    """The expression that an operation makes of its operands, or None where it takes no such."""
    if _combiner is None:
        raise RuntimeError("nothing here combines expressions: no front end was set")
    return _combiner()(operation, operands)


def calculated(row: Intrinsic, args: Sequence[Any]) -> Any | None:
    """A built-in of constants, or None where only the executor knows."""
    return None if _calculator is None else _calculator()(row, args)


def executor() -> Executor:
    """The executor, made now if it was not yet."""
    global _executor
    if _executor is None:
        if _loader is None:
            raise RuntimeError("nothing here runs scene code: no executor was set")
        _executor = _loader()
    return _executor
