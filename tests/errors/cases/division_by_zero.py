from distal.lang import func


@func
def scene(n: int) -> int:
    a = 1 / 0
    b = n // 0
    return n % 0
