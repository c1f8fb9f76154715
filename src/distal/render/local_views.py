"""Show the local variables of an author's picture as colors: numbers, coordinates, vectors.

Input: the value of a local at a pixel, and whether the pixel reached it. Output: a color that shows
magnitude and sign for any range.
"""

from __future__ import annotations

from distal.lang import abs, clamp, exp, func, max, mix, select, smoothstep, vec2, vec3, vec4

UNREACHED = vec4(0.08, 0.08, 0.1, 1.0)


@func
def shown_number(value: float, reached: bool) -> vec4:
    """Show 0 to 1 as black to white, bluer below 0, warmer above 1, with a line at each integer."""
    below = vec3(0.15, 0.4, 1.0) * (1.0 - exp(at_most_zero(value)))
    within = vec3(clamp(value, 0.0, 1.0))
    warm = mix(vec3(0.75, 0.2, 0.05), vec3(1.0, 0.95, 0.85), exp(-0.5 * max(value - 1.0, 0.0)))
    to_line = abs((value + 0.5) % 1.0 - 0.5)
    above = warm * (0.7 + 0.3 * smoothstep(0.0, 0.06, to_line))
    color = select(value < 0.0, below, select(value > 1.0, above, within))
    return select(reached, vec4(color, 1.0), UNREACHED)


@func
def at_most_zero(value: float) -> float:
    """Return the value if it is below 0, else 0."""
    return -max(-value, 0.0)


@func
def shown_coordinate(value: vec2, reached: bool) -> vec4:
    """Show x as red and y as green: dark to bright from -1 to 1, repeated in a triangle wave."""
    there_and_back = 1.0 - abs((0.5 * value + 0.5) % 2.0 - 1.0)
    return select(reached, vec4(there_and_back, 0.5, 1.0), UNREACHED)


@func
def shown_vector(value: vec3, reached: bool) -> vec4:
    """Show magnitudes of x, y, z as red, green, blue; negative ones at 0.4 of the brightness."""
    color = clamp(max(value, -0.4 * value), 0.0, 1.0)
    return select(reached, vec4(color, 1.0), UNREACHED)


@func
def pixel_place(coord: vec2, resolution: vec2) -> vec2:
    """Return the coordinate of a pixel: y is -1 to 1 from bottom to top, x has the same unit."""
    return (2.0 * coord - resolution) / resolution.y
