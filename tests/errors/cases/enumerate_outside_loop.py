from distal.lang import func

SIZES = [1.0, 2.0, 3.0]


@func
def scene(x: float) -> float:
    pairs = enumerate(SIZES)
    both = zip(SIZES, SIZES)
    return x
