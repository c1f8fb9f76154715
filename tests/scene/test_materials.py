"""Materials give the surfaces they say, and refuse what no surface can be."""

from __future__ import annotations

import numpy as np
import pytest

from distal.ir.types import FLOAT
from distal.lang import color, func, slider, vec3
from distal.lang.expressions import time
from distal.render.material import Surface, mix_surfaces
from distal.scene.objects.materials import (
    Material,
    as_material,
    emissive,
    glass,
    glossy,
    matte,
    metal,
    mirror,
    plastic,
)
from distal.scene.tree.errors import SceneTypeError, SceneValueError
from tests.scene.probing import emitted

HERE = (0.25, 0.5, 0.75)
RED, BLUE = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)


@func
def ramp(p: vec3, length: float = 1.0) -> float:
    return p.x / length


@func
def tint(p: vec3, n: vec3, cell: vec3) -> vec3:
    return p + n + cell


@func
def own(p: vec3, shine: float) -> Surface:
    return Surface(p, 0.5, shine, 0.0, 1.5, 0.2, 0.0, vec3(0.0), vec3(0.0), 0.0)


@func
def flat_tint(p: vec3) -> int:
    return 1


def surface(material, **site):
    site = site or {"p": HERE}
    return {
        "color": emitted(material, "color", **site),
        **{
            name: float(emitted(material, name, FLOAT, **site))
            for name in ("diffuse", "specular", "transmission", "ior", "roughness", "metal")
        },
        "fresnel": float(emitted(material, "fresnel", FLOAT, **site)),
    }


def test_a_material_is_made_of_its_numbers():
    made = Material("#f00", 0.2, 0.1, 0.6, 1.4, 0.3, 0.5, emission=2.0, absorption=(0, 1, 2))
    found = surface(made)
    assert found.pop("color") == pytest.approx(RED)
    assert found == pytest.approx(
        {
            "diffuse": 0.2,
            "specular": 0.1,
            "transmission": 0.6,
            "ior": 1.4,
            "roughness": 0.3,
            "metal": 0.5,
            "fresnel": 0.0,
        }
    )
    assert emitted(made, "emission", p=HERE) == pytest.approx((2.0, 2.0, 2.0))
    assert emitted(made, "absorption", p=HERE) == pytest.approx((0.0, 1.0, 2.0))
    assert float(emitted(Material(fresnel=True), "fresnel", FLOAT, p=HERE)) == 1.0


@pytest.mark.parametrize(
    ("material", "reflects", "refracts"),
    [
        (matte("#f00"), False, False),
        (glossy("#f00", 0.7, 0.3), True, False),
        (metal("#fa0"), True, False),
        (mirror(), True, False),
        (glass(ior=1.4), True, True),
        (plastic("#f00"), True, False),
        (emissive("#ff0", 3.0), False, False),
        (Material(), False, False),
        (Material(diffuse=0.5, specular=0.5), True, False),
        (Material(specular=slider("Shine", 0.0), diffuse=0.0), True, False),
        (Material(diffuse=0.0, transmission=ramp), False, True),
        (Material(fresnel=True), True, False),
        (matte("#f00").mix(glass(), 0.5), True, True),
        (as_material(matte(ramp)), False, False),
    ],
)
def test_a_scene_knows_where_rays_may_go(material, reflects, refracts):
    assert (material.reflects, material.refracts) == (reflects, refracts)
    weights = surface(material)
    assert weights["diffuse"] + weights["specular"] + weights["transmission"] <= 1.0 + 1e-6
    if not reflects:
        assert weights["specular"] == weights["fresnel"] == 0.0
    if not refracts:
        assert weights["transmission"] == 0.0


def test_a_color_is_a_material_wherever_one_is_wanted():
    for value in ("#f00", RED, np.array(RED), vec3(*RED), color("Paint", "#f00")):
        assert emitted(as_material(value), "color", p=HERE) == pytest.approx(RED)
    made = matte("#f00")
    assert as_material(made) is made


def test_numbers_follow_parameters_and_time():
    shine = slider("Shine", 0.25)
    made = glossy("#fff", 0.25, specular=shine, roughness=0.5 + 0.25 * time)
    assert float(emitted(made, "specular", FLOAT, p=HERE)) == 0.25
    assert float(emitted(made, "specular", FLOAT, {"shine": 0.75}, p=HERE)) == 0.75
    assert float(emitted(made, "roughness", FLOAT, time=1.0, p=HERE)) == 0.75


def test_a_function_of_the_place_stands_for_a_color_or_a_number():
    assert emitted(matte(ramp), "color", p=HERE) == pytest.approx((0.25,) * 3)
    assert emitted(Material(tint), "color", p=HERE, n=(1, 0, 0), cell=(0, 2, 0)) == pytest.approx(
        (1.25, 2.5, 0.75)
    )
    assert float(emitted(Material(roughness=ramp), "roughness", FLOAT, p=HERE)) == 0.25
    assert Material(tint).uses == {"p", "n", "cell"}
    assert Material(roughness=ramp).uses == {"p"}
    assert matte("#f00").uses == set()


