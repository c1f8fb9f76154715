from distal.lang import func

SIZES = [1.0, 2.0]


@func
def scene(x: float) -> float:
    for i, size in enumerate(SIZES):
        x += size
    return x
