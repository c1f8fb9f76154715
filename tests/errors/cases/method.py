from distal.lang import func


class Shapes:
    @func
    def ball(self, x: float) -> float:
        return x


scene = Shapes.ball
