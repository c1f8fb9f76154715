from distal.lang import func


@func
def scene(x: float) -> float:
    a = 3000000000
    b = 1e39
    c = 1e400
    return x
