from distal.lang import func

SIZES = [1.0, 2.0, 3.0]


@func
def scene(x: float, n: int) -> float:
    for a, b in zip(SIZES, [x, x], strict=True):
        x += a * b
    for a, i in zip(SIZES, range(n)):
        x += a * float(i)
    for a, b, c in zip(SIZES, SIZES):
        x += a * b * c
    for pair in zip():
        x += pair
    for a.x in SIZES:
        x += 1.0
    return x
