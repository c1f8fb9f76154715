from distal.lang import atan, func, vec3


@func
def scene(p: vec3) -> float:
    a = lerp(p.x, p.y, 0.5)
    b = dFdx(p.x)
    c = random()
    d = smoothstep(0.0, 1.0, p.x)
    return a + b + c + d + atan(p.y, p.x)
