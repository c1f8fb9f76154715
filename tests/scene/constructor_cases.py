"""What lights, cameras, materials, patterns and backgrounds give, as formulas in NumPy.

A case makes an object by asymmetric arguments and states what it gives at places; the test that
uses them is ``test_constructors``.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

import distal
from distal.lang import func, vec3
from distal.render import patterns as pattern_functions
from distal.render.material import Surface
from distal.render.named_materials import CLEAR as CLEAR_ROWS
from distal.render.named_materials import COATED, METALS
from distal.scene.objects.cameras import TurnedCamera

Formula = Callable[..., dict[str, Any]]
RNG = np.random.default_rng(11)
PLACES = RNG.uniform(-1.5, 1.5, (40, 3))
DIRECTIONS = PLACES / np.linalg.norm(PLACES, axis=1, keepdims=True)
SCREEN = RNG.uniform(-1.0, 1.0, (40, 2))


def arr(value: Any) -> Any:
    return np.asarray(value, float)


def unit(value: Any) -> Any:
    v = arr(value)
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def everywhere(value: Any) -> Any:
    return np.broadcast_to(arr(value), (len(PLACES), 3))


@dataclass(frozen=True)
class Case:
    """An object and what it gives.

    Attributes:
        name: What makes it, as ``distal`` calls it.
        arguments: By name, in the order of the parameters.
        formula: ``(**arguments)`` -> by what is asked ("radiance"), its values at the places.
        emits: Which of its attributes emits; "" itself.
        site: What is asked, "p", "n", "uv" or "direction", and where.
        changed: Other values; a number is else half as much again.
        fixed: Arguments that another case changes.
    """

    name: str
    arguments: dict[str, Any]
    formula: Formula
    emits: str = ""
    site: str = "p"
    changed: dict[str, list[Any]] = field(default_factory=dict)
    fixed: tuple[str, ...] = ()


COSINES = np.linspace(0.01, 1.0, len(PLACES))
SITES = {"facing": COSINES, "p": PLACES, "n": DIRECTIONS, "uv": SCREEN, "direction": DIRECTIONS}


# Lights


def shining(position: Any, intensity: float, color: Any, radius: float) -> dict[str, Any]:
    way = arr(position) - PLACES
    distance = np.linalg.norm(way, axis=1)
    return {
        "direction": way / distance[:, None],
        "distance": distance,
        "radiance": intensity * arr(color) / distance[:, None] ** 2,
        "radius": radius / distance,
    }


def spot(
    position: Any, target: Any, intensity: Any, color: Any, angle: Any, softness: Any, radius: Any
) -> dict[str, Any]:
    found = shining(position, intensity, color, radius)
    cosine = found["direction"] @ unit(arr(position) - arr(target))
    rim, full = math.cos(0.5 * angle), math.cos(0.5 * angle * (1.0 - softness))
    s = np.clip((cosine - rim) / (full - rim), 0.0, 1.0)
    return {**found, "radiance": found["radiance"] * (s * s * (3.0 - 2.0 * s))[:, None]}


def half_and_half(sky: Any, ground: Any, intensity: float, up: Any) -> dict[str, Any]:
    share = (0.5 + 0.5 * DIRECTIONS @ unit(up))[:, None]
    return {"": intensity * (share * arr(sky) + (1.0 - share) * arr(ground))}


COLOR = (0.2, 0.5, 0.9)
OTHER = (0.7, 0.3, 0.1)
LIGHTS = [
    Case(
        "AmbientLight",
        {"intensity": 0.3, "color": COLOR},
        lambda intensity, color: {"": everywhere(intensity * arr(color))},
        "ambient",
        "n",
    ),
    Case(
        "HemisphereLight",
        {"sky": COLOR, "ground": OTHER, "intensity": 0.7, "up": (0.3, 1.0, -0.4)},
        half_and_half,
        "ambient",
        "n",
    ),
    Case(
        "DistantLight",
        {"direction": (0.3, 1.0, -0.4), "intensity": 0.7, "color": COLOR, "angle": 0.2},
        lambda direction, intensity, color, angle: {
            "direction": everywhere(unit(direction)),
            "radiance": everywhere(intensity * arr(color)),
            "radius": np.full(len(PLACES), math.tan(0.5 * angle)),
        },
        "sample",
    ),
    Case(
        "PointLight",
        {"position": (0.3, 2.0, -0.4), "intensity": 0.7, "color": COLOR, "radius": 0.2},
        shining,
        "sample",
    ),
    Case(
        "SpotLight",
        {"position": (0.3, 2.0, -0.4), "target": (0.4, -0.3, 0.2), "intensity": 0.7}
        | {"color": COLOR, "angle": 1.1, "softness": 0.4, "radius": 0.2},
        spot,
        "sample",
    ),
]

# Cameras: uv is -1 to 1 from the bottom to the top


def basis(ahead: Any, up: Any) -> tuple[Any, Any, Any]:
    z = unit(ahead)
    x = unit(np.cross(z, arr(up)))
    return x, np.cross(x, z), z


def swapped(mirrored: bool) -> tuple[Any, Any]:
    u, v = SCREEN.T
    return (-u if mirrored else u)[:, None], v[:, None]


def rays(origin: Any, direction: Any) -> dict[str, Any]:
    return {"origin": np.broadcast_to(arr(origin), (40, 3)), "direction": unit(direction)}


def perspective(
    position: Any,
    target: Any,
    up: Any,
    fov: float = 0.0,
    fov_deg: float = 0.0,
    mirrored: bool = False,
) -> dict[str, Any]:
    x, y, z = basis(arr(target) - arr(position), up)
    u, v = swapped(mirrored)
    return rays(position, u * x + v * y + z / math.tan(0.5 * (fov or math.radians(fov_deg))))


def turned(
    position: Any,
    yaw: float,
    pitch: float,
    roll: float,
    screen_height: float = 1.0,
    screen_distance: float = 0.0,
    fov: float = 0.0,
    fov_deg: float = 0.0,
    mirrored: bool = False,
) -> dict[str, Any]:
    """Rolled about the view, pitched about x, turned about y, one after the other."""
    opening = fov or math.radians(fov_deg)
    distance = screen_distance or 0.5 * screen_height / math.tan(0.5 * opening)
    u, v = swapped(mirrored)
    half = 0.5 * screen_height
    way = np.concatenate([half * u, half * v, np.full_like(u, -distance)], axis=1)
    for angle, row in ((roll, (0, 0, 1)), (pitch, (1, 0, 0)), (yaw, (0, 1, 0))):
        way = way @ about(row, angle).T
    return rays(position, way)


def about(axis: Any, angle: float) -> Any:
    x, y, z = axis
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]], float)
    return np.eye(3) + math.sin(angle) * k + (1.0 - math.cos(angle)) * k @ k


def orbiting(
    distance: float,
    azimuth: float,
    elevation: float,
    target: Any,
    fov: float = 0.0,
    fov_deg: float = 0.0,
    mirrored: bool = False,
) -> dict[str, Any]:
    level = math.cos(elevation)
    there = (level * math.sin(azimuth), math.sin(elevation), level * math.cos(azimuth))
    position = arr(target) + distance * arr(there)
    return perspective(position, target, (0, 1, 0), fov, fov_deg, mirrored)


def parallel(position: Any, target: Any, up: Any, height: float, mirrored: bool) -> dict[str, Any]:
    x, y, z = basis(arr(target) - arr(position), up)
    u, v = swapped(mirrored)
    origin = arr(position) + 0.5 * height * (u * x + v * y)
    return {"origin": origin, "direction": np.broadcast_to(z, (40, 3))}


def equidistant(
    position: Any,
    target: Any,
    up: Any,
    fov: float = 0.0,
    fov_deg: float = 0.0,
    mirrored: bool = False,
) -> dict[str, Any]:
    x, y, z = basis(arr(target) - arr(position), up)
    u, v = swapped(mirrored)
    radius = np.hypot(u, v)
    angle = 0.5 * (fov or math.radians(fov_deg)) * radius
    return rays(position, np.cos(angle) * z + np.sin(angle) * (u * x + v * y) / radius)


def all_around(position: Any, target: Any, up: Any, mirrored: bool) -> dict[str, Any]:
    x, y, z = basis(arr(target) - arr(position), up)
    u, v = (0.5 * math.pi * c for c in swapped(mirrored))
    return rays(position, np.cos(v) * (np.sin(u) * x + np.cos(u) * z) + np.sin(v) * y)


LOOK = {"position": (0.3, 2.0, -0.4), "target": (0.4, -0.3, 1.2), "up": (0.2, 1.0, 0.4)}
TURN = {"position": (0.3, 2.0, -0.4), "yaw": 0.4, "pitch": -0.3, "roll": 0.7}
ORBIT = {"distance": 3.0, "azimuth": 0.7, "elevation": 0.4, "target": (0.4, -0.3, 1.2)}
CAMERAS = [
    *(
        Case(
            "Camera",
            LOOK | {k: v, "mirrored": True},
            perspective,
            site="uv",
            changed={"mirrored": [False]},
        )
        for k, v in (("fov", 0.9), ("fov_deg", 50.0))
    ),
    *(
        # An angle tells how far away a screen of any height is.
        Case("TurnedCamera", TURN | more | {"mirrored": True}, turned, site="uv", fixed=fixed)
        for more, fixed in (
            ({"screen_height": 1.4, "screen_distance": 0.8}, ()),
            ({"screen_height": 1.4, "fov": 0.9}, ("screen_height",)),
            ({"fov_deg": 50.0}, ()),
        )
    ),
    *(
        Case("OrbitCamera", ORBIT | {k: v, "mirrored": True}, orbiting, site="uv")
        for k, v in (("fov", 0.9), ("fov_deg", 50.0))
    ),
    Case("OrthographicCamera", LOOK | {"height": 3.0, "mirrored": True}, parallel, site="uv"),
    *(
        Case("FisheyeCamera", LOOK | {k: v, "mirrored": True}, equidistant, site="uv")
        for k, v in (("fov", 1.9), ("fov_deg", 100.0))
    ),
    Case("PanoramaCamera", {**LOOK, "mirrored": True}, all_around, site="uv"),
]

# Materials

PLAIN: dict[str, Any] = {
    **{"color": (1.0, 1.0, 1.0), "diffuse": 1.0, "specular": 0.0, "transmission": 0.0},
    **{"ior": 1.5, "roughness": 0.0, "metal": 0.0, "emission": (0.0,) * 3},
    **{"absorption": (0.0,) * 3, "fresnel": 0.0, "dispersion": 0.0},
    **{"height": 0.0, "tilt": (0.0,) * 3, "bsdf_share": 0.0, "bsdf": 0},
}


def surface(**given: Any) -> dict[str, Any]:
    """A surface that is plain but for what is said."""
    assert set(PLAIN) == set(Surface.__annotations__)
    values = {n: float(v) if isinstance(v, bool) else v for n, v in (PLAIN | given).items()}
    return {
        name: everywhere(v) if np.ndim(v) else np.full(len(PLACES), v) for name, v in values.items()
    }


ALL_NUMBERS = {"color": COLOR, "diffuse": 0.2, "specular": 0.15, "transmission": 0.3, "ior": 1.3}
ALL_NUMBERS |= {"roughness": 0.4, "metal": 0.35, "emission": (1.2, 0.3, 2.0)}
ALL_NUMBERS |= {"absorption": (0.1, 0.8, 0.5), "fresnel": True, "dispersion": 0.3}
CLEAR = {"diffuse": 0.0, "transmission": 1.0, "fresnel": 1.0}
MATERIALS = [
    Case("Material", ALL_NUMBERS, surface),
    Case("matte", {"color": COLOR}, surface),
    Case("glossy", {"color": COLOR, "diffuse": 0.2, "specular": 0.3, "roughness": 0.4}, surface),
    Case(
        "metal",
        {"color": COLOR, "roughness": 0.4},
        lambda **k: surface(diffuse=0.0, specular=1.0, metal=1.0, fresnel=1.0, **k),
    ),
    Case(
        "mirror", {"color": COLOR}, lambda **k: surface(diffuse=0.0, specular=1.0, metal=1.0, **k)
    ),
    Case(
        "glass",
        {"ior": 1.3, "color": COLOR, "dispersion": 0.4},
        lambda ior, color, dispersion: surface(
            ior=ior, absorption=-np.log(arr(color)), dispersion=dispersion, **CLEAR
        ),
    ),
    Case("glass", {"ior": 1.3, "absorption": OTHER}, lambda **k: surface(**CLEAR, **k)),
    Case(
        "plastic",
        {"color": COLOR, "roughness": 0.4, "ior": 1.3},
        lambda **k: surface(fresnel=1.0, **k),
    ),
    Case(
        "emissive",
        {"color": COLOR, "strength": 2.5},
        lambda color, strength: surface(
            color=(0.0,) * 3, diffuse=0.0, emission=strength * arr(color)
        ),
    ),
]

METAL = {"diffuse": 0.0, "specular": 1.0, "metal": 1.0, "fresnel": 1.0}


def named_cases() -> list[Case]:
    """The materials by name: their rows' colors, and the formulas of metal, plastic and glass."""

    def metallic(color: Any) -> Formula:
        return lambda **k: surface(color=color, **METAL, **k)

    def clear(color: Any, depth: float, ior: float) -> dict[str, Any]:
        return surface(ior=ior, absorption=-np.log(arr(color)) / depth, **CLEAR)

    def coated(**given: Any) -> dict[str, Any]:
        return surface(fresnel=1.0, **given)

    cases = [Case(n, {"roughness": 0.4}, metallic(row.color)) for n, row in METALS.items()]
    given = {"color": COLOR, "roughness": 0.4, "ior": 1.3}
    cases += [Case(name, given, coated) for name in COATED]
    cases += [Case(name, {"color": COLOR, "depth": 0.7, "ior": 1.3}, clear) for name in CLEAR_ROWS]
    water, ice = (1.3325, arr((0.297, 0.045, 0.017))), (1.3098, arr((0.2075, 0.0416, 0.0)))
    for name, (ior, absorption) in (("water", water), ("ice", ice)):
        formula = partial(in_metres, ior=ior, absorption=absorption)
        cases.append(Case(name, {"meter": 0.2}, formula))

    def of_skin(tone: float, roughness: float) -> dict[str, Any]:
        types = np.array([[0.847, 0.638, 0.552], [0.799, 0.485, 0.347], [0.623, 0.433, 0.343]])
        color = [np.interp(5.0 * tone, np.arange(3), channel) for channel in types.T]
        return surface(color=color, roughness=roughness, ior=1.4, fresnel=1.0)

    return [*cases, Case("skin", {"tone": 0.22, "roughness": 0.4}, of_skin)]


