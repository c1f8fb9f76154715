from distal.lang import (Frame, image, vec3)


@image
def scene(frame: Frame, color: vec3) -> vec3:
    return color
