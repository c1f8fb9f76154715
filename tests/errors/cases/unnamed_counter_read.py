from distal.lang import func


@func
def scene(x: float) -> float:
    for _ in range(4):
        for _ in range(3):
            x += 1.0
        x += float(_)
    return x
