"""Backdrops of the looks: a seamless studio, an open sky, lines of a drawing.

Input: a unit direction, or a place on a surface, and the numbers of a look. Output: linear light,
or a color. Soft boxes are visible only in mirrors and in glass: they are above or behind the
camera. Does not depend on the lights that ``scene.looks`` makes of the same numbers.
"""

from __future__ import annotations

from distal.lang import (
    abs,
    clamp,
    cos,
    cross,
    dot,
    exp,
    floor,
    fract,
    func,
    length,
    max,
    min,
    mix,
    normalize,
    round,
    select,
    sin,
    smoothstep,
    vec2,
    vec3,
)

UP = vec3(0.0, 1.0, 0.0)
# Cells of stars along the radius of the sky: each is 1/90 of a radian wide.
STAR_CELLS = 90.0


@func
def towards(azimuth: float, elevation: float) -> vec3:
    """Return the unit direction of an azimuth (0 is +z, pi/2 is +x) and an elevation."""
    return vec3(sin(azimuth) * cos(elevation), sin(elevation), cos(azimuth) * cos(elevation))


@func
def soft_box(direction: vec3, to: vec3, half: vec2, edge: float) -> float:
    """Return how much of a distant rectangular lamp is seen in a direction: 0 to 1.

    Args:
        direction: Unit direction.
        to: Unit direction to the middle of the lamp; not straight up.
        half: Half of its width and height, at distance 1.
        edge: Width of its soft edge, at distance 1.
    """
    right = normalize(cross(UP, to))
    along = max(dot(direction, to), 1e-3)
    across = abs(dot(direction, right)) / along - half.x
    upward = abs(dot(direction, cross(to, right))) / along - half.y
    ahead = select(dot(direction, to) > 0.0, 1.0, 0.0)
    return ahead * (1.0 - smoothstep(0.0, edge, max(across, upward)))


@func
def studio_backdrop(
    direction: vec3,
    azimuth: float,
    light_azimuth: float,
    light_elevation: float,
    rim_azimuth: float,
    rim_elevation: float,
    rim_intensity: float,
    rim_color: vec3,
    sky: vec3,
    fill: float,
    zenith: vec3,
    horizon: vec3,
    floor_color: vec3,
) -> vec3:
    """A seamless studio: a curved wall in the floor's own light, and soft boxes.

    At the horizon the wall has the radiance of the floor beyond the main light's pool, so that no
    line separates them; above it the wall becomes darker.

    Args:
        direction: Unit direction.
        azimuth: The camera's azimuth, in radians.
        light_azimuth: Azimuth of the main light, to the right of the camera's.
        light_elevation: Its elevation.
        rim_azimuth: Azimuth of the second light, to the right of the camera's.
        rim_elevation: Its elevation.
        rim_intensity: Its intensity.
        rim_color: Its color.
        sky: Color of the light from above.
        fill: Intensity of the light from above.
        zenith: Color of the wall overhead, relative to the floor's light.
        horizon: The same at the horizon.
        floor_color: Color of the floor.
    """
    lit = floor_color * (sky * fill + rim_color * (rim_intensity * sin(rim_elevation)))
    color = lit * mix(horizon, zenith, smoothstep(0.0, 0.7, direction.y))
    key = towards(azimuth + light_azimuth, light_elevation)
    rim = towards(azimuth + rim_azimuth, rim_elevation)
    color += vec3(4.6, 4.4, 4.1) * soft_box(direction, key, vec2(0.5, 0.34), 0.12)
    color += rim_color * (2.4 * soft_box(direction, rim, vec2(0.2, 0.7), 0.12))
    # Tall strips on both sides of the camera: vertical glossy faces show their edges.
    left = towards(azimuth - 1.35, 0.12)
    right = towards(azimuth + 1.2, 0.1)
    color += vec3(2.2, 2.15, 2.1) * soft_box(direction, left, vec2(0.16, 0.8), 0.1)
    color += vec3(1.4, 1.5, 1.6) * soft_box(direction, right, vec2(0.1, 0.7), 0.1)
    # A broad and pale panel behind the camera, for faces that look at it.
    front = towards(azimuth - 0.3, 0.45)
    color += vec3(0.75, 0.74, 0.72) * soft_box(direction, front, vec2(0.9, 0.4), 0.5)
    # A long panel overhead.
    above = towards(azimuth, 1.35)
    return color + vec3(1.5) * soft_box(direction, above, vec2(0.8, 0.3), 0.3)


