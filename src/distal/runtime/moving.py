"""Resources of what moves, for one picture. Input: resources. Output: arrays for kernels."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from distal.lang.resources import MovingBuffer


def moved_resources(
    resources: Mapping[str, Any], params: Mapping[str, Any], seconds: float
) -> dict[str, Any]:
    """Return resources in which buffers of what moves have the numbers of one picture."""
    return {
        name: source.at(params, seconds) if isinstance(source, MovingBuffer) else source
        for name, source in resources.items()
    }