def test_a_function_may_give_a_whole_surface():
    with pytest.raises(SceneTypeError, match="own needs 'shine'"):
        as_material(own)


def test_glass_takes_on_its_color_in_one_unit_of_way():
    for given in ("#808080", (0.21586,) * 3, color("Tint", "#808080")):
        taken = emitted(glass(color=given), "absorption", p=HERE)
        assert np.exp(-taken) == pytest.approx((0.21586,) * 3, rel=1e-4)
    assert emitted(glass(color=(1, 0, 1)), "absorption", p=HERE)[1] < 10.0, "finite"
    assert emitted(glass(absorption=(0, 1, 2)), "absorption", p=HERE) == pytest.approx((0, 1, 2))
    with pytest.raises(SceneTypeError, match="color or absorption, not both"):
        glass(color="#fff", absorption=1.0)


def test_what_shines_may_be_brighter_than_white():
    made = emissive((4.0, 2.0, 1.0), strength=3.0)
    assert emitted(made, "emission", p=HERE) == pytest.approx((12.0, 6.0, 3.0))
    with pytest.raises(SceneValueError, match="between 0 and 1"):
        matte((4.0, 2.0, 1.0))


def test_two_materials_mix_in_every_number():
    mixed = matte(RED).mix(glass(1.4), ramp)
    found = surface(mixed)
    assert found["color"] == pytest.approx((1.0, 0.25, 0.25))
    assert found["diffuse"] == pytest.approx(0.75)
    assert found["transmission"] == pytest.approx(0.25)
    assert surface(matte(RED).mix(BLUE))["color"] == pytest.approx((0.5, 0.0, 0.5))


def test_what_is_painted_twice_has_one_set_of_numbers():
    made = matte("#f00")

    class Twice:
        def emit(self, composer, site):
            parts = {"a": made.emit(composer, site), "b": made.emit(composer, site)}
            assert parts["a"] is parts["b"]
            t = composer.assembly.constant(0.5, FLOAT)
            return composer.assembly.call(mix_surfaces, {**parts, "t": t})

    assert emitted(Twice(), "color", p=HERE) == pytest.approx(RED)


@pytest.mark.parametrize(
    ("make", "error", "message", "hint"),
    [
        (
            lambda: Material(diffuse=0.9, specular=0.2),
            SceneValueError,
            "the weights of Material add up to 1.1: diffuse 0.9 + specular 0.2",
            "give away at most all of the light: a sum of 1",
        ),
        (
            lambda: Material("#f00", roughness=2),
            SceneValueError,
            "'roughness of Material' must be between 0 and 1, not 2",
            None,
        ),
        (
            lambda: glass(ior=0),
            SceneValueError,
            "'ior of glass' must be above 0, not 0",
            None,
        ),
        (
            lambda: matte("tomatoe"),
            SceneValueError,
            "'color of matte' takes a color like #rrggbb or tomato, not 'tomatoe'",
            "did you mean 'tomato'?",
        ),
        (
            lambda: matte("transparent"),
            SceneValueError,
            "'color of matte' takes a color like #rrggbb or tomato, not 'transparent'",
            "a color is opaque: write glass(), or render(transparent=True) for the background",
        ),
        (
            lambda: matte(matte("#f00")),
            SceneTypeError,
            "'color of matte' takes no material",
            None,
        ),
        (
            lambda: as_material(3),
            SceneTypeError,
            "a material or a color is wanted, not int 3",
            'write matte("#rrggbb"), glass(), metal() or Material(color=…)',
        ),
        (
            lambda: Material(roughness=tint),
            SceneTypeError,
            "'roughness of Material' takes a float; tint gives a vec3",
            None,
        ),
        (
            lambda: matte(flat_tint),
            SceneTypeError,
            "'flat_tint' is no pattern: it gives a int",
            "def flat_tint(p: vec3) -> vec3, or -> float, or -> Surface",
        ),
    ],
)
def test_mistakes_say_what_is_wrong_and_what_mends_it(make, error, message, hint):
    with pytest.raises(error) as caught:
        make()
    (diagnostic,) = caught.value.diagnostics
    assert (diagnostic.message, diagnostic.hint) == (message, hint)


def test_weights_that_are_not_known_yet_are_let_through():
    Material(diffuse=0.9, specular=slider("Shine", 0.05))
    Material(diffuse=0.9, specular=ramp)
    Material(diffuse=0.05, specular=0.1, transmission=0.85)


def test_a_material_does_not_change():
    with pytest.raises(AttributeError, match="does not change"):
        matte("#f00").reflects = True
