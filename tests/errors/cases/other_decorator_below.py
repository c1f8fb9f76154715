from functools import wraps

from distal.lang import func


def twice(function):
    @wraps(function)
    def wrapped(x):
        return 2.0 * function(x)

    return wrapped


@func
@twice
def scene(x: float) -> float:
    return x
