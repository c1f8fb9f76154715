from distal.lang import (func, vec3)


@func
def ball(x: float, center: vec3 = 1.0) -> float:
    return x + center.x


@func
def scene(x: float) -> float:
    return ball(x)
