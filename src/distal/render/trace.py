"""Which march follows a ray: sphere tracing, or the hybrid one for terrain and water."""

from __future__ import annotations

from distal.fields.guarantees import Bounds
from distal.lang import Field3, func
from distal.render.camera import Ray
from distal.render.heightfield_march import Stride, march_heightfield
from distal.render.march import Hit, March, march


@func
def first_surface(
    field: Field3,
    ray: Ray,
    bounds: Bounds,
    numbers: March,
    steps: int,
    hybrid: bool,
    stride: Stride,
) -> Hit:
    """The first surface along a ray; ``hybrid`` is a choice fixed when compiled."""
    if hybrid:
        return march_heightfield(field, ray, bounds, numbers, stride, steps)
    return march(field, ray, bounds, numbers, steps)
