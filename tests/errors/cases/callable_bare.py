from collections.abc import Callable

from distal.lang import (func, vec3)


@func
def scene(field: Callable, p: vec3) -> float:
    return field(p)