def in_metres(meter: float, ior: float, absorption: Any) -> dict[str, Any]:
    return surface(ior=ior, absorption=absorption / meter, **CLEAR)


# Patterns: a share from one color to the other, or a color


def between(a: Any, b: Any, share: Any) -> dict[str, Any]:
    t = arr(share)[:, None]
    return {"": (1.0 - t) * arr(a) + t * arr(b)}


def layers(size: float, direction: Any) -> Any:
    return PLACES @ unit(direction) / size


def on_way(start: Any, end: Any) -> Any:
    way = arr(end) - arr(start)
    return np.clip((PLACES - arr(start)) @ way / (way @ way), 0.0, 1.0)


@func
def rising(p: vec3, height: float, lean: float) -> float:
    return p.y * height + p.x * lean


@func
def colored(direction: vec3, height: float, lean: float) -> vec3:
    return vec3(direction.y * height, direction.x * lean, 0.5)


def swung(t: Any, base: Any, amplitude: Any, frequency: Any, phase: Any) -> dict[str, Any]:
    share = np.full(40, t) if isinstance(t, float) else PLACES @ [0.2, 0.3, 0.0]
    turn = 2.0 * np.pi * (arr(frequency) * share[:, None] + arr(phase))
    return {"": np.maximum(arr(base) + arr(amplitude) * np.cos(turn), 0.0)}


