"""A sphere on a plane: march along each ray and show how far it went."""

from distal.lang import Frame, func, image, integer, length, min, normalize, slider, vec3

steps = integer("Max steps", 80, low=1, high=120, help="How often a ray steps before it gives up.")
arrival = slider(
    "Arrival", 0.001, low=0.0005, high=0.5, log=True, help="The distance that counts as a hit."
)
height = slider("Eye height", 2.0, low=0.05, high=4.0, help="How high the camera is.")

FAR = 100.0


@func
def sd_sphere(p: vec3, radius: float) -> float:
    return length(p) - radius


@func
def scene(p: vec3) -> float:
    return min(sd_sphere(p - vec3(0.0, 1.0, 0.0), 1.0), p.y)


@func
def march(origin: vec3, direction: vec3) -> float:
    t = 0.0
    for _ in range(steps):
        d = scene(origin + direction * t)
        if d < arrival or t > FAR:
            break
        t += d
    return t


@image
def depth(frame: Frame) -> vec3:
    uv = (frame.coord - 0.5 * frame.resolution) / frame.resolution.y
    direction = normalize(vec3(uv, 1.0))
    t = march(vec3(0.0, height, -4.0), direction)
    return vec3(1.0 - 0.1 * t) if t < FAR else vec3(0.0)
