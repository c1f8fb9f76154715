"""What workers do: render whole pictures, some rows of a pass, or values at some points.

Input: programs, data and numbers as ``programs`` makes them. Output: arrays. Programs that were
received, and their kernels, are kept in the worker's process.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import Any, Final, cast

import numpy as np
from numpy.typing import NDArray

from distal.cluster import tasks
from distal.cluster.programs import Plain, received
from distal.devices.base import Cancelled
from distal.devices.cpu import CpuKernel
from distal.devices.features import chosen_level
from distal.forking import new_lock
from distal.lang.render_options import Refinement, RenderOptions
from distal.lang.runtime_access import executor
from distal.runtime.device_names import CPU
from distal.runtime.lowered import Lowered
from distal.runtime.received import Received
from distal.version import __version__

# Programs kept in a process; a sweep or a study has one program with many numbers.
_MOST_KEPT: Final = 16
_kept: dict[str, Received] = {}
_lock: Final = new_lock()


def about() -> dict[str, str]:
    """Return what the other side must know of this process before it sends work."""
    return {"version": __version__, "level": chosen_level(None).name}


def constant(content: Any) -> Any:
    """Return plain data: a task of its own, so that each worker gets it once, from any other."""
    return content


def pictures(
    program: Plain, digest: str, data: Mapping[str, Any], call: Plain
) -> list[Plain | None]:
    """Render whole pictures of one program.

    Args:
        program: The program.
        digest: Its hash.
        data: Its data by name.
        call: ``options``, arguments of ``RenderOptions`` that all pictures have;
            ``moments``, the time and index of each; ``exact``, whether the pixels are floats and
            not levels of 8 bits; what ``tasks.run`` reads.

    Returns:
        The pixels of each, what is known of them, and the seconds that they took. None for one of
        several that failed: it is rendered alone then, which says why.
    """

    def body(stop: Callable[[], bool]) -> list[Plain | None]:
        image = _program(program, digest, data)
        asked = [
            _options({**call["options"], "time": at, "index": index}, stop)
            for at, index in call["moments"]
        ]
        if len(asked) == 1:
            return [_picture(image, asked[0], call)]
        return [_picture_or_none(image, each, call) for each in asked]

    return tasks.run(call, body)


def _picture_or_none(image: Received, options: RenderOptions, call: Plain) -> Plain | None:
    try:
        return _picture(image, options, call)
    except Cancelled:
        raise
    except Exception:
        return None


def _picture(image: Received, options: RenderOptions, call: Plain) -> Plain:
    begin = time.perf_counter()
    made, exact = executor().render(image, options), call["exact"]
    pixels = made.array if exact else made.levels
    found: Plain = {
        "pixels": np.asarray(pixels),
        "samples": made.provenance.samples,
        "stats": {k: v for k, v in made.stats.items() if isinstance(v, int | float | str)},
        "lost": dict(made.stats.get("lost", {})),
        "level": chosen_level(None).name,
        "seconds": time.perf_counter() - begin,
    }
    if exact and made.light is not None:
        found["light"] = np.asarray(made.light)
    return found


def rows(
    program: Plain,
    digest: str,
    data: Mapping[str, Any],
    arrays: Mapping[str, NDArray[Any]],
    call: Plain,
) -> tuple[NDArray[np.float32], float, str]:
    """Render some rows of a pass.

    Args:
        program: A program of a picture, of which the first part is rendered.
        digest: Its hash.
        data: Its data by name.
        arrays: The arrays of this pass, by the names of its resources; the others are those of the
            program.
        call: ``size``, ``rows`` and ``uniforms`` of ``CpuKernel.render_rows``; what ``tasks.run``
            reads.

    Returns:
        The rows, the seconds that they took, and the level of this processor.
    """

    def body(stop: Callable[[], bool]) -> tuple[Any, float, str]:
        lowered, kernel = _kernel(program, digest, data)
        begin = time.perf_counter()
        made = kernel.render_rows(
            tuple(call["size"]),
            tuple(call["rows"]),
            call["uniforms"],
            {**lowered.resources, **arrays},
            threads=1,
            cancel=stop,
        )
        return made, time.perf_counter() - begin, chosen_level(None).name

    return tasks.run(call, body)


def values(
    program: Plain,
    digest: str,
    data: Mapping[str, Any],
    arrays: Mapping[str, NDArray[Any]],
    call: Plain,
) -> tuple[Any, float, str]:
    """Return the values of a function at some points; arguments and results as for ``rows``.

    Instead of ``size`` and ``rows`` the call has ``args``, the points.
    """

    def body(stop: Callable[[], bool]) -> tuple[Any, float, str]:
        lowered, kernel = _kernel(program, digest, data)
        begin = time.perf_counter()
        made = kernel.evaluate(
            call["args"],
            call["uniforms"],
            {**lowered.resources, **arrays},
            threads=1,
            cancel=stop,
        )
        return made, time.perf_counter() - begin, chosen_level(None).name

    return tasks.run(call, body)


def _kernel(program: Plain, digest: str, data: Mapping[str, Any]) -> tuple[Lowered, CpuKernel]:
    lowered = _program(program, digest, data).lowered
    return lowered, cast("CpuKernel", executor().kernels.kernel(lowered, CPU, 32))


def _program(program: Plain, digest: str, data: Mapping[str, Any]) -> Received:
    with _lock:
        found = _kept.pop(digest, None)
        if found is None:
            found = received(program, data)
        _kept[digest] = found
        while len(_kept) > _MOST_KEPT:
            _kept.pop(next(iter(_kept)))
        return found


def _options(options: Plain, stop: Callable[[], bool]) -> RenderOptions:
    refinement = options.get("refinement")
    return RenderOptions(
        **{
            **options,
            "refinement": None if refinement is None else Refinement(**refinement),
            "threads": 1,
            "cancel": stop,
        }
    )
