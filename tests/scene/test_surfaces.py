"""Which material shows where: paints, cuts, blends, repetitions."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from distal import Box, Material, Plane, Scene, Sphere, glass, matte, metal, pattern
from distal.ir.build import field
from distal.ir.nodes import Call, Param, Read, Return
from distal.ir.types import VEC3
from distal.lang import func, vec3
from distal.lang.composed import Composed
from distal.lang.runtime_access import executor
from distal.scene.lowering.picture import SceneLowering

RED, GREEN, BLUE = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


class ColorAt(Composed):
    """The color of a scene's material at a place."""

    name, signature, result = "color", (("p", VEC3),), VEC3

    def __init__(self, scene: Scene) -> None:
        self.scene = scene

    def compose(self, assembly: Any) -> str:
        surface = SceneLowering(assembly, self.scene).surface()
        found = Call(surface.name, (Read("p", VEC3),), surface.type.result)
        body = (Return(field(found, "color")),)
        return assembly.define("color_at", (Param("p", VEC3),), VEC3, body)


def colors(shape, places, **kwargs):
    scene = Scene(shape, default_material=(0.5, 0.5, 0.5), **kwargs)
    return executor().call(ColorAt(scene), (np.asarray(places, np.float64),), {})


def color(shape, *place):
    return pytest.approx(tuple(colors(shape, [place])[0]), abs=1e-6)


def test_the_nearer_shape_shows():
    both = Sphere(0.5).paint(RED) | Sphere(0.5).translate(3, 0, 0).paint(GREEN)
    assert color(both, 0.5, 0, 0) == RED
    assert color(both, 2.5, 0, 0) == GREEN


def test_what_is_not_painted_shows_the_default():
    both = Sphere(0.5) | Sphere(0.5).translate(3, 0, 0).paint(GREEN)
    assert color(both, 0.5, 0, 0) == (0.5, 0.5, 0.5)


def test_the_outermost_paint_wins():
    both = (Sphere(0.5).paint(RED) | Box(0.4).paint(BLUE)).paint(GREEN)
    assert color(both, 0.5, 0, 0) == GREEN


def test_smooth_blends_mix_materials_evenly_where_the_fields_are_equal():
    left, right = Sphere(0.5).translate(-0.4, 0, 0), Sphere(0.5).translate(0.4, 0, 0)
    both = left.paint(RED).union(right.paint(GREEN), smooth=0.1)
    assert color(both, 0.0, 0.4, 0) == (0.5, 0.5, 0.0)
    assert color(both, -0.9, 0.0, 0) == RED
    assert color(both, 0.9, 0.0, 0) == GREEN


def test_a_cut_shows_the_body_unless_the_cutter_has_a_cut_material():
    body, hole = Box(2.0).paint(RED), Sphere(0.5).translate(0, 1, 0)
    place = (0.0, 0.5, 0.0)
    assert color(body - hole.paint(GREEN), *place) == RED
    assert color(body - hole.cut_material(GREEN), *place) == GREEN
    assert color(body - hole.cut_material(GREEN), 1.0, 0.0, 0.0) == RED


def test_an_intersection_shows_the_shape_whose_face_it_is():
    both = Box(2.0).paint(RED) & Sphere(1.2).paint(GREEN)
    assert color(both, 1.0, 0.0, 0.0) == RED
    corner = 1.2 / np.sqrt(3.0)
    assert color(both, corner, corner, corner) == GREEN


@func
def by_place(p: vec3) -> vec3:
    return p


@func
def by_normal(n: vec3) -> vec3:
    return n


@func
def by_index(cell: vec3) -> vec3:
    return cell


def test_patterns_move_with_what_they_paint():
    painted = Sphere(1.0).paint(pattern(by_place)).rotate(z=np.pi / 2).translate(5, 0, 0)
    assert color(painted, 5.0, 1.0, 0.0) == (1.0, 0.0, 0.0)


def test_patterns_see_the_normal_of_the_painted_shape_itself():
    painted = Sphere(1.0).paint(pattern(by_normal)).rotate(z=np.pi / 2).translate(5, 0, 0)
    assert color(painted, 5.0, 1.0, 0.0) == (1.0, 0.0, 0.0)


def test_patterns_know_the_cell():
    row = Sphere(0.3).paint(pattern(by_index)).repeat(1.0, 0.0, 0.0)
    assert color(row, 2.0, 0.3, 0.0) == (2.0, 0.0, 0.0)


def test_a_paint_outside_a_repetition_would_see_no_cell_and_is_refused():
    row = Sphere(0.3).repeat(1.0, 0.0, 0.0).paint(pattern(by_index))
    with pytest.raises(ValueError, match="paint first, then repeat"):
        Scene(row)


def test_the_cheapest_renderer_is_taken():
    plain = Sphere() | Plane(-1.0)
    assert Scene(plain).renderer == "plain"
    assert Scene(plain | Box().paint(metal())).renderer == "mirrored"
    assert Scene(plain | Box().paint(glass())).renderer == "refracted"
    assert Scene(Box().paint(glass()).paint(matte("#fff")) | plain).renderer == "plain"
    assert Scene(plain | Box().paint(Material(diffuse=0.5, specular=0.4))).renderer == "mirrored"
