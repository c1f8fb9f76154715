from distal.lang import func


@func
def scene(x: float) -> float:
    for i in range(4):
        x += 1.0
    else:
        x = 0.0
    return x
