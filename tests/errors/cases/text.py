from distal.lang import func

NAME = "scene"


@func
def scene(x: float) -> float:
    label = "hello"
    other = f"{x}"
    third = NAME
    return x
