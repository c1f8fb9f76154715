"""``@func`` and ``@image``: record a Python function as scene code.

Input: a Python function. Output: an object that holds the function and its source text. The source
is parsed and checked later, when the function is compiled or called.
"""

from __future__ import annotations

import itertools
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import FunctionType
from typing import TYPE_CHECKING, Any, Self, TypeVar

from distal.at_once import cached_property
from distal.lang.live_textures import LastFrame
from distal.lang.option_methods import RenderedImage
from distal.lang.presentable import Presentable
from distal.lang.render_options import RenderOptions
from distal.lang.runtime_access import executor, function_travel, shown_buffers
from distal.lang.source import Source, capture

if TYPE_CHECKING:
    from distal.images.picture import Picture
    from distal.lang.parameters import Parameter

Marked = TypeVar("Marked", bound=Any)  # a Func; scene code sees the types of its parameters


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Overload:
    """One Python function of a ``Func``.

    Attributes:
        python: The function, for its defaults, its globals and its closure.
        source: Its source text.
        enclosing: A copy of the locals of the function that it was defined in: a type that is
            used only in an annotation is not in the closure.
        apart: Whether it is compiled apart from its callers; see ``apart``.
        struct: The ``@struct`` class that it is a method of; None for a function.
        takes_self: Whether its first parameter is a value of this struct.
    """

    python: FunctionType
    source: Source
    enclosing: Mapping[str, Any]
    apart: bool = False
    struct: type | None = None
    takes_self: bool = False


def is_library(overload: Overload) -> bool:
    """Return whether a function is the library's, which does not change."""
    return overload.python.__module__.startswith("distal.")


def is_fixed(overload: Overload) -> bool:
    """Return whether a function is one of the library's modules': the same in each compilation."""
    return is_library(overload) and "<locals>" not in overload.python.__qualname__


class Func:
    """A function of scene code, callable from scene code and, through the executor, from Python.

    Attributes:
        overloads: One or more functions that differ in the types of their parameters.
        remade: A function and the arguments that make it again, of one that is made of data.
    """

    remade: tuple[Callable[..., Any], Any] | None = None

    def __init__(self, overload: Overload) -> None:
        python = overload.python
        self.overloads: list[Overload] = [overload]
        self.__wrapped__ = python
        self.__name__ = python.__name__
        self.__qualname__ = python.__qualname__
        self.__module__ = python.__module__
        self.__doc__ = python.__doc__

    @property
    def name(self) -> str:
        """The name of the function."""
        return self.__name__

    @property
    def python_function(self) -> FunctionType:
        """The Python function that was decorated; the first one if there are overloads."""
        return self.overloads[0].python

    def overload(self, function: Callable[..., Any]) -> Func:
        """Add a version for other parameter types: ``@f.overload`` above ``def f``."""
        self.overloads.append(_record(function, f"@{self.name}.overload", sys._getframe(1)))
        return self

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Evaluate the function for numbers, vectors, or arrays of points (n, 3).

        Float32 arrays in, float32 out; everything else is computed in 64 bits.
        """
        return executor().call(self, args, kwargs)

    def parameters(self) -> list[Parameter]:
        """Return the parameters (sliders and so on) that this and the functions it calls read."""
        return executor().parameters(self)

    def __reduce__(self) -> Any:
        """Pickle by name if an import finds it; else as its source and the values it reads."""
        return function_travel.reduced(self)

    def __copy__(self) -> Self:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        return self

    def __repr__(self) -> str:
        return f"<{type(self).__name__.lower()} {self.__qualname__}>"


_numbers = itertools.count()


class Image(RenderedImage, Func, Presentable):
    """A picture: a function from a Frame to the color of one pixel."""

    @cached_property
    def last_frame(self) -> LastFrame:
        """Its latest picture as a texture; scene code reads it by the image's own name."""
        return LastFrame(self)

    @property
    def shown(self) -> Image:
        """The image to render: itself."""
        return self

    def _rendered(self, options: RenderOptions) -> Picture:
        """Render the picture.

        Raises:
            CompileError: The scene code has mistakes.
            DeviceError: The device is missing or was lost; never with "auto", which then warns.
            TypeError: A value has the wrong type.
            ValueError: A value is out of range, or there is no such parameter or device.
        """
        return executor().render(self.shown, options)


class FrameBuffer(Image):
    """An image that is drawn in every frame and kept, for itself and other images to read.

    Attributes:
        number: Buffers with a lower number are drawn before it.
    """

    def __init__(self, overload: Overload) -> None:
        super().__init__(overload)
        self.number = next(_numbers)

    @cached_property
    def shown(self) -> Image:
        """The image that shows what it drew; see ``lang.shown_buffers``."""
        shown: Image = shown_buffers.picture_of(self)
        return shown


def func(function: Callable[..., Any]) -> Func:
    """Record a Python function as scene code."""
    return Func(_record(function, "@func", sys._getframe(1)))


def apart(function: Marked) -> Marked:
    """Mark a function as ``@apart``: the CPU calls it for each vector of pixels.

    For a long function that few of the pixels computed together need (vectors that do not need it
    are skipped), or with more values than the registers hold for all of them.
    """
    function.overloads = [replace(o, apart=True) for o in function.overloads]
    return function


def image(function: Callable[..., Any]) -> Image:
    """Record a function from a Frame to a vec3 or vec4 as a picture."""
    return Image(_record(function, "@image", sys._getframe(1)))


def buffer(function: Callable[..., Any]) -> FrameBuffer:
    """Record an image that is drawn in every frame, before the picture that reads it.

    ``texel(name, place)`` and ``sample(name, uv)`` read what it drew: in this frame for a reader
    that stands below it in the file, in the last frame for itself and what stands above it. Before
    the first frame all components are 0. Values are floats of 32 bits, as many as the picture has
    pixels.
    """
    return FrameBuffer(_record(function, "@buffer", sys._getframe(1)))


def _record(function: Any, decorator: str, frame: Any) -> Overload:
    if not isinstance(function, FunctionType):
        raise TypeError(f"{decorator} stands directly above a def, not on {function!r}")
    enclosing = {} if frame.f_locals is frame.f_globals else dict(frame.f_locals)
    return Overload(function, capture(function), enclosing)