SIDES = {"a": COLOR, "b": OTHER}
PATTERNS = [
    Case(
        "checker",
        SIDES | {"size": 0.4},
        lambda a, b, size: between(a, b, np.floor(PLACES / size).sum(1) % 2),
    ),
    Case(
        "stripes",
        SIDES | {"size": 0.4, "direction": (0.3, 1.0, -0.4)},
        lambda a, b, size, direction: between(a, b, np.floor(layers(size, direction)) % 2),
    ),
    Case(
        "waves",
        SIDES | {"size": 0.9, "direction": (0.3, 1.0, -0.4)},
        lambda a, b, size, direction: between(
            a, b, 0.5 + 0.5 * np.sin(2.0 * np.pi * layers(size, direction))
        ),
    ),
    Case(
        "linear_gradient",
        SIDES | {"start": (-0.6, 0.3, 0.2), "end": (0.9, -0.5, 0.4)},
        lambda a, b, start, end: between(a, b, on_way(start, end)),
    ),
    Case(
        "radial_gradient",
        SIDES | {"center": (-0.6, 0.3, 0.2), "radius": 1.7},
        lambda a, b, center, radius: between(
            a, b, np.minimum(np.linalg.norm(PLACES - arr(center), axis=1) / radius, 1.0)
        ),
    ),
    Case(
        "facing",
        SIDES | {"power": 1.7},
        lambda a, b, power: between(a, b, 1.0 - COSINES**power),
        site="facing",
    ),
    Case(
        "noise",
        SIDES | {"size": 0.9, "octaves": 2},
        # Noise has no closed form: the library's own, its arguments by name.
        lambda a, b, size, octaves: between(
            a, b, pattern_functions.clouds(PLACES, size=size, octaves=octaves)
        ),
    ),
    *(
        Case(
            "palette",
            {"t": t, "base": COLOR, "amplitude": (0.1, 0.2, 0.05)}
            | {"frequency": (1.0, 0.7, 2.0), "phase": (0.1, 0.37, 0.6)},
            swung,
            fixed=fixed,
        )
        for t, fixed in ((0.3, ()), (distal.pattern(rising, height=0.3, lean=0.2), ("t",)))
    ),
    Case(
        "pattern",
        {"function": rising, "kwargs": {"height": 0.3, "lean": 0.2}},
        lambda function, kwargs: {
            "": PLACES[:, 1] * kwargs["height"] + PLACES[:, 0] * kwargs["lean"]
        },
        fixed=("function",),
    ),
    Case(
        "pattern",
        {"function": rising, "args": (0.3, 0.2)},
        lambda function, args: {"": PLACES[:, 1] * args[0] + PLACES[:, 0] * args[1]},
        fixed=("function",),
    ),
]
# Without a formula here; other tests of this folder look at them.
# ``tests/paths/test_lens_and_shutter`` looks through lenses.
LENS = {"aperture", "focus_distance"}
ELSEWHERE_ARGUMENTS = {"Sky": {"light"}, "pattern": {"function"}}
# ``test_own_functions`` looks at those that are functions.
ELSEWHERE_ARGUMENTS |= {light: {"falloff"} for light in ("PointLight", "SpotLight")}
ELSEWHERE_ARGUMENTS |= {camera: LENS for camera in ("Camera", "OrbitCamera", "TurnedCamera")}
# ``test_named_materials`` looks at those that vary over a surface.
ELSEWHERE = {"by_cell", "cube_map", "image_pattern", "Environment", "granite", "marble", "wood"}


