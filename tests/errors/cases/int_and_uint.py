from distal.lang import (func, uint)


@func
def scene(h: uint, i: int) -> uint:
    return h + i
