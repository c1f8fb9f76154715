"""What scene code gives without arrays: parameters, values, and whether a picture moves.

Input: recorded functions and plain numbers. Output: plain numbers. Needs the standard library
alone, so that a compiler in a browser knows as much of a scene as a page needs.
``runtime.executor`` adds what needs NumPy.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final, NoReturn

from distal.at_once import AtOnce
from distal.backends import get_target
from distal.compiler.constant_functions import evaluate
from distal.compiler.driver import run_passes
from distal.ir.nodes import FRAME_TIME, Expr, Module, Origin, Uniform
from distal.ir.types import FLOAT, VEC4, Struct, Type, Vector
from distal.ir.walk import expressions_in, map_expressions, substitute
from distal.lang.composed import Composed
from distal.lang.expressions import Expression
from distal.lang.functions import Func, Image
from distal.lang.identity_map import IdentityMap
from distal.lang.live_textures import ImageInput, Keyboard, LiveTexture, SoundFile
from distal.lang.names import LangFunction
from distal.lang.parameters import Parameter
from distal.lang.render_options import checked_time
from distal.lang.value_of import ValueOf
from distal.lang.values import VALUE_CLASSES
from distal.packages import imported, is_installed
from distal.passes.numbers import constant
from distal.runtime.images_read import ImagesRead, images_read
from distal.runtime.lowered import Lowered, Types
from distal.runtime.received import Received
from distal.runtime.uniform_values import DeclaredUniforms

# The values of the frame that are others in the next one. Dragging the mouse is no movement.
_MOVING: Final = frozenset({"time", "index", "date"})
# Those that a page has only if its player keeps frames.
_OF_FRAMES: Final = frozenset({"delta", "date", "buttons"})


@dataclass(frozen=True, slots=True)
class Parts:
    """What is run for a function.

    Attributes:
        parts: The function and, if there is one, the function that encodes its pixels for display.
        declared: The uniforms of these and of the images whose frames it reads.
        read: The images whose frames it reads.
        frames: Those images, lowered.
    """

    parts: tuple[Lowered, ...]
    declared: DeclaredUniforms
    read: ImagesRead
    frames: tuple[Lowered, ...]


class StandardExecutor:
    """Answers questions about scene code; keeps lowered functions until the process ends.

    A function is lowered again if a constant that it captured has changed.
    """

    def __init__(self) -> None:
        self._at_once = AtOnce()
        self._lowered: IdentityMap[dict[Types, Lowered]] = IdentityMap()
        self._together: IdentityMap[Parts] = IdentityMap()

    def parameters(self, function: Func | Composed) -> list[Parameter]:
        """Return the parameters that a function and its callees read, in order of first use."""
        return list(self.parts(function).declared.parameters)

    def reads_time(self, image: Image | Composed) -> bool:
        """Return whether the picture depends on the time."""
        run = self.parts(image)
        return bool(run.frames) or any(reads_time(part.module) for part in run.parts)

    def keeps_frames(self, image: Image | Composed) -> bool:
        """Return whether the picture reads what only a host that draws frame after frame knows.

        That is earlier frames, the keyboard, the buttons of the mouse, the date, the seconds
        between frames.
        """
        return isinstance(image, Image) and any(
            keeps_frames(part.module) for part in self.parts(image).parts
        )

    def reads_keyboard(self, image: Image | Composed) -> bool:
        """Return whether the picture, or an image whose frames it reads, reads the keyboard."""
        run = self.parts(image)
        resources = (r for part in (*run.parts, *run.frames) for r in part.module.resources)
        return any(isinstance(r.source, Keyboard) for r in resources)

    def sounds(self, image: Image | Composed) -> list[SoundFile]:
        """Return the sounds that the picture, and images whose frames it reads, read; each once."""
        run = self.parts(image)
        resources = (r for part in (*run.parts, *run.frames) for r in part.module.resources)
        return list(dict.fromkeys(r.source for r in resources if isinstance(r.source, SoundFile)))

    def follows_time(self, function: Func | Composed) -> bool:
        """Return whether a function that is no picture depends on the time."""
        now = Uniform(FRAME_TIME, FLOAT)
        functions = self.lower(function, None).module.functions
        return any(now in expressions_in(f.body) for f in functions)

    def lowered(self, function: Func | Composed) -> Lowered:
        """Return the IR of a function that has the types of its own parameters."""
        return self.lower(function, None)

    def value(self, expression: Expression, params: Mapping[str, Any], time: float) -> Any:
        """Return the value of an expression for values of its parameters and a time in seconds.

        Args:
            expression: The expression.
            params: Values of parameters by name; the others have their defaults.
            time: Seconds.
        """
        return _evaluated(Lowered.of(ValueOf(expression), None).module, params, checked_time(time))

    def call(
        self,
        function: Func | Composed | LangFunction,
        args: Sequence[Any],
        kwargs: Mapping[str, Any],
        params: Mapping[str, Any] | None = None,
        time: float = 0.0,
        device: str = "",
    ) -> Any:
        """Evaluate a function without arguments; as ``PythonExecutor.call``.

        Raises:
            PackageError: It has arguments, or it is one that only a device can evaluate.
        """
        if args or kwargs:
            _needs_arrays()
        return _evaluated(self.lower(function, None).module, params or {}, checked_time(time))

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            # What only the executor with arrays can do.
            if not name.startswith("_") and not is_installed("numpy"):
                _needs_arrays()
            raise AttributeError(f"an executor has no '{name}'", name=name, obj=self)

    def parts(self, function: Func | Composed) -> Parts:
        """Return the functions to run for an image or function; cached while they are unchanged."""
        first = self.lower(function, None)
        display = function.display if isinstance(function, Composed) else None
        parts = (first,) if display is None else (first, self.lower(display, (VEC4,)))
        read = images_read(
            first.resources.values(), lambda image: self.lower(image, None).resources.values()
        )
        frames = tuple(self.lower(image, None) for image in read.all)
        known = self._together.get(function)
        if known is None or (known.parts, known.frames) != (parts, frames):
            declared = DeclaredUniforms([p.module for p in (*parts, *frames)])
            known = self._together[function] = Parts(parts, declared, read, frames)
        return known

    def lower(self, function: Func | Composed | LangFunction, types: Types) -> Lowered:
        """Lower the function; the result is cached while the captured constants are unchanged."""
        if isinstance(function, LangFunction):
            return Lowered.of(function, types)
        if isinstance(function, Received):
            return function.lowered
        known = self._lowered.setdefault(function, {})

        def found() -> Lowered | None:
            lowered = known.get(types)
            return lowered if lowered is not None and lowered.captured.is_fresh() else None

        def made() -> Lowered:
            lowered = known[types] = Lowered.of(function, types)
            return lowered

        return self._at_once.result((id(function), types), found, made)


def reads_time(module: Module) -> bool:
    """Return whether a picture's module, before the passes, reads what changes with time."""
    if any(isinstance(r.source, LiveTexture) for r in module.resources):
        return True
    entered = run_passes(module, get_target("glsl-es300"), after="entry")
    return any(u.origin is Origin.FRAME and u.name in _MOVING for u in entered.uniforms)


