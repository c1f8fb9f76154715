from distal.lang import func


@func
def scene(x: float) -> float:
    class Local:
        y: float

    return x
