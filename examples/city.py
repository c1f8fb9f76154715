"""A city of 3,721 towers at dusk, every one repeated from one: height, steps and windows differ.

The index of a repetition distinguishes the copies: ``cell`` in a field and in a pattern. Try: the
share of windows that are lit.
"""

from distal import (
    Background,
    Camera,
    DistantLight,
    HemisphereLight,
    Plane,
    Scene,
    Shape,
    Surface,
    pattern,
)
from distal.fields.noise import fraction, lattice_hash
from distal.lang import (
    abs,
    clamp,
    dot,
    exp,
    floor,
    fract,
    func,
    ivec3,
    length,
    max,
    min,
    mix,
    normalize,
    round,
    slider,
    smoothstep,
    step,
    vec2,
    vec3,
)

lit = slider("Lit windows", 0.3, low=0.0, high=1.0)

LOTS = 61  # along each side of the city
MIDDLE = 30.0  # the middle lot's index
TALLEST = 7.2  # with its mast
WARM = vec3(1.0, 0.62, 0.28)
COLD = vec3(0.75, 0.85, 1.0)
SUN = vec3(-0.55, 0.1, -0.8)


@func
def chance(cell: vec3, which: int) -> float:
    """A random number from 0 to 1 for a tower, a different one for each ``which``."""
    return fraction(lattice_hash(ivec3(round(cell)), which))


@func
def middle_of(cell: vec3) -> vec2:
    """Where a lot lies on the ground; cells are counted from a corner of the city."""
    return cell.xz - MIDDLE


@func
def height_of(cell: vec3) -> float:
    """Low at the edge of the city, high in the middle, a few high anywhere."""
    luck = chance(cell, 1)
    lot = middle_of(cell)
    middle = exp(-dot(lot, lot) / 50.0)
    hill = exp(-dot(lot + vec2(13.0, -2.0), lot + vec2(13.0, -2.0)) / 16.0)
    return 0.3 + (0.8 + 4.2 * middle + 2.2 * hill) * luck * luck + luck**8.0


@func
def block(p: vec3, half: vec2, height: float) -> float:
    """A box on the ground."""
    q = abs(p - vec3(0.0, 0.5 * height, 0.0)) - vec3(half.x, 0.5 * height, half.y)
    return length(max(q, vec3(0.0))) + min(max(max(q.x, q.y), q.z), 0.0)


@func
def tower(p: vec3, cell: vec3) -> float:
    """Three boxes, each narrower and taller than the one around it, and a mast on the highest."""
    height = height_of(cell)
    half = 0.2 + 0.16 * vec2(chance(cell, 2), chance(cell, 3))
    steps = 0.6 + 0.4 * chance(cell, 4)
    d = block(p, half, height * steps)
    d = min(d, block(p, 0.75 * half, height * mix(steps, 1.0, 0.6)))
    d = min(d, block(p, 0.5 * half, height))
    mast = 0.7 if height > 2.6 else 0.0
    return min(d, block(p, vec2(0.015), height + mast)) if mast > 0.0 else d


@func
def facade(p: vec3, n: vec3, cell: vec3, lit: float) -> Surface:
    """Storeys of windows; some are lit, in one of two colors."""
    along = p.x if abs(n.z) > abs(n.x) else p.z
    place = vec2(along * 12.0 + 0.5, p.y * 9.0)
    room = vec3(floor(place), 7.0 * cell.x + 31.0 * cell.z + 3.0 * floor(n.x + 2.0 * n.z + 0.5))
    inside = abs(fract(place) - 0.5)
    wall = step(abs(n.y), 0.5)
    pane = wall * step(inside.x, 0.3) * step(inside.y, 0.28)
    on = step(chance(room, 7), lit)
    # Windows smaller than a pixel show their mean color.
    near = 1.0 - smoothstep(13.0, 30.0, length(middle_of(cell) - vec2(6.6, 13.5)))
    pane = mix(0.33 * wall, pane, near)
    on = mix(lit, on, near)
    glow = mix(WARM, COLD, step(0.75, chance(room, 8)) * near)
    tint = mix(vec3(0.36, 0.31, 0.29), vec3(0.2, 0.26, 0.36), chance(cell, 6))
    bright = mix(1.1, 0.5 + 1.3 * chance(room, 9), near)
    return Surface(color=tint * (1.0 - 0.6 * pane), emission=glow * (pane * on * bright))


@func
def streets(p: vec3) -> Surface:
    """Asphalt; lamps along every street, wide avenues, and the dark sea around."""
    lot = abs(fract(p.xz) - 0.5)
    middle = 0.5 - max(lot.x, lot.y)
    city = step(max(abs(p.x), abs(p.z)), 30.5)
    lamps = exp(-middle * middle * 300.0) * (0.35 + 0.65 * step(0.8, fract(4.0 * (p.x + p.z))))
    avenue = step(abs(p.x - 3.5), 0.12) + step(abs(p.z + 6.5), 0.12)
    glow = WARM * (city * (0.5 * lamps + 0.9 * clamp(avenue, 0.0, 1.0)))
    land = Surface(color=vec3(0.06, 0.06, 0.07), emission=glow)
    sea = Surface(color=vec3(0.05, 0.08, 0.12), diffuse=0.4, specular=0.6, roughness=0.25)
    return land if city > 0.5 else sea


@func
def dusk(direction: vec3) -> vec3:
    """Orange where the sun has just set, blue above."""
    height = clamp(direction.y, 0.0, 1.0)
    towards = clamp(dot(direction, normalize(SUN)), 0.0, 1.0)
    low = mix(vec3(0.32, 0.2, 0.28), vec3(1.0, 0.38, 0.13), towards**4.0)
    return mix(low, vec3(0.05, 0.09, 0.22), 1.0 - exp(-4.0 * height)) + 0.7 * WARM * towards**90.0


towers = Shape.from_function(tower, slope=1.0, bounds=((-0.36, 0.0, -0.36), (0.36, TALLEST, 0.36)))
city = towers.paint(pattern(facade, lit=lit)).repeat(1.0, 0.0, 1.0, count=(LOTS, 1, LOTS))
ground = Plane().paint(pattern(streets))

scene = Scene(
    city | ground,
    lights=[
        DistantLight(tuple(SUN), intensity=0.5, color="#ff9a5a", angle=0.2),
        HemisphereLight(sky=(0.24, 0.3, 0.5), ground=(0.3, 0.18, 0.1), intensity=0.7),
    ],
    camera=Camera((6.6, 4.4, 13.5), target=(-1.6, 1.1, 0.0), fov_deg=38.0),
    background=Background(dusk),
    fog=(0.5, 0.25, 0.17),
    fog_density=0.013,
    ambient_occlusion=0.5,
    steps=500,
    far=400.0,
    exposure=1.0,
    tone_map="aces",
)
