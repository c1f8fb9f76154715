from distal.lang import (func, vec2)


@func
def scene(p: vec2) -> float:
    return p.z
