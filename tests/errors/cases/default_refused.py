from distal.lang import func


@func
def ball(x: float, name: float = "ball") -> float:
    return x


@func
def scene(x: float) -> float:
    return ball(x)