@func
def cell_chance(cell: vec3, salt: float) -> float:
    """Return a number from 0 to 1 for a cell; without integers, which GLSL ES 1.00 lacks.

    Args:
        cell: Whole numbers.
        salt: Another salt gives another number.

    Source: David Hoskins, "Hash without Sine" (2014).
    """
    p = fract((cell + 17.0 * salt) * 0.1031)
    q = p + dot(p, p.zyx + 31.32)
    return fract((q.x + q.y) * q.z)


@func
def stars(direction: vec3) -> float:
    """Return the brightness of the stars in a direction: points with smooth edges.

    Args:
        direction: Unit direction.
    """
    scaled = direction * STAR_CELLS
    cell = floor(scaled + 0.5)
    offset = vec3(cell_chance(cell, 1.0), cell_chance(cell, 2.0), cell_chance(cell, 3.0))
    star = cell + 0.5 * (offset - 0.5)
    size = 0.04 + 0.12 * cell_chance(cell, 4.0) ** 4
    away = length(scaled - normalize(star) * STAR_CELLS)
    # A cell that the sphere only grazes would show a part of its star.
    whole = select(abs(length(star) - STAR_CELLS) < 0.3, 1.0, 0.0)
    shown = select(cell_chance(cell, 0.0) > 0.9, whole, 0.0)
    return shown * (1.0 - smoothstep(0.3 * size, size, away))


@func
def open_air(
    direction: vec3,
    azimuth: float,
    light_azimuth: float,
    light_elevation: float,
    light_angle: float,
    zenith: vec3,
    horizon: vec3,
    glow: vec3,
    disc: vec3,
    band: float,
    starlight: float,
) -> vec3:
    """A clear sky: a pale band along the horizon, a glow around the sun, and its disc.

    Below the horizon it has the horizon's color, in which the fog of the look ends.

    Args:
        direction: Unit direction.
        azimuth: The camera's azimuth, in radians.
        light_azimuth: Azimuth of the sun, to the right of the camera's.
        light_elevation: Its elevation.
        light_angle: Its angular size.
        zenith: Color overhead.
        horizon: Color along the horizon.
        glow: Color of the light that the air scatters around the sun.
        disc: Color of the sun's disc.
        band: Sine of the elevation at which the horizon's color has faded to 1/e.
        starlight: Brightness of the stars.
    """
    sun = towards(azimuth + light_azimuth, light_elevation)
    height = max(direction.y, 0.0)
    along = max(dot(direction, sun), 0.0)
    low = exp(-height / band)
    side = 0.5 + 0.5 * dot(direction, sun)
    color = mix(zenith, horizon, low)
    near_horizon = low * (0.55 * side**3 + 0.5 * along**8)
    color += glow * (near_horizon + 0.3 * along**48 + 0.6 * along**600)
    rim = cos(0.5 * light_angle)
    color += disc * smoothstep(rim - 0.15 * (1.0 - rim), rim + 0.15 * (1.0 - rim), along)
    if starlight > 0.0 and direction.y > 0.0:
        color += vec3(starlight * stars(direction) * (1.0 - low))
    return color


@func
def paper(direction: vec3, horizon: vec3) -> vec3:
    """One color in every direction.

    Args:
        direction: Unit direction.
        horizon: The color.
    """
    return horizon


@func
def nearest_line(p: vec3, n: vec3, spacing: float) -> float:
    """Return the distance along a surface to the nearest line of equal x, y or z.

    A face that lies in such a plane has no line of it.

    Args:
        p: Point.
        n: Unit normal.
        spacing: Distance from line to line.
    """
    level = abs(p - spacing * round(p / spacing))
    slant = vec3(length(n.yz), length(n.xz), length(n.xy))
    aside = level / max(slant, vec3(0.05))
    aside += select(abs(n) > 0.98, vec3(1e6), vec3(0.0))
    return min(aside.x, min(aside.y, aside.z))


@func
def ruled(p: vec3, n: vec3, spacing: float, width: float, paper: vec3, ink: vec3) -> vec3:
    """Lines of equal x, y and z on whatever face they cross; every fifth line is bold.

    Args:
        p: Point.
        n: Unit normal.
        spacing: Distance from line to line.
        width: Width of a line.
        paper: Color between the lines.
        ink: Color of the lines.
    """
    thin = nearest_line(p, n, spacing)
    bold = nearest_line(p, n, 5.0 * spacing)
    faint = 0.38 * (1.0 - smoothstep(0.35 * width, 0.9 * width, thin))
    strong = 1.0 - smoothstep(0.5 * width, 1.2 * width, bold)
    return mix(paper, ink, clamp(max(faint, strong), 0.0, 1.0))
