from distal.lang import (func, length, mix, vec3)


@func
def scene(p: vec3) -> float:
    return mix(
        length(p),
        length(
            p.x,
        ),
        0.5,
    )
