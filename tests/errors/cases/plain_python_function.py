from distal.lang import (func, length, vec3)


def radius() -> float:
    return 1.0


@func
def scene(p: vec3) -> float:
    return length(p) - radius()
