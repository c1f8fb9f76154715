from distal.lang import func


@func
def scene(x: float) -> float:
    def outer(y: float) -> vec3:
        return y

    return outer(x)
