from distal.lang import (Frame, image, vec3)


@image
def scene(frame: Frame) -> vec3:
    return vec3(frame.tme)
