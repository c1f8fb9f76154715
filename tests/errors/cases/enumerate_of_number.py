from distal.lang import func


@func
def scene(x: float) -> float:
    for i, size in enumerate(3):
        x += size * float(i)
    return x
