from distal.lang import func, struct, vec3


@struct
class Ray:
    origin: vec3
    direction: vec3

    @func
    def at(self, t: float) -> vec3:
        return self.origin + self.direction * t

    @func
    def move(self, by: vec3) -> vec3:
        self.origin += by
        return self.origin


@func
def scene(p: vec3) -> float:
    ray = Ray(p, p)
    x = ray.at().x
    y = ray.at(p).y
    z = ray.on(1.0).z
    w = ray.at.x
    v = ray.move(p).x
    return x + y + z + w + v
