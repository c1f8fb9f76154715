from distal.lang import func


@func
def scene(p) -> float:
    return p - 1.0
