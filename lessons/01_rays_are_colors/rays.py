"""A camera is a direction for every pixel; here the direction is the color."""

from distal.lang import Frame, image, normalize, select, slider, toggle, vec3

focal = slider("Focal length", 1.0, low=0.2, high=4.0, help="How far the screen is from the eye.")
unit = toggle("Unit length", True, help="Whether every direction has length 1.")


@image
def rays(frame: Frame) -> vec3:
    uv = (frame.coord - 0.5 * frame.resolution) / frame.resolution.y
    through = vec3(uv, focal)
    direction = select(unit, normalize(through), through)
    return 0.5 * direction + 0.5
