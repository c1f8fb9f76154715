from distal.lang import func


@func
def scene(n: int, m: int) -> int:
    a = n**m
    b = n**-1
    return n**0.5
