"""The tapes of functions: made once, kept while the function exists.

Input: functions of a point, and values of their uniforms. Output: tapes that are ready to run.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from distal.at_once import AtOnce
from distal.backends import get_target
from distal.compiler.driver import run_passes
from distal.devices.resources import load
from distal.images.picture import Provenance
from distal.ir.nodes import Module, Origin
from distal.ir.types import Buffer
from distal.lang.composed import Composed
from distal.lang.identity_map import IdentityMap
from distal.lang.render_options import RenderOptions
from distal.loading import loaded_from
from distal.runtime.lowered import Lowered
from distal.runtime.uniform_values import DeclaredUniforms
from distal.tape.from_ir import LAST_PASS, PRECISION, tape_of
from distal.tape.runtime import TapeProgram
from distal.tape.tape import Tape, TapeError

# A function that returns the tape of a shape that has one without compilation.
Ready: TypeAlias = Callable[[], Tape]


@dataclass(frozen=True, slots=True)
class _Known:
    """What is kept of one function; replaced as a whole.

    Attributes:
        lowered: The function; None if its tape needs no compilation.
        module: The module after the passes for tapes; the reason if it has none.
        uniforms: The uniforms of the tape.
        program: The tape of these uniforms.
    """

    lowered: Lowered | None
    module: Module | TapeError | None
    uniforms: Mapping[str, Any]
    program: TapeProgram | None


class FunctionTapes:
    """The tapes of functions, kept while the functions exist."""

    def __init__(self) -> None:
        self._known: IdentityMap[_Known] = IdentityMap()
        self._at_once = AtOnce()

    def ready(self, function: Composed, tape: Ready) -> TapeProgram:
        """Return the tape of a function that has one without compilation."""

        def found() -> TapeProgram | None:
            known = self._known.get(function)
            return None if known is None else known.program

        def made() -> TapeProgram:
            program = TapeProgram(tape())
            self._known[function] = _Known(None, None, {}, program)
            return program

        return self._at_once.result(id(function), found, made)

    def program(
        self, function: Composed, lowered: Lowered, uniforms: Mapping[str, Any]
    ) -> TapeProgram:
        """Return the tape of a function for values of its uniforms.

        Args:
            function: The function.
            lowered: Its IR.
            uniforms: Values of the uniforms.

        Raises:
            TapeError: The function cannot be a tape.
        """

        def found() -> TapeProgram | None:
            known = self._known.get(function)
            if known is None or known.lowered is not lowered:
                return None
            if isinstance(known.module, TapeError):
                raise known.module
            return known.program if known.uniforms == uniforms else None

        def made() -> TapeProgram:
            known = self._known.get(function)
            module = known.module if known is not None and known.lowered is lowered else None
            try:
                module = module or _module_of(lowered)
                assert isinstance(module, Module)
                program = TapeProgram(_tape(module, uniforms))
            except TapeError as error:
                self._known[function] = _Known(lowered, error, {}, None)
                raise
            self._known[function] = _Known(lowered, module, dict(uniforms), program)
            return program

        return self._at_once.result(id(function), found, made)


def _module_of(lowered: Lowered) -> Module:
    return run_passes(lowered.module, get_target("llvm"), PRECISION, after=LAST_PASS)


def _tape(module: Module, uniforms: Mapping[str, Any], precision: int = 32) -> Tape:
    return tape_of(module, uniforms, buffers_of(module), precision)


def buffers_of(module: Module) -> dict[str, Any]:
    """Return the data of a module's buffers, by name."""
    return {
        resource.name: load(resource.source, resource.type)
        for resource in module.resources
        if isinstance(resource.type, Buffer) and resource.source is not None
    }


class Drawing:
    """What a picture by a tape and one by the ordinary kernel have in common: the tape, the origin.

    Attributes:
        program: The tape; None if the function has none.
        stats: What the picture says of how it was made.
    """

    def __init__(
        self, executor: Any, function: Composed, options: RenderOptions, ready: Ready | None
    ) -> None:
        """Make the tape.

        Args:
            executor: The executor that lowers the function.
            function: The function.
            options: Parameters and time.
            ready: Returns the function's tape, if it has one without compilation.
        """
        begin = time.perf_counter()
        self.program: TapeProgram | None = None
        self.stats: dict[str, Any] = {"device": "cpu"}
        self._function, self._time = function, options.time
        self._values: dict[str, Any] = {}
        if ready is not None:
            self.program = executor.tapes.ready(function, ready)
        else:
            lowered = executor.lowered(function)
            uniforms, self._values = uniforms_of(lowered, options.params, options.time)
            try:
                self.program = executor.tapes.program(function, lowered, uniforms)
            except TapeError as error:
                self.stats["no_tape"] = str(error)
        if self.program is not None:
            self.stats["operations"] = len(self.program.tape)
        self._made = time.perf_counter()
        self.stats["compile_s"] = self._made - begin

    def finished(self, view: str, samples: int) -> Provenance:
        """Note the time of drawing, and return the picture's origin.

        Args:
            view: What it shows.
            samples: Samples of a pixel.
        """
        self.stats["render_s"] = time.perf_counter() - self._made
        known = loaded_from(self._function)
        return Provenance(
            source=self._function.name if known is None else known.source,
            source_hash="" if known is None else known.digest,
            parameters=self._values,
            time=self._time,
            samples=samples,
            view=view,
            device="cpu",
        )


def tape_for(
    lowered: Lowered,
    params: Mapping[str, Any] | None = None,
    time: float = 0.0,
    precision: int = 32,
) -> Tape:
    """Return the tape of a function.

    Args:
        lowered: The function.
        params: Values of parameters by name; the others have their defaults. None: the function may
            read neither parameters nor the time.
        time: The time in seconds.
        precision: The bits of its constants, 32 or 64.

    Raises:
        TapeError: The function cannot be a tape, or depends on parameters or the time.
    """
    if params is None:
        if any(uniform.origin is not Origin.NUMBER for uniform in lowered.module.uniforms):
            raise TapeError("it depends on parameters or the time")
        return _tape(_module_of(lowered), {}, precision)
    return _tape(_module_of(lowered), uniforms_of(lowered, params, time)[0], precision)


def uniforms_of(
    lowered: Lowered, params: Mapping[str, Any], time: float
) -> tuple[Mapping[str, Any], dict[str, Any]]:
    """Return the values of a function's uniforms, and those of its parameters.

    Args:
        lowered: The function.
        params: Values of parameters by name; the others have their defaults.
        time: The time in seconds.
    """
    declared = DeclaredUniforms([lowered.module])
    values = declared.parameter_values(params)
    return declared.for_kernel(0, values, {**declared.numbers, "time": time}), values
