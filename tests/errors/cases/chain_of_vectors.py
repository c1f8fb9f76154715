from distal.lang import (bvec3, func, vec3)


@func
def scene(p: vec3) -> bvec3:
    return 0.0 < p < 1.0
