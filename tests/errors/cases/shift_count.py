from distal.lang import func


@func
def scene(n: int) -> int:
    return n << 32
