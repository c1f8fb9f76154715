from distal.lang import func


@func
def scene(x: float) -> float:
    assert x > 0.0
    global y
    import math

    try:
        x = 1.0
    except ValueError:
        x = 2.0
    with x:
        pass
    raise ValueError
    del x
    match x:
        case 1.0:
            pass
    return x
