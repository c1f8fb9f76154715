"""What a host puts into a buffer: the text's own tables, else what the caller has."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from distal.frontend import lower
from distal.ir.types import Buffer


def buffer_data(entry: dict[str, Any], buffers: Mapping[str, NDArray[Any]]) -> NDArray[Any]:
    """The elements of a buffer, by its entry in the interface.

    Args:
        entry: One of the interface's ``buffers``.
        buffers: Arrays (count,) or (count, components), by the author's names.
    """
    if "values" not in entry:
        return np.asarray(buffers[entry["name"]])
    return np.array(entry["values"], np.int32 if entry["element"] == "int" else np.float32)


def buffers_of(image: Any) -> dict[str, NDArray[Any]]:
    """The author's buffers of a picture, and the tables of its parts, by name."""
    resources = lower(image).resources
    return {r.name: np.asarray(r.source.data) for r in resources if isinstance(r.type, Buffer)}