# Backgrounds


def sky(sun: Any, sun_color: Any, sun_intensity: Any, sun_angle: Any, zenith: Any, horizon: Any,
        ground: Any, intensity: float, light: bool) -> dict[str, Any]:  # fmt: skip
    """Away from the sun's rim and from the horizon, where ``tests/render/test_shading`` looks."""
    y = DIRECTIONS[:, 1:]
    y = y[:, :1]
    air = np.where(y > 0.0, arr(horizon) + y * (arr(zenith) - arr(horizon)), arr(ground))
    cosine = (DIRECTIONS @ unit(sun))[:, None]
    rim = math.cos(0.5 * sun_angle)
    s = np.clip((cosine - rim) / (0.4 * (1.0 - rim)) + 0.5, 0.0, 1.0)
    glow = 0.25 * np.maximum(cosine, 0.0) ** 64 + 0.5 * np.maximum(cosine, 0.0) ** 512
    disc = 4.0 * s * s * (3.0 - 2.0 * s)
    return {"": intensity * air + sun_intensity * arr(sun_color) * (disc + glow)}


SKY = {"sun": (0.3, 1.0, -0.4), "sun_color": COLOR, "sun_intensity": 0.8, "sun_angle": 1.3}
SKY |= {"zenith": (0.1, 0.3, 0.7), "horizon": (0.9, 0.8, 0.6), "ground": OTHER}
SKY |= {"intensity": 0.7, "light": True}
BACKGROUNDS = [
    Case(
        "Background",
        {"what": COLOR},
        lambda what: {"": everywhere(what)},
        site="direction",
    ),
    Case(
        "Background",
        {"what": colored, "numbers": {"height": 0.3, "lean": 0.2}},
        lambda what, numbers: {
            "": np.stack(
                [
                    DIRECTIONS[:, 1] * numbers["height"],
                    DIRECTIONS[:, 0] * numbers["lean"],
                    np.full(len(PLACES), 0.5),
                ],
                axis=1,
            )
        },
        site="direction",
        fixed=("what",),
    ),
    Case(
        "GradientBackground",
        {"bottom": COLOR, "top": OTHER},
        lambda bottom, top: between(bottom, top, 0.5 + 0.5 * DIRECTIONS[:, 1]),
        site="direction",
    ),
    Case("Sky", SKY, sky, "background", "direction", fixed=("light",)),
    Case(
        "Sky",
        SKY,
        lambda sun, sun_color, sun_intensity, sun_angle, **others: {
            "direction": everywhere(unit(sun)),
            "radiance": everywhere(sun_intensity * arr(sun_color)),
            "radius": np.full(len(PLACES), math.tan(0.5 * sun_angle)),
        },
        "sample",
        fixed=("light", "zenith", "horizon", "ground", "intensity"),
    ),
]
MAKERS = {name: getattr(distal, name) for name in distal.__all__} | {"TurnedCamera": TurnedCamera}
CASES = [*LIGHTS, *CAMERAS, *MATERIALS, *named_cases(), *PATTERNS, *BACKGROUNDS]
