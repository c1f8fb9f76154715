from distal.lang import func


@func
def scene(n: int) -> int:
    return n * scene(n - 1) if n > 1 else 1
