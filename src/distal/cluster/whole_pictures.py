"""Whole pictures that a worker renders, several quick ones in one task.

Input: a pool, a picture, options. Output: pictures in levels of 8 bits, as films need them, or in
floats. One of several that fails is rendered once more alone, which says why.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import Any, Final

import numpy as np

from distal.cluster import work
from distal.cluster.errors import ClusterError
from distal.cluster.pool import SUBMITTED, WorkerPool
from distal.cluster.programs import Plain, Sent
from distal.cluster.sizes import PartSizes
from distal.devices.base import PartError
from distal.images.picture import Picture
from distal.lang.composed import Composed
from distal.lang.functions import Image
from distal.lang.render_options import RenderOptions
from distal.lang.runtime_access import executor
from distal.runtime.device_names import AUTO, CPU
from distal.runtime.uniform_values import chosen_uniforms

# Options that all pictures of a task have; the others are of this process, or a scene's, whose
# program is sent.
_SENT: Final = (
    *("size", "mouse", "seed", "samples", "freeze", "keys", "buttons", "delta", "date"),
)
# What workers do not get of a refinement.
_FUNCTIONS: Final = ("film", "preview", "finish")
# The most bytes of pictures, as levels of 8 bits, in one task.
_MOST_BYTES: Final = 2**25


def pictures(
    pool: WorkerPool,
    image: Image | Composed,
    asked: Sequence[RenderOptions],
    *,
    exact: bool = False,
) -> list[Picture | PartError]:
    """Render some whole pictures on one of the workers, one after the other.

    Args:
        pool: The workers.
        image: The picture.
        asked: For each, options as for ``PythonExecutor.render``, which differ in ``time`` and
            ``index`` alone; ``progress`` is not called.
        exact: Whether the pixels are those of ``render``; otherwise they are rounded to levels of
            8 bits, which is a quarter to send.

    Returns:
        Each picture; why it failed where no worker could render it, not even alone.

    Raises:
        Cancelled: ``cancel`` of the options stopped the work.
        ClusterError: The scheduler is lost.
    """
    pool.check()
    both = [executor().as_rendered(image, options) for options in asked]
    image, options = both[0][0], [each for _, each in both]
    if len(options) == 1:
        return [_alone(pool, image, options[0], exact=exact)]
    try:
        found = _found(pool, image, options, exact=exact)
    except PartError:
        found = [None] * len(options)
    return [
        _alone(pool, image, each, exact=exact) if of is None else _picture(image, each, of)
        for each, of in zip(options, found, strict=True)
    ]


def of_task(pool: WorkerPool, image: Image | Composed, options: RenderOptions, left: int) -> int:
    """Return how many of the pictures that are left are worth one task.

    Args:
        pool: The workers.
        image: The picture.
        options: As for ``pictures``.
        left: How many are left.
    """
    image, options = executor().as_rendered(image, options)
    return _sizes(pool, pool.program_of(image), options).of_task(left, pool.slots)


def _alone(
    pool: WorkerPool, image: Image | Composed, options: RenderOptions, *, exact: bool
) -> Picture | PartError:
    try:
        [found] = _found(pool, image, [options], exact=exact)
    except PartError as error:
        return error
    return _picture(image, options, found)


def _found(
    pool: WorkerPool, image: Image | Composed, asked: Sequence[RenderOptions], *, exact: bool
) -> list[Any]:
    """Return what a worker has found of each picture, as one task."""
    program = pool.program_of(image)
    first, last = asked[0], asked[-1]
    found = pool.result(
        lambda: pool.client.submit(
            work.pictures,
            pool.constant(program.digest, program.program),
            program.digest,
            pool.data_of(program),
            pool.call(**_plain_options(asked), exact=exact),
            **SUBMITTED,
        ),
        first.cancel,
        f"the picture at {first.time:g} s"
        if len(asked) == 1
        else f"the pictures from {first.time:g} to {last.time:g} s",
    )
    sizes = _sizes(pool, program, first)
    for each in found:
        if each is not None:
            pool.saw_level(each["level"])
            sizes.saw((0, 1), each["seconds"])
    return list(found)


def _sizes(pool: WorkerPool, program: Sent, options: RenderOptions) -> PartSizes:
    width, height = options.size
    sizes = pool.sizes((program.digest, options.size, "pictures"), 1, 1)
    sizes.most = max(1, _MOST_BYTES // (4 * width * height))
    return sizes


def _plain_options(asked: Sequence[RenderOptions]) -> Plain:
    """Return what pictures have in common and what each has, without functions of this process.

    Dask keeps its last thousand messages: what all pictures have is there once in each.
    """
    first = asked[0]
    if first.device not in (CPU, AUTO):
        raise ClusterError(f"workers render on their CPU, not on '{first.device}'")
    refinement = first.refinement
    if refinement is not None and (refinement.finish is not None or refinement.film is not None):
        raise ClusterError("denoise and film are not for whole pictures on workers")
    plain = {name: getattr(first, name) for name in _SENT}
    plain |= {"params": dict(first.params), "settings": dict(first.settings or {})}
    if refinement is not None:
        kept = (f.name for f in fields(refinement) if f.name not in _FUNCTIONS)
        plain["refinement"] = {name: getattr(refinement, name) for name in kept}
    return {"options": plain, "moments": [(each.time, each.index) for each in asked]}


def _picture(image: Image | Composed, options: RenderOptions, found: Mapping[str, Any]) -> Picture:
    """Return the picture that a worker has rendered, as this process would have."""
    pixels = found["pixels"]
    values = chosen_uniforms(executor().parts(image).declared, options)
    origin = executor().origin(image, replace(options, device=CPU), values, found["samples"])
    stats = {**found["stats"], "lost": found["lost"]}
    if pixels.dtype == np.uint8:
        return Picture.of_levels(pixels, origin, stats)
    return Picture(pixels, origin, stats, found.get("light"))
