from collections.abc import Callable

from distal.lang import func


@func
def total(*values: float) -> float:
    return values[0]


@func
def at_two(f: Callable[[float], float]) -> float:
    return f(2.0)


@func
def scene(x: float) -> float:
    return at_two(total)
