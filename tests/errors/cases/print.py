from distal.lang import func


@func
def scene(x: float) -> float:
    print(x)
    return x
