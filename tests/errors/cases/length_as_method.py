from distal.lang import (func, vec3)


@func
def scene(p: vec3) -> float:
    return p.length() - 1.0