def keeps_frames(module: Module) -> bool:
    """Return whether a picture's module, before the passes, reads what changes with each frame."""
    if any(isinstance(r.source, LiveTexture | ImageInput) for r in module.resources):
        return True
    entered = run_passes(module, get_target("glsl-es300"), after="entry")
    return any(u.origin is Origin.FRAME and u.name in _OF_FRAMES for u in entered.uniforms)


def all_values(
    declared: DeclaredUniforms,
    params: Mapping[str, Any],
    seconds: float,
    settings: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """Return the uniforms of a function that is called from Python."""
    others = {**declared.number_values(settings or {}), "time": seconds}
    return declared.for_kernel(0, declared.parameter_values(params), others)


def _evaluated(module: Module, params: Mapping[str, Any], seconds: float) -> Any:
    """Return the value of a function without arguments.

    Raises:
        PackageError: It is one that only a device can evaluate.
    """
    declared = DeclaredUniforms([module])
    values = {**declared.numbers, **declared.parameter_values(params)}
    known: dict[Expr, Expr] = {
        Uniform(u.name, u.type): constant(values[u.name], u.type) for u in module.uniforms
    }
    known[Uniform(FRAME_TIME, FLOAT)] = constant(seconds, FLOAT)
    memo: dict[Expr, Expr] = {}
    functions = tuple(
        replace(f, body=map_expressions(f.body, lambda e: substitute(e, known, memo)))
        for f in module.functions
    )
    found = evaluate(replace(module, functions=functions, uniforms=()))
    if found is None:
        _needs_arrays()
    return _named(found, module.function(module.entry).result)


def _named(value: Any, type: Type) -> Any:
    """Return nested tuples of numbers as the values of the language."""
    match type:
        case Vector():
            return VALUE_CLASSES[type](*value)
        case Struct(_, fields):
            return tuple(_named(v, t) for v, (_, t) in zip(value, fields, strict=True))
        case _:
            return value


def _needs_arrays() -> NoReturn:
    """Report that NumPy is missing.

    Raises:
        PackageError: Always.
    """
    imported("numpy")
    raise AssertionError("the executor with arrays is used wherever NumPy is installed")
