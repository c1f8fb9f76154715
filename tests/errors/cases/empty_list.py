from distal.lang import func

SIZES = []


@func
def scene(x: float) -> float:
    total = x
    for size in SIZES:
        total += size
    return total
