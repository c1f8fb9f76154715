"""Materials by name: metals, stones, liquids, gems, things of every day.

Input: for each a row of numbers (color, roughness, index of refraction) and, for wood, marble and
granite, the point in the coordinates of the painted shape. Output: a ``Surface``. Does not depend
on lights or shapes.

Sources of the numbers. *PB*: "Physically Based", Anton Palmqvist (https://physicallybased.info,
CC0), whose metals are computed from measured n and k (refractiveindex.info: gold and silver after
Babar and Weaver, copper and nickel after Johnson and Christy, aluminum after Cheng, chromium after
Sytchkova, titanium after Palm, platinum and zinc after Werner) and converted to linear sRGB. Gold's
red would be 1.059, out of sRGB's gamut: all three are divided by it, which keeps the hue. Most of
its other colors are measured with a spectrophotometer. *By eye*: no measurement is known to us; the
color was chosen by comparison with photographs.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from distal.fields.constants import PI
from distal.fields.guarantees import named
from distal.fields.noise.space import fbm, gradient_noise
from distal.lang import (
    abs,
    clamp,
    exp,
    floor,
    func,
    length,
    log,
    max,
    min,
    mix,
    sin,
    smoothstep,
    vec2,
    vec3,
)
from distal.render.declarations import material
from distal.render.material import Surface, glass, metal, plastic

Triple = tuple[float, float, float]

PB: Final = '"Physically Based" (https://physicallybased.info)'
EYE: Final = "chosen by eye"


@dataclass(frozen=True, slots=True)
class Row:
    """A material: its color, its roughness, its index of refraction, and where they are from."""

    summary: str
    color: Triple
    roughness: float
    source: str = PB
    ior: float = 1.5


# Color: reflectance at normal incidence.
METALS: Final[Mapping[str, Row]] = {
    "gold": Row("Pure gold", (1.0, 0.73, 0.29), 0.15),
    "silver": Row("Pure silver", (0.991, 0.985, 0.974), 0.1),
    "copper": Row("Pure copper", (0.932, 0.623, 0.522), 0.2),
    "brass": Row("Brass, an alloy of copper and zinc", (0.91, 0.778, 0.423), 0.2),
    "bronze": Row("Bronze, an alloy of copper and tin", (0.71, 0.47, 0.3), 0.3, EYE),
    "aluminum": Row("Pure aluminum", (0.916, 0.923, 0.924), 0.3),
    "iron": Row("Pure iron, without rust", (0.53, 0.513, 0.494), 0.4),
    "steel": Row("Stainless steel", (0.669, 0.639, 0.598), 0.25),
    "chrome": Row("Polished chromium", (0.654, 0.685, 0.701), 0.0),
    "nickel": Row("Pure nickel", (0.697, 0.641, 0.563), 0.2),
    "titanium": Row("Pure titanium", (0.441, 0.4, 0.361), 0.35),
    "platinum": Row("Pure platinum", (0.765, 0.73, 0.676), 0.15),
    "zinc": Row("Pure zinc", (0.808, 0.844, 0.865), 0.4),
}
# Color: fraction of the light that is scattered below the surface.
COATED: Final[Mapping[str, Row]] = {
    "porcelain": Row("Glazed porcelain", (0.745, 0.745, 0.723), 0.05),
    "rubber": Row("Black rubber, as of a tire", (0.023, 0.023, 0.023), 0.7),
    "paper": Row("White office paper", (0.794, 0.834, 0.884), 0.8),
    "concrete": Row("Fresh concrete", (0.51, 0.51, 0.51), 0.8),
    "brick": Row("Red brick", (0.262, 0.095, 0.061), 0.9),
    "terracotta": Row("Fired clay, as of a flower pot", (0.555, 0.212, 0.11), 0.8),
    "clay": Row("Grey modelling clay", (0.28, 0.255, 0.225), 0.7, EYE),
    "plaster": Row("White plaster", (0.8, 0.79, 0.76), 0.9, EYE),
    "snow": Row("Fresh snow", (0.85, 0.85, 0.85), 0.7, PB, 1.31),
    "sand": Row("Dry sand", (0.44, 0.386, 0.231), 0.9),
    "bone": Row("Bleached bone", (0.793, 0.793, 0.664), 0.7),
    "charcoal": Row("Charcoal", (0.02, 0.02, 0.02), 0.9),
    "chocolate": Row("Milk chocolate", (0.162, 0.091, 0.06), 0.4),
    "leather": Row("Brown leather", (0.13, 0.052, 0.022), 0.5, EYE),
    "wax": Row("Beeswax", (0.72, 0.52, 0.2), 0.4, EYE, 1.44),
    "jade": Row("Polished jade (nephrite)", (0.13, 0.34, 0.17), 0.1, EYE, 1.61),
    "car_paint": Row("Red paint of a car under a clear coat", (0.42, 0.008, 0.012), 0.03, EYE),
}
# Color: what is left of white light after ``depth``.
CLEAR: Final[Mapping[str, Row]] = {
    "diamond": Row("Diamond", (1.0, 1.0, 1.0), 0.0, PB, 2.417),
    "sapphire": Row("Blue sapphire (corundum)", (0.06, 0.14, 0.72), 0.0, f"index: {PB}", 1.768),
    "ruby": Row("Ruby (corundum)", (0.75, 0.02, 0.06), 0.0, f"index: {PB}", 1.768),
    "emerald": Row("Emerald (beryl)", (0.03, 0.62, 0.2), 0.0, EYE, 1.578),
    "amber": Row("Amber", (0.83, 0.288, 0.036), 0.0),
    "honey": Row("Liquid honey", (0.831, 0.571, 0.037), 0.0, PB, 1.504),
}
# From light to dark: the measured skin types I to VI.
SKIN: Final = [
    vec3(0.847, 0.638, 0.552),
    vec3(0.799, 0.485, 0.347),
    vec3(0.623, 0.433, 0.343),
    vec3(0.436, 0.227, 0.131),
    vec3(0.283, 0.148, 0.079),
    vec3(0.09, 0.05, 0.02),
]


def _documented(row: Row, what: str, lines: str) -> str:
    return f"{row.summary}: {what}\n\nArgs:\n{lines}\nSource: {row.source}.\n"


def _declare_metal(name: str, row: Row) -> None:
    color = vec3(*row.color)

    def surface_of(roughness: float = row.roughness) -> Surface:
        return metal(color, roughness)

    lines = "    roughness: 0 mirrors sharply, 1 hardly mirrors.\n"
    surface_of.__doc__ = _documented(row, "a metal.", lines)
    globals()[name] = material(name, reflects=True)(named(name, surface_of))


def _declare_coated(name: str, row: Row) -> None:
    def surface_of(
        color: vec3 = vec3(*row.color), roughness: float = row.roughness, ior: float = row.ior
    ) -> Surface:
        return plastic(color, roughness, ior)

    lines = (
        "    color: Fraction of the light that it scatters.\n"
        "    roughness: 0 mirrors sharply, 1 hardly mirrors.\n"
        "    ior: Index of refraction of its surface.\n"
    )
    surface_of.__doc__ = _documented(row, "it scatters light below a reflecting surface.", lines)
    globals()[name] = material(name, reflects=True)(named(name, surface_of))


def _declare_clear(name: str, row: Row) -> None:
    def surface_of(
        color: vec3 = vec3(*row.color), depth: float = 1.0, ior: float = row.ior
    ) -> Surface:
        return glass(ior, -log(max(color, 1e-4)) / depth)

    lines = (
        "    color: Color of white light after it passed through ``depth``.\n"
        "    depth: Thickness with this color, in scene units: about the size of the shape.\n"
        "    ior: Index of refraction.\n"
    )
    surface_of.__doc__ = _documented(row, "transparent, it refracts light.", lines)
    globals()[name] = material(name, reflects=True, refracts=True)(named(name, surface_of))


for _name, _row in METALS.items():
    _declare_metal(_name, _row)
for _name, _row in COATED.items():
    _declare_coated(_name, _row)
for _name, _row in CLEAR.items():
    _declare_clear(_name, _row)


# Absorption coefficients per meter, in linear sRGB.
IN_WATER: Final = vec3(0.297, 0.045, 0.017)
IN_ICE: Final = vec3(0.2075, 0.0416, 0.0)


@material("water", reflects=True, refracts=True)
@func
def water(meter: float = 1.0) -> Surface:
    """Clear water: it refracts light, and is blue where it is metres deep.

    Args:
        meter: Length of a meter in scene units: 100 if a unit is a centimeter.

    Source: refraction: Daimon and Masumura (2007); absorption: Physically Based
        (https://physicallybased.info).
    """
    return glass(1.3325, IN_WATER / meter)


@material("ice", reflects=True, refracts=True)
@func
def ice(meter: float = 1.0) -> Surface:
    """Clear ice: it refracts light, and is blue where it is metres deep.

    Args:
        meter: Length of a meter in scene units: 100 if a unit is a centimeter.

    Source: refraction and absorption: Warren and Brandt (2008), by Physically Based
        (https://physicallybased.info).
    """
    return glass(1.3098, IN_ICE / meter)


@material("skin", reflects=True)
@func
def skin(tone: float = 0.2, roughness: float = 0.5) -> Surface:
    """Human skin, without the light that passes under it.

    Args:
        tone: From 0, the lightest, to 1, the darkest of six measured types (Fitzpatrick I to VI).
        roughness: Roughness of the surface.

    Source: Physically Based (https://physicallybased.info), skin I to VI.
    """
    place = 5.0 * clamp(tone, 0.0, 1.0)
    below = min(int(floor(place)), 4)
    return plastic(mix(SKIN[below], SKIN[below + 1], place - float(below)), roughness, 1.4)


# Oak, by eye. The heart of the trunk lies beside the shape, so that a board's faces show lines and
# its ends arcs; in rings from the origin.
LIGHT_WOOD: Final = vec3(0.53, 0.3, 0.135)
DARK_WOOD: Final = vec3(0.2, 0.085, 0.03)
HEART: Final = vec2(-9.0, -5.0)


@material("wood", reflects=True)
@func
def wood(
    p: vec3,
    size: float = 0.09,
    color: vec3 = LIGHT_WOOD,
    dark_color: vec3 = DARK_WOOD,
    roughness: float = 0.35,
) -> Surface:
    """Varnished wood: growth rings around the trunk, which stands along the y axis, and pores.

    Args:
        p: Point.
        size: Thickness of a growth ring, in scene units.
        color: Color of the wood that grows in spring.
        dark_color: Color of the wood that grows in late summer, and of pores.
        roughness: Roughness of the varnish.

    Source: rings by the distance from an axis: Darwyn Peachey, "Solid Texturing of Complex
        Surfaces" (1985); colors by eye, after oak.
    """
    q = p / size
    # The trunk is neither round nor straight, and its rings are not equally thick.
    bent = 2.2 * gradient_noise(vec3(0.09, 0.022, 0.09) * q, 0)
    bent += 0.35 * gradient_noise(vec3(0.4, 0.06, 0.4) * q, 1)
    r = length(q.xz - HEART) + bent
    ring = r - floor(r)
    year = 0.75 + 0.5 * gradient_noise(vec3(0.71 * floor(r), 0.5, 0.5), 2)
    late = smoothstep(0.15, 0.9, ring) * (1.0 - smoothstep(0.93, 1.0, ring))
    fibre = fbm(vec3(3.0, 0.12, 3.0) * q, 3)
    pore = smoothstep(0.22, 0.5, gradient_noise(vec3(7.0, 0.35, 7.0) * q, 3)) * (1.0 - 0.6 * ring)
    cloud = gradient_noise(vec3(0.15, 0.05, 0.15) * q, 4)
    dark = clamp(0.62 * year * late + 0.3 * fibre + 0.45 * pore + 0.2 * cloud, 0.0, 1.0)
    return plastic(mix(color, dark_color, dark), roughness, 1.5)


WHITE_MARBLE: Final = vec3(0.83, 0.791, 0.753)
VEINS: Final = vec3(0.16, 0.165, 0.175)


@material("marble", reflects=True)
@func
def marble(
    p: vec3,
    size: float = 1.0,
    color: vec3 = WHITE_MARBLE,
    vein_color: vec3 = VEINS,
    roughness: float = 0.08,
) -> Surface:
    """Polished marble: white, with grey veins of several widths.

    Args:
        p: Point.
        size: Distance between large veins, in scene units.
        color: Color of the stone.
        vein_color: Color of the veins.
        roughness: Roughness of the polished surface.

    Source: layers displaced by noise: Ken Perlin, "An Image Synthesizer" (1985); the stone's
        color: Physically Based (https://physicallybased.info).
    """
    q = p / size
    moved = vec3(fbm(q, 4), fbm(q + vec3(5.2, 1.3, 8.1), 4), fbm(q + vec3(2.7, 9.4, 3.6), 4))
    # Displaced layers make long veins; zeros of noise alone would be closed loops.
    layers = q.x + 0.55 * q.y - 0.35 * q.z + 0.9 * moved.x + 0.45 * moved.y
    large = abs(sin(PI * layers))
    small = abs(sin(PI * (1.9 * q.y - 1.3 * q.x + 1.1 * q.z + 1.5 * moved.z)))
    # Veins are strong in some parts and fade in others.
    share = smoothstep(-0.25, 0.35, gradient_noise(0.8 * q + 0.5 * moved, 0))
    vein = share * (0.7 * exp(-30.0 * large) + 0.3 * exp(-5.0 * large))
    vein += 0.3 * (1.0 - 0.6 * share) * exp(-40.0 * small)
    shade = 0.12 * (0.5 + moved.x)
    return plastic(mix(color, vein_color, clamp(vein + shade, 0.0, 0.95)), roughness, 1.5)


FELDSPAR: Final = vec3(0.5, 0.36, 0.3)
QUARTZ: Final = vec3(0.46, 0.46, 0.45)
MICA: Final = vec3(0.022, 0.022, 0.024)


@material("granite", reflects=True)
@func
def granite(
    p: vec3, size: float = 0.12, color: vec3 = FELDSPAR, roughness: float = 0.12
) -> Surface:
    """Polished granite: grains of feldspar, quartz and black mica.

    Args:
        p: Point.
        size: Size of the grains, in scene units.
        color: Color of the feldspar, which is most of the stone.
        roughness: Roughness of the polished surface.

    Source: grains by the sign of noise; colors by eye.
    """
    q = p / size
    grain = gradient_noise(1.1 * q, 0) + 0.35 * gradient_noise(4.0 * q, 1)
    clear = gradient_noise(1.7 * q + 11.3, 2) + 0.3 * gradient_noise(5.0 * q, 3)
    black = gradient_noise(2.3 * q + 4.7, 4) + 0.3 * gradient_noise(7.0 * q, 5)
    tint = color * (1.0 + 0.35 * gradient_noise(3.0 * q, 6))
    stone = mix(tint, QUARTZ, smoothstep(0.02, 0.1, grain))
    stone = mix(stone, vec3(0.72, 0.7, 0.67), smoothstep(0.2, 0.26, clear))
    return plastic(mix(stone, MICA, smoothstep(0.2, 0.25, black)), roughness, 1.54)
