from distal.lang import (func, length, vec2, vec3, vec4)


@func
def ball(p: vec2) -> float:
    return length(p) - 1.0


@ball.overload
def ball(p: vec3) -> float:
    return length(p) - 1.0


@func
def scene(p: vec4) -> float:
    return ball(p)
