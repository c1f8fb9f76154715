"""Texts of the program that the CPU runs, and what a host puts into their buffers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from distal.backends import Artifact, emit, get_target
from distal.compiler.driver import run_passes
from distal.devices.resources import load
from distal.frontend import lower
from distal.ir.types import Buffer, Texture
from distal.lang.composed import Composed
from distal.lang.resources import MovingBuffer


def buffer_data(entry: dict[str, Any], buffers: Mapping[str, NDArray[Any]]) -> NDArray[Any]:
    """The elements of a buffer, by its entry in the interface.

    Args:
        entry: One of the interface's ``buffers``.
        buffers: Arrays (count,) or (count, components), by the author's names.
    """
    if "values" not in entry:
        return np.asarray(buffers[entry["name"]])
    return np.array(entry["values"], np.int32 if entry["element"] == "int" else np.float32)


def buffers_of(image: Any, seconds: float) -> dict[str, NDArray[Any]]:
    """The author's buffers of a picture, and the tables of its parts at a time, by name."""
    found = {r.name: r.source for r in lower(image).resources if isinstance(r.type, Buffer)}
    return {name: _numbers(source, seconds) for name, source in found.items()}


def textures_of(image: Any) -> dict[str, NDArray[Any]]:
    """The texels of a picture's textures, by name."""
    found = {r.name: r for r in lower(image).resources if isinstance(r.type, Texture)}
    return {name: load(r.source, r.type) for name, r in found.items()}


def _numbers(source: Any, seconds: float) -> NDArray[Any]:
    # Boxes for all times are right, too, but move the silhouettes of single samples.
    moves = isinstance(source, MovingBuffer)
    return np.asarray(source.at({}, seconds) if moves else source.data)


def text_of(image: Any, target: str) -> Artifact:
    """The text of the program that the CPU runs: with a table of parts where that has one.

    ``distal.compile`` leaves out the tables of fewer than 256 parts: another program, whose
    silhouettes may differ by a pixel.
    """
    whole = image.emitted() if isinstance(image, Composed) else image
    description = get_target(target)
    table = {} if description.buffers else {"table_from": None}
    return emit(run_passes(lower(whole, **table), description), description)
