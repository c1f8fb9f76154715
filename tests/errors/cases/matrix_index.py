from distal.lang import (func, mat3)


@func
def scene(m: mat3) -> float:
    return m[0, 1]
