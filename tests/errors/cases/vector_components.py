from distal.lang import (func, vec2, vec3, vec4)


@func
def scene(p: vec3) -> vec3:
    a = vec3(p.x, p.y)
    b = vec3(vec4(p, 1.0))
    c = vec2()
    d = vec3(x=1.0)
    return a + b
