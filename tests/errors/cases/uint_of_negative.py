from distal.lang import (func, uint)


@func
def scene(h: uint) -> uint:
    a = h * -1
    return h + 4294967296
