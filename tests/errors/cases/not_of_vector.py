from distal.lang import (bvec3, func, vec3)


@func
def scene(p: vec3) -> bvec3:
    return not p > 0.0
