from distal.lang import (func, vec3)


@func
def scene(p: vec3, options: dict) -> float:
    return p.x
