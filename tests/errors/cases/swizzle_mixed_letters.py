from distal.lang import (func, vec2, vec4)


@func
def scene(p: vec4) -> vec2:
    return p.xg
