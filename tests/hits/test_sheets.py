"""What has no inside: found, told and drawn a part of a pixel thick, by every renderer."""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal import (
    Box,
    Camera,
    Circle,
    CircleLine,
    Disc,
    Mandelbox,
    Mandelbulb,
    Quad,
    QuaternionJulia,
    Scene,
    Shape,
    Shape2D,
    Sphere,
    TriangleSheet,
    union,
)
from distal.lang import abs, acos, atan2, clamp, cos, func, length, log, max, pow, sin, vec2, vec3
from distal.scene.checks.validation import check
from tests.hits.looking import cover, scene

EYE = (2.2, 1.7, 3.1)


@func
def sheet(p: vec3) -> float:
    return abs(length(p) - 1.0)


@func
def ball(p: vec3) -> float:
    return length(p) - 1.0


@func
def thin_shell(p: vec3) -> float:
    return abs(length(p) - 1.0) - 0.002


@func
def ring(p: vec2) -> float:
    return abs(length(p) - 1.0)


@func
def mandelbulb(p: vec3) -> float:
    z = p
    dr = 1.0
    r = length(z)
    for _ in range(12):
        r = length(z)
        if r > 2.0:
            break
        theta = acos(clamp(z.y / max(r, 1e-9), -1.0, 1.0)) * 8.0
        phi = atan2(z.z, z.x) * 8.0
        dr = pow(r, 7.0) * 8.0 * dr + 1.0
        z = p + pow(r, 8.0) * vec3(sin(theta) * cos(phi), cos(theta), sin(phi) * sin(theta))
    return 0.5 * log(max(r, 1e-9)) * r / dr


ROOM = ((-1.3,) * 3, (1.3,) * 3)


def own(function, **given):
    return Shape.from_function(function, bounds=ROOM, **given)


def flat(function):
    return Shape2D.from_function(function, bounds=((-1.3,) * 2, (1.3,) * 2))


# Shapes, and whether they have an inside.
SIGNED = {
    "ball": (Sphere(1), True),
    "disc": (Disc(1), False),
    "disc, scaled": (Disc(1).scale(2), False),
    "disc, twisted": (Disc(1).twist(1.0), False),
    "disc, rounded": (Disc(1).round(0.1), True),
    "disc, offset": (Disc(1).offset(0.1), True),
    "disc, as a shell": (Disc(1).shell(0.1, where="center"), True),
    "disc, as an inner shell": (Disc(1).shell(0.1, where="inner"), False),
    "disc or ball": (Disc(1) | Sphere(1), False),
    "disc and ball": (Disc(1) & Sphere(1), False),
    "disc without a ball": (Disc(1) - Sphere(0.5), False),
    "ball without a disc": (Sphere(1) - Disc(2), True),
    "melted": (Disc(1).union(Sphere(0.5), smooth=0.1), False),
    "own ball": (own(ball), True),
    "own sheet": (own(sheet), False),
    "own shell": (own(thin_shell), True),
    "own estimate": (own(mandelbulb), False),
    "own sheet that is said to be a solid": (own(sheet, signed=True), True),
    "own ball that is said to be a sheet": (own(ball, signed=False), False),
    "flat ring, extruded": (flat(ring).extrude(0.2), False),
    "flat circle, extruded": (Circle(1).extrude(0.2), True),
}


@pytest.mark.parametrize("name", SIGNED)
def test_whether_a_shape_has_an_inside(name):
    shape, is_signed = SIGNED[name]
    assert shape.node.signed is is_signed


@pytest.mark.parametrize("mode", ["direct", "path"])
def test_sheets_are_seen(mode):
    """As solids of two thousandths are; lines are there."""
    given = {"mode": mode, "samples": 4 if mode == "path" else 1, "size": 96}
    for thin in (
        Disc(1),
        Quad(),
        TriangleSheet(),
        own(sheet),
        Disc(1).scale(2),
        Disc(1) - Box(0.5),
    ):
        assert cover(thin, EYE, 50, **given) == pytest.approx(
            cover(thin.round(2e-3), EYE, 50, **given), abs=6e-3
        )
    line = scene(CircleLine(1), EYE, fov=50)
    given["size"] = (96, 96)
    assert 1e-3 < line.render(transparent=True, **given).array[..., 3].mean() < 0.03


def test_a_sheet_is_a_part_of_a_pixel_thick_from_any_distance():
    """A disc seen from its side is a line of one pixel or less."""
    for away in (1.0, 100.0):
        width = cover(Disc(1), (6.0 * away, 0.0, 0.0), 30.0 / away, size=160) * 160**2
        height = width / (2.0 * 160 / (2.0 * 6.0 * math.tan(math.radians(15.0))))
        assert height < 1.5


def test_what_is_solid_stays_as_it_is_beside_a_sheet():
    """No film grows in a flush bore because a sheet is in the scene."""
    bored = Box(2, 1, 1) - Box(1, 1, 0.4)
    eye = (0.0, 5.0, 0.001)
    alone = cover(bored, eye)
    assert cover(bored | Disc(0.1).translate(0.0, -5.0, 9.0), eye) == pytest.approx(alone, abs=1e-3)


def test_many_sheets_are_seen_beside_a_table():
    discs = [Disc(0.3).rotate(x=0.3 * i).translate(i % 5 - 2, i // 5 - 2, 0) for i in range(25)]
    balls = [Sphere(0.2).translate(i % 5 - 2, i // 5 - 2, 0.4) for i in range(25)]
    thick = [disc.round(2e-3) for disc in discs]
    for mode in ("direct", "path"):
        given = {"mode": mode, "samples": 4 if mode == "path" else 1, "size": 96}
        found, right = (
            cover(union(*some, *balls), (0, 0, 9), 40, **given) for some in (discs, thick)
        )
        assert found == pytest.approx(right, abs=6e-3)


ESTIMATES = {
    "own": own(mandelbulb, slope=1.0),
    "Mandelbulb": Mandelbulb(8, 12),  # .054 without thickness
    "QuaternionJulia": QuaternionJulia(),
    "Mandelbox, cut": Mandelbox() - Box(0.5).translate(0.7, 0.7, 0.7),
}


@pytest.mark.parametrize("name", ESTIMATES)
def test_an_estimate_is_a_surface_and_not_noise(name):
    """Rays find it, and one sample of a pixel is about the mean of many."""
    camera = Camera((2.2, 1.4, 2.4), fov_deg=40)
    shown = Scene(ESTIMATES[name], camera=camera, floor=False)
    one, many = (shown.render((160, 120), samples=n) for n in (1, 16))
    assert one.stats["lost"].get("steps", 0.0) < 5e-4
    assert np.abs(one.array - many.array)[..., :3].mean() < 0.04


def test_check_says_what_has_no_inside_and_whose_slope_is_far_too_large():
    steep = own(ball, slope=1000.0)
    codes = {
        shape.name: [str(finding.diagnostic.code) for finding in check(shape).findings]
        for shape in (own(sheet).named("a sheet"), own(ball).named("a ball"), steep.named("steep"))
    }
    assert "no-inside" in codes["a sheet"]
    assert not {"no-inside", "slope-too-large"} & {*codes["a ball"]}
    assert "slope-too-large" in codes["steep"]
