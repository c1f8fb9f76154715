from distal.lang import func


@func
def scene(x: float) -> float:
    a = [i for i in range(3)]
    b = sum(i for i in range(3))
    c = {1: 2}
    d = (y := x)
    e = {1, 2}
    f = None
    g = 2j
    return x
