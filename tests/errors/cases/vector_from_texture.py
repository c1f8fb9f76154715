from distal.lang import (Texture2D, func, vec3)

photo = Texture2D([[0.0]])


@func
def scene(p: vec3) -> float:
    return (p + photo).x
