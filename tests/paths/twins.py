"""Scenes that distal and Mitsuba 3 render alike, each declared once.

A ``Twin`` gives the distal scene and the Mitsuba dictionary. ``tools/gen_twins.py`` renders the
latter and stores the mean light of tiles; ``test_twins`` compares. Nothing here imports Mitsuba.

Units: a distal lamp of intensity 1 shows 1 on a white surface, so its radiant intensity or
irradiance is pi; a lamp of radius r has the radiance intensity / r^2. Lamps are no shapes here:
the camera, mirrors and clear glass do not see them. So lamps with a radius are out of the picture,
and light scenes of matte and rough surfaces. The width of facets is roughness^2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from distal import (
    AmbientLight,
    Box,
    Camera,
    Cylinder,
    DistantLight,
    Environment,
    Material,
    Plane,
    PointLight,
    Scene,
    Sphere,
    checker,
)

Color = tuple[float, float, float]
Kind = Literal["matte", "metal", "glass", "plastic"]

WIDTH, HEIGHT, TILE = 64, 48, 8
WHITE: Final = (1.0, 1.0, 1.0)
BLACK: Final = (0.0, 0.0, 0.0)
FAR: Final = 2000.0  # half of the size of a plane, which is finite there
ENVIRONMENT_ROWS: Final = 128


@dataclass(frozen=True)
class Paint:
    """A material.

    Attributes:
        kind: Which.
        color: What it scatters or mirrors.
        roughness: That of metal and glass.
        ior: That of glass and plastic.
        glow: The light that it emits; the surface is black then.
        dark: The other color of a checker of squares of size 0.5; None if there is none.
    """

    kind: Kind = "matte"
    color: Color = (0.6, 0.6, 0.6)
    roughness: float = 0.0
    ior: float = 1.5
    glow: Color = BLACK
    dark: Color | None = None

    def ours(self) -> Any:
        """The material here."""
        color = self.color if self.dark is None else checker(self.color, self.dark, size=0.5)
        fresnel = 1.0 if self.kind in ("glass", "plastic") else 0.0
        return Material(
            color=color,
            diffuse=1.0 if self.kind in ("matte", "plastic") and self.glow == BLACK else 0.0,
            specular=1.0 if self.kind == "metal" else 0.0,
            transmission=1.0 if self.kind == "glass" else 0.0,
            ior=self.ior,
            roughness=self.roughness,
            metal=1.0 if self.kind == "metal" else 0.0,
            emission=self.glow,
            fresnel=fresnel,
        )

    def theirs(self, mi: Any) -> dict[str, Any]:
        """The material there."""
        color: dict[str, Any] = rgb(self.color)
        width = self.roughness**2
        if self.dark is not None:
            # The pattern has a period of 1, and its second coordinate is -z.
            scale = mi.ScalarTransform4f().scale([2 * FAR, 2 * FAR, 1.0])
            color = {"type": "checkerboard", "color0": rgb(self.dark), "color1": rgb(self.color)}
            color["to_uv"] = scale
        if self.glow != BLACK:
            return {"type": "diffuse", "reflectance": rgb(BLACK)}
        if self.kind == "matte":
            return {"type": "diffuse", "reflectance": color}
        if self.kind == "plastic":
            made = {"type": "plastic", "int_ior": self.ior, "ext_ior": 1.0, "nonlinear": False}
            return {**made, "diffuse_reflectance": color}
        facets = {"distribution": "ggx", "alpha": width} if width > 0.0 else {}
        rough = "rough" if width > 0.0 else ""
        if self.kind == "metal":
            made = {"type": f"{rough}conductor", "material": "none", **facets}
            return {**made, "specular_reflectance": color}
        return {"type": f"{rough}dielectric", "int_ior": self.ior, "ext_ior": 1.0, **facets}


@dataclass(frozen=True)
class Solid:
    """A solid.

    Attributes:
        shape: "ball" of radius size[0], "box" of full sizes, "cylinder" of radius and full height
            along y, or "plane", whose height is that of ``place``.
        size: As above.
        place: Its middle.
        paint: Its material.
        turn: About the upright axis, in degrees.
    """

    shape: Literal["ball", "box", "cylinder", "plane"]
    size: tuple[float, ...] = ()
    place: Color = BLACK
    paint: Paint = Paint()
    turn: float = 0.0

    def ours(self) -> Any:
        """The solid here."""
        if self.shape == "plane":
            return Plane(y=self.place[1]).paint(self.paint.ours())
        if self.shape == "ball":
            made: Any = Sphere(self.size[0])
        elif self.shape == "box":
            made = Box(*self.size).rotate(y=math.radians(self.turn))
        else:
            made = Cylinder(*self.size)
        return made.translate(*self.place).paint(self.paint.ours())

    def theirs(self, mi: Any) -> list[dict[str, Any]]:
        """The shapes there; a cylinder has two discs as its ends."""
        moved = mi.ScalarTransform4f().translate(list(self.place))
        known: dict[str, Any] = {"bsdf": self.paint.theirs(mi)}
        if self.paint.glow != BLACK:
            known["emitter"] = {"type": "area", "radiance": rgb(self.paint.glow)}
        if self.shape == "ball":
            return [{"type": "sphere", "center": list(self.place), "radius": self.size[0], **known}]
        if self.shape == "plane":
            level = moved.rotate([1, 0, 0], -90).scale(FAR)
            return [{"type": "rectangle", "to_world": level, **known}]
        if self.shape == "box":
            half = [0.5 * side for side in self.size]
            turned = moved.rotate([0, 1, 0], self.turn).scale(half)
            return [{"type": "cube", "to_world": turned, **known}]
        radius, height = self.size
        ends = [[0, -0.5 * height, 0], [0, 0.5 * height, 0]]
        side = {"type": "cylinder", "p0": ends[0], "p1": ends[1], "radius": radius}
        discs = [
            moved.translate(end).rotate([1, 0, 0], angle).scale(radius)
            for end, angle in zip(ends, (90, -90), strict=True)
        ]
        return [
            {**side, "to_world": moved, **known},
            *({"type": "disk", "to_world": disc, **known} for disc in discs),
        ]


@dataclass(frozen=True)
class Lamp:
    """A light that is no shape.

    Attributes:
        kind: "point" at a place, "distant" from a direction, "everywhere" with the light
            ``color``, or "environment", the picture ``environment``.
        place: The place or the direction.
        color: Its color, times its intensity.
        radius: That of a point light.
    """

    kind: Literal["point", "distant", "everywhere", "environment"]
    place: Color = BLACK
    color: Color = WHITE
    radius: float = 0.0

    @property
    def has_size(self) -> bool:
        """Whether random rays meet it."""
        return self.radius > 0.0 or self.kind in ("everywhere", "environment")

    def ours(self) -> Any:
        """The light here."""
        if self.kind == "point":
            return PointLight(self.place, color=self.color, radius=self.radius)
        if self.kind == "distant":
            return DistantLight(self.place, color=self.color)
        if self.kind == "everywhere":
            return AmbientLight(1.0, self.color)
        rows = (np.arange(ENVIRONMENT_ROWS) + 0.5) / ENVIRONMENT_ROWS
        return Environment(environment(rows, self.color))

    def theirs(self, mi: Any) -> dict[str, Any]:
        """The light there."""
        if self.kind == "point" and self.radius == 0.0:
            light = rgb(math.pi * np.array(self.color))
            return {"type": "point", "position": list(self.place), "intensity": light}
        if self.kind == "point":
            light = rgb(np.array(self.color) / self.radius**2)
            ball = {"type": "sphere", "center": list(self.place), "radius": self.radius}
            black = {"type": "diffuse", "reflectance": rgb(BLACK)}
            return {**ball, "bsdf": black, "emitter": {"type": "area", "radiance": light}}
        if self.kind == "distant":
            light = rgb(math.pi * np.array(self.color))
            way = [-float(v) for v in self.place]
            return {"type": "directional", "direction": way, "irradiance": light}
        if self.kind == "everywhere":
            return {"type": "constant", "radiance": rgb(self.color)}
        # Its first and last rows are at the poles, and -z is at its sides.
        rows = np.arange(ENVIRONMENT_ROWS) / (ENVIRONMENT_ROWS - 1)
        turned = mi.ScalarTransform4f().rotate([0, 1, 0], 180)
        image = mi.Bitmap(environment(rows, self.color))
        return {"type": "envmap", "bitmap": image, "to_world": turned}


@dataclass(frozen=True)
class Twin:
    """A scene.

    Attributes:
        solids: What is in it.
        lamps: What lights it besides solids that glow.
        eye: Where the camera is.
        target: Where it looks.
        fov: Its upright field of view in degrees.
        apart: By which share of the light the models differ, beyond noise; 0 if they are equal.
        why: Why they do.
    """

    solids: tuple[Solid, ...]
    lamps: tuple[Lamp, ...] = ()
    eye: Color = (0.0, 3.0, 6.0)
    target: Color = (0.0, 0.3, 0.0)
    fov: float = 36.0
    apart: float = 0.0
    why: str = ""

    def ours(self) -> Scene:
        """The scene here."""
        lights = [lamp.ours() for lamp in self.lamps]
        backgrounds: list[Any] = [BLACK]
        for lamp, light in zip(self.lamps, lights, strict=True):
            if lamp.kind == "everywhere":
                backgrounds.append(lamp.color)
            elif lamp.kind == "environment":
                backgrounds.append(light)
        shape = self.solids[0].ours()
        for solid in self.solids[1:]:
            shape = shape | solid.ours()
        camera = Camera(self.eye, target=self.target, fov_deg=self.fov)
        return Scene(shape, lights=lights, camera=camera, background=backgrounds[-1], floor=False)

    def theirs(self, mi: Any, size: tuple[int, int] = (WIDTH, HEIGHT)) -> dict[str, Any]:
        """The Mitsuba dictionary.

        Args:
            mi: The module ``mitsuba``, with a variant.
            size: Width and height of the picture.
        """
        looks = mi.ScalarTransform4f().look_at(list(self.eye), list(self.target), [0, 1, 0])
        film = {"type": "hdrfilm", "width": size[0], "height": size[1], "pixel_format": "rgb"}
        film |= {"rfilter": {"type": "tent"}, "sample_border": True}
        made: dict[str, Any] = {
            "type": "scene",
            "integrator": {"type": "path", "max_depth": 128, "rr_depth": 5},
            "sensor": {
                "type": "perspective",
                "fov": self.fov,
                "fov_axis": "y",
                "to_world": looks,
                "film": film,
                "sampler": {"type": "independent"},
            },
        }
        shapes = [shape for solid in self.solids for shape in solid.theirs(mi)]
        made |= {f"shape_{i}": shape for i, shape in enumerate(shapes)}
        return made | {f"lamp_{i}": lamp.theirs(mi) for i, lamp in enumerate(self.lamps)}


def rgb(color: Any) -> dict[str, Any]:
    """A color of Mitsuba."""
    return {"type": "rgb", "value": [float(v) for v in color]}


def environment(rows: NDArray[np.float64], color: Color) -> NDArray[np.float32]:
    """A smooth panorama: a bright place on the upper right, a gradient elsewhere.

    Args:
        rows: The rows, from 0 at the top to 1 at the bottom.
        color: Its color.
    """
    columns = 2 * len(rows)
    polar = math.pi * rows[:, None]
    turn = 2.0 * math.pi * ((np.arange(columns) + 0.5) / columns - 0.5)[None, :]
    way = np.stack(
        np.broadcast_arrays(
            np.sin(polar) * np.sin(turn), np.cos(polar), -np.sin(polar) * np.cos(turn)
        ),
        axis=-1,
    )
    bright = way @ (np.array([2.0, 3.0, 1.5]) / np.linalg.norm([2.0, 3.0, 1.5]))
    light = 0.3 + 0.2 * way[..., 1] + 6.0 * np.exp(12.0 * (bright - 1.0))
    return (light[..., None] * np.array(color)).astype(np.float32)


def three(first: Paint, second: Paint, third: Paint, floor: Paint) -> tuple[Solid, ...]:
    """A ball, a box and a cylinder a little above a plane, so that no two faces are one."""
    return (
        Solid("ball", (0.6,), (-1.4, 0.65, 0.2), first),
        Solid("box", (0.9, 1.0, 0.8), (0.1, 0.55, -0.3), second, 30.0),
        Solid("cylinder", (0.45, 1.1), (1.4, 0.6, 0.3), third),
        Solid("plane", (), BLACK, floor),
    )


RED = Paint(color=(0.8, 0.2, 0.1))
GREEN = Paint(color=(0.2, 0.7, 0.3))
PALE = Paint(color=(0.9, 0.85, 0.8))
GRAY = Paint(color=(0.5, 0.5, 0.5))
SQUARES = Paint(color=(0.8, 0.8, 0.8), dark=(0.1, 0.1, 0.15))
MIRROR = Paint("metal", (0.9, 0.8, 0.6))
BRUSHED = Paint("metal", (0.9, 0.7, 0.5), roughness=0.2)
GLASS = Paint("glass", WHITE)
DENSE = Paint("glass", WHITE, ior=1.8)
FROSTED = Paint("glass", WHITE, roughness=0.5)
COATED = Paint("plastic", (0.7, 0.3, 0.2))
LAMP = Paint(glow=(9.0, 8.0, 6.0))
AROUND = Lamp("environment")
FACETS = (
    "Reflection has height-correlated masking and the light that facets pass on to each other, "
    "there separable masking of single scattering"
)

TWINS: Final[dict[str, Twin]] = {
    "matte, point light": Twin(
        three(RED, GREEN, PALE, GRAY), (Lamp("point", (1.0, 3.0, 2.0), (9.0, 8.0, 7.0)),)
    ),
    "matte, distant light": Twin(
        three(RED, GREEN, PALE, SQUARES), (Lamp("distant", (1.0, 2.0, 1.0), (1.0, 0.9, 0.8)),)
    ),
    "matte, light from everywhere": Twin(
        three(PALE, PALE, RED, GRAY), (Lamp("everywhere", color=(0.7, 0.8, 1.0)),)
    ),
    "matte, a lamp with a radius": Twin(
        three(RED, PALE, GREEN, GRAY), (Lamp("point", (1.5, 4.0, 1.0), (9.0, 9.0, 9.0), 0.7),)
    ),
    "matte, environment": Twin(three(RED, GREEN, PALE, SQUARES), (AROUND,)),
    "mirrors": Twin(
        three(MIRROR, MIRROR, MIRROR, SQUARES),
        (Lamp("everywhere", color=(0.4, 0.5, 0.6)), Lamp("distant", (-1.0, 2.0, 1.0))),
    ),
    "smooth glass, environment": Twin(three(GLASS, DENSE, GLASS, SQUARES), (AROUND,)),
    "smooth glass, light from everywhere": Twin(
        three(DENSE, GLASS, DENSE, SQUARES), (Lamp("everywhere", color=WHITE),)
    ),
    "rough glass, environment": Twin(
        three(FROSTED, FROSTED, FROSTED, SQUARES), (AROUND,), apart=0.004, why=FACETS
    ),
    "rough metal, environment": Twin(
        three(BRUSHED, BRUSHED, BRUSHED, SQUARES), (AROUND,), apart=0.01, why=FACETS
    ),
    "rough metal, a lamp with a radius": Twin(
        three(BRUSHED, PALE, BRUSHED, GRAY),
        (Lamp("point", (0.5, 5.0, 2.0), (15.0, 15.0, 15.0), 1.0),),
        apart=0.01,
        why=FACETS,
    ),
    "plastic, environment": Twin(three(COATED, COATED, COATED, SQUARES), (AROUND,)),
    "area lights": Twin(
        (
            Solid("ball", (0.7,), (-2.6, 1.2, 1.0), LAMP),
            Solid("box", (1.6, 0.2, 1.2), (1.0, 3.4, 0.0), LAMP, 20.0),
            *three(PALE, RED, COATED, GRAY),
        )
    ),
    "a room": Twin(
        (
            Solid("box", (6.0, 0.2, 6.0), (0.0, -0.1, 0.0), PALE),
            Solid("box", (6.0, 0.2, 6.0), (0.0, 4.1, 0.0), PALE),
            Solid("box", (0.2, 4.0, 6.0), (-3.1, 2.0, 0.0), RED),
            Solid("box", (0.2, 4.0, 6.0), (3.1, 2.0, 0.0), GREEN),
            Solid("box", (6.4, 4.4, 0.2), (0.0, 2.0, -3.1), PALE),
            Solid("box", (2.0, 0.2, 2.0), (0.0, 3.8, 0.0), LAMP),
            Solid("ball", (0.8,), (-1.2, 0.8, 0.3), GRAY),
            Solid("cylinder", (0.6, 1.8), (1.3, 0.9, -0.4), MIRROR),
        ),
        eye=(0.0, 2.0, 8.0),
        target=(0.0, 1.9, 0.0),
        fov=40.0,
    ),
}


def tiles(light: NDArray[Any]) -> NDArray[np.float64]:
    """The mean light of each tile of pictures (..., height, width, 3)."""
    before = light.shape[:-3]
    cut = light.reshape(*before, HEIGHT // TILE, TILE, WIDTH // TILE, TILE, 3)
    return np.asarray(cut.astype(np.float64).mean(axis=(-4, -2)))


def mean_and_error(estimates: NDArray[np.float64]) -> tuple[Any, Any]:
    """The mean of independent estimates, and its standard error."""
    return estimates.mean(axis=0), estimates.std(axis=0, ddof=1) / math.sqrt(len(estimates))
