from distal.lang import func


@func
def scene(x: float) -> float:
    yield x
    return x
