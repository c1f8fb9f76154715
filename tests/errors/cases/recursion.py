from distal.lang import func


@func
def scene(x: float) -> float:
    return half(x) + 1.0


@func
def half(x: float) -> float:
    return third(x) * 0.5


@func
def third(x: float) -> float:
    return scene(x) / 3.0
