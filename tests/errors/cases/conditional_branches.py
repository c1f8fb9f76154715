from distal.lang import (func, vec3)


@func
def scene(p: vec3) -> vec3:
    return p if p.x > 0.0 else 0.0
