from distal.lang import func


@func
def scene(x: float) -> float:
    for i in range(x):
        x += 1.0
    return x
