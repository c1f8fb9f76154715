from distal.lang import func


@func
def scene(n: int) -> bool:
    a = n is n
    b = n in (1, 2)
    return a or b
