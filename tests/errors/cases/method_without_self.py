from distal.lang import func, struct


@struct
class Ball:
    radius: float

    @func
    def area() -> float:
        return 1.0

    def volume(self) -> float:
        return self.radius


@func
def scene(x: float) -> float:
    a = Ball(x).area()
    b = Ball(x).volume()
    return a + b
