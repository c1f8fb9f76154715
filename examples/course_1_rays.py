"""Course, step 1: a camera is a direction for every pixel; here the direction is the color.

Ported from "Learn Creative Coding 38: Raymarching", as are the five that follow.
"""

from distal.lang import Frame, image, normalize, vec3


@image
def rays(frame: Frame) -> vec3:
    uv = (frame.coord - 0.5 * frame.resolution) / frame.resolution.y
    direction = normalize(vec3(uv, 1.0))
    return 0.5 * direction + 0.5
