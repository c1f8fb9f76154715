"""Fill flat shapes: one color where the shape's function is negative, another elsewhere.

Input: a function of a point in the plane, a part of the plane, and colors. Output: a ``Picture``.
A function that can be a tape is filled by the tape runtime, which compiles nothing; any other is
evaluated at every sample by its ordinary kernel. Both ways look at the same points.
"""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeAlias
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from distal.backends import get_target
from distal.compiler.driver import run_passes
from distal.devices.base import Cancelled, cancel_test
from distal.devices.resources import load
from distal.images.picture import Picture, Provenance
from distal.ir.nodes import Module, Origin
from distal.ir.types import Buffer
from distal.lang.composed import Composed
from distal.lang.render_options import RenderOptions
from distal.loading import loaded_from
from distal.runtime.lowered import Lowered
from distal.runtime.uniform_values import DeclaredUniforms
from distal.tape.from_ir import LAST_PASS, PRECISION, tape_of
from distal.tape.proofs import Proof, prove
from distal.tape.runtime import PlaneView, TapeProgram
from distal.tape.tape import Tape, TapeError

Floats = NDArray[np.float32]
# A function that returns the tape of a shape that has one without compilation.
Ready: TypeAlias = Callable[[], Tape]
_ROWS: Final = 64  # of pixels that the ordinary kernel evaluates at a time, to limit the memory


@dataclass(slots=True)
class _Known:
    """What is kept of one function.

    Attributes:
        lowered: The function.
        module: The module after the passes for tapes; the reason if it has none.
        uniforms: The uniforms of the tape.
        program: The tape of these uniforms.
    """

    lowered: Lowered | None
    module: Module | TapeError | None
    uniforms: Mapping[str, Any]
    program: TapeProgram | None = None


class FunctionTapes:
    """The tapes of functions, kept while the functions exist."""

    def __init__(self) -> None:
        self._known: WeakKeyDictionary[Any, _Known] = WeakKeyDictionary()
        self._lock = threading.RLock()

    def ready(self, function: Composed, tape: Ready) -> TapeProgram:
        """Return the tape of a function that has one without compilation."""
        with self._lock:
            known = self._known.get(function)
            if known is None or known.program is None:
                known = self._known[function] = _Known(None, None, {}, TapeProgram(tape()))
            assert known.program is not None
            return known.program

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
        with self._lock:
            known = self._known.get(function)
            if known is None or known.lowered is not lowered:
                known = self._known[function] = _Known(lowered, None, {})
            if isinstance(known.module, TapeError):
                raise known.module
            if known.program is None or known.uniforms != uniforms:
                try:
                    known.program = TapeProgram(_tape(known, uniforms))
                except TapeError as error:
                    known.module = error
                    raise
                known.uniforms = dict(uniforms)
            return known.program


def _tape(known: _Known, uniforms: Mapping[str, Any]) -> Tape:
    assert known.lowered is not None
    if known.module is None:
        target = get_target("llvm")
        known.module = run_passes(known.lowered.module, target, PRECISION, after=LAST_PASS)
    assert isinstance(known.module, Module)
    buffers = {
        resource.name: load(resource.source, resource.type)
        for resource in known.module.resources
        if isinstance(resource.type, Buffer) and resource.source is not None
    }
    return tape_of(known.module, uniforms, buffers)


def proof(lowered: Lowered, low: Sequence[float], high: Sequence[float]) -> Proof:
    """Return what can be proved of a function in a region.

    Args:
        lowered: The function, which reads neither parameters nor the time.
        low: The lower corner of the region.
        high: Its upper corner.

    Raises:
        TapeError: Nothing can be proved.
    """
    if any(uniform.origin is not Origin.NUMBER for uniform in lowered.module.uniforms):
        raise TapeError("it depends on parameters or the time")
    return prove(_tape(_Known(lowered, None, {}), {}), low, high)


def fill(
    executor: Any,
    function: Composed,
    edges: Sequence[float],
    colors: Floats,
    options: RenderOptions,
    ready: Ready | None = None,
) -> Picture:
    """Fill a function of a point in the plane.

    Args:
        executor: The executor that lowers and evaluates the function.
        function: The function.
        edges: The left edge, the width of a pixel, the upper edge, and the height of a pixel.
        colors: The color of a pixel for each number of its samples that are inside, from 0 to all.
        options: Size, time, parameters, threads, progress and cancel.
        ready: Returns the function's tape, if it has one without compilation.
    """
    begin = time.perf_counter()
    view = PlaneView(*edges)
    values: dict[str, Any] = {}
    stats: dict[str, Any] = {"device": "cpu"}
    program: TapeProgram | None = None
    if ready is not None:
        program = executor.tapes.ready(function, ready)
    else:
        lowered = executor.lowered(function)
        declared = DeclaredUniforms([lowered.module])
        values = declared.parameter_values(options.params)
        uniforms = declared.for_kernel(0, values, {**declared.numbers, "time": options.time})
        try:
            program = executor.tapes.program(function, lowered, uniforms)
        except TapeError as error:
            stats["no_tape"] = str(error)
    made = time.perf_counter()
    if program is not None:
        stats["operations"] = len(program.tape)
        pixels = program.fill(
            *options.size,
            view,
            colors=colors,
            threads=options.threads,
            progress=options.progress,
            cancel=options.cancel,
        )
    else:
        pixels = _by_kernel(executor, function, view, colors, options)
    stats |= {"compile_s": made - begin, "render_s": time.perf_counter() - made}
    known = loaded_from(function)
    origin = Provenance(
        source=function.name if known is None else known.source,
        source_hash="" if known is None else known.digest,
        parameters=values,
        time=options.time,
        samples=len(colors) - 1,
        view="fill",
        device="cpu",
    )
    return Picture(pixels, origin, stats)


def _by_kernel(
    executor: Any, function: Composed, view: PlaneView, colors: Floats, options: RenderOptions
) -> Floats:
    """Evaluate the ordinary kernel at every sample.

    Args:
        executor: The executor.
        function: The function.
        view: The part of the plane that is shown.
        colors: The color for each number of samples inside.
        options: The options.
    """
    width, height = options.size
    across = math.isqrt(len(colors) - 1)
    shifts = (np.arange(across, dtype=np.float32) + np.float32(0.5)) / np.float32(across)
    picture = np.empty((height, width, 4), np.float32)
    is_cancelled = cancel_test(options.cancel)
    columns = np.arange(width, dtype=np.float32)
    for top in range(0, height, _ROWS):
        if is_cancelled():
            raise Cancelled
        rows = np.arange(top, min(top + _ROWS, height), dtype=np.float32)
        inside = np.zeros((len(rows), width), np.intp)
        for down in shifts:
            for right in shifts:
                x = np.float32(view.x) + (columns + right) * np.float32(view.step_x)
                y = np.float32(view.y) + (rows + down) * np.float32(view.step_y)
                points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
                found = executor.call(
                    function, (points,), {}, params=options.params, time=options.time
                )
                inside += (found < 0.0).reshape(inside.shape)
        picture[top : top + len(rows)] = colors[inside]
        if options.progress is not None:
            options.progress(min(1.0, (top + _ROWS) / height))
    return picture
