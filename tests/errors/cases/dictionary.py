from distal.lang import func

COLORS = {"red": 1.0}


@func
def scene(x: float) -> float:
    return x + COLORS["red"]
