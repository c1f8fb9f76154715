from distal.lang import (func, struct)


@struct
class Label:
    text: str


@func
def scene(x: float) -> float:
    label = Label(x)
    return x
