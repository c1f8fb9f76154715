"""An author's scattering function in paths: its light, its furnace, its place among materials."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

import distal
from distal import (
    Box,
    Camera,
    CompileError,
    Environment,
    Material,
    PointLight,
    Scene,
    Sphere,
    Surface,
    furnace,
    glass,
    matte,
    metal,
    mirror,
)
from distal.lang import abs, cos, dot, floor, func, max, sin, slider, sqrt, vec3
from distal.render.own_scattering import even_density
from distal.render.sampling.warps import axes_about, in_cone, into_space
from tests.drivers import driver_picture

SHEEN = slider("Sheen", 0.5, low=0.0, high=1.0)


@func
def even(surface: Surface, n: vec3, view: vec3, light: vec3) -> vec3:
    """Lambert's law."""
    return surface.color / 3.14159265358979 if dot(n, light) > 0.0 else vec3(0.0)


@func
def through(surface: Surface, n: vec3, view: vec3, light: vec3) -> vec3:
    """Half of the light to each side."""
    return surface.color * 0.5 / 3.14159265358979


@func
def phong(surface: Surface, n: vec3, view: vec3, light: vec3) -> vec3:
    """Phong's lobe of exponent 20 about the mirrored view; no part of it is below a steep view."""
    cosine = max(dot(2.0 * dot(n, view) * n - view, light), 0.0)
    return surface.color * (SHEEN * cosine**20 / max(abs(dot(n, light)), 1e-4))


@func
def phong_sample(surface: Surface, n: vec3, view: vec3, u: vec3) -> vec3:
    """About the mirrored view."""
    z = u.x ** (1.0 / 21.0)
    level = sqrt(max(1.0 - z * z, 0.0))
    flat = vec3(level * cos(6.2831853 * u.y), level * sin(6.2831853 * u.y), z)
    return into_space(axes_about(2.0 * dot(n, view) * n - view), flat)


@func
def phong_density(surface: Surface, n: vec3, view: vec3, light: vec3) -> float:
    """The density of ``phong_sample``."""
    return 21.0 / 6.28318531 * max(dot(2.0 * dot(n, view) * n - view, light), 0.0) ** 20


@func
def anywhere(surface: Surface, n: vec3, view: vec3, u: vec3) -> vec3:
    """Any direction, of length 3."""
    z = 1.0 - 2.0 * u.x
    level = sqrt(max(1.0 - z * z, 0.0))
    return 3.0 * vec3(level * cos(6.2831853 * u.y), level * sin(6.2831853 * u.y), z)


@func
def anywhere_density(surface: Surface, n: vec3, view: vec3, light: vec3) -> float:
    """The density of ``anywhere``."""
    return 1.0 / 12.56637061


@func
def bright(surface: Surface, n: vec3, view: vec3, light: vec3) -> vec3:
    """As if the light were divided by 2 instead of pi."""
    return vec3(0.5) if dot(n, light) > 0.0 else vec3(0.0)


@func
def dark(surface: Surface, n: vec3, view: vec3, light: vec3) -> vec3:
    """Below 0 where the light is low."""
    return vec3(dot(n, light) - 0.2)


@func
def one_way(surface: Surface, n: vec3, view: vec3, light: vec3) -> vec3:
    """It depends on the view alone."""
    return vec3(0.3 * dot(n, view)) if dot(n, light) > 0.0 else vec3(0.0)


@func
def index(surface: Surface, n: vec3, view: vec3, light: vec3) -> vec3:
    """It shows the index of refraction."""
    return vec3(surface.ior * 0.1)


@func
def twice(surface: Surface, n: vec3, view: vec3, light: vec3) -> float:
    """Twice the density of ``anywhere``."""
    return 2.0 / 12.56637061


@func
def uniform(surface: Surface, n: vec3, view: vec3, u: vec3) -> vec3:
    """Any direction on the side of the view."""
    return into_space(axes_about(n), in_cone(u.xy, 1.0))


@func
def in_other_order(surface: Surface, n: vec3, light: vec3, view: vec3) -> vec3:
    """The light and the view are exchanged."""
    return view


@func
def of_world(surface: Surface, n: vec3, view: vec3, light: vec3) -> vec3:
    """As if the normal were z."""
    return vec3(0.31831) if light.z > 0.0 else vec3(0.0)


@func
def endless(surface: Surface, n: vec3, view: vec3, light: vec3) -> vec3:
    """It has no end where the light is low."""
    return vec3(1e30) * 1e30 * dot(n, light)


@func
def no_surface(n: vec3, view: vec3, light: vec3) -> vec3:
    """It lacks the surface."""
    return n


@func
def bands(p: vec3) -> float:
    """0 and 1 in turn."""
    return floor(5.0 * p.y) % 2.0


@func
def nowhere(surface: Surface, n: vec3, view: vec3, u: vec3) -> vec3:
    """No direction."""
    return vec3(0.0)


SIZE = (40, 30)
CAMERA = Camera((0.0, 1.0, 4.0))
LAMP = PointLight((2.0, 3.0, 3.0), 12.0, radius=0.5)


def light_of(material, spp=16, **given) -> np.ndarray:
    options = {"device": "cpu", "seed": 3, **given}
    shape = Sphere().paint(material) | Box(6.0, 0.2, 6.0).translate(0.0, -1.1, 0.0)
    scene = Scene(shape, LAMP, CAMERA, background="grey", floor=False)
    return scene.render(SIZE, mode="path", spp=spp, **options).linear[..., :3]


# ------------------------------------------------------------------ light


def test_lamberts_law_is_the_librarys_matte_to_the_rounding():
    known = light_of(matte("orange"))
    assert np.abs(light_of(matte("orange").bsdf(even)) - known).max() < 1e-5


def test_another_way_to_sample_gives_the_same_light():
    known = light_of(matte("orange"), 64)
    found = light_of(matte("orange").bsdf(even, anywhere, anywhere_density), 64)
    assert np.abs(found.mean((0, 1)) / known.mean((0, 1)) - 1.0).max() < 0.02
    assert np.abs(found - known).max() > 1e-3


@pytest.mark.parametrize("beside", [metal("gold", 0.3), glass(), mirror("silver")])
def test_a_mixture_of_own_and_library_is_the_mixture_of_both(beside):
    """Stripes of both, so that neither is in the other's color."""
    own, known = (
        light_of(beside.mix(made, bands), 64)
        for made in (matte("orange").bsdf(even), matte("orange"))
    )
    assert np.abs(own.mean((0, 1)) - known.mean((0, 1))).max() < 0.005


@pytest.mark.parametrize("beside", [mirror((0.8, 0.8, 0.8)), glass(), metal("gold", 0.4)])
@pytest.mark.parametrize("share", [0.25, 0.5])
def test_a_mixture_scatters_as_that_of_the_library(beside, share):
    """Lambert's law in place of matte: the shares of a mixture are those of its parts."""
    mixed = beside.mix(matte((0.2, 0.4, 0.6)).bsdf(even), share)
    known = beside.mix(matte((0.2, 0.4, 0.6)), share)
    # Fresnel's share of the library's mixture is also that of its even part, the own one has none.
    slack = 0.01 if beside == mirror((0.8, 0.8, 0.8)) else 0.04
    for own, library in zip(furnace(mixed).views, furnace(known).views, strict=True):
        if own.cosine > 0.3:
            assert own.albedo == pytest.approx(library.albedo, abs=slack)
            assert own.specular == pytest.approx(library.specular, abs=slack)
    assert not furnace(mixed).faults


def test_two_functions_in_one_scene_are_told_apart():
    left = Sphere(0.7).translate(-1.2, 0, 0)
    right = Sphere(0.7).translate(1.2, 0, 0)
    first, second = matte("white").bsdf(even), matte("black").bsdf(bright)

    def seen(a, b):
        scene = Scene(left.paint(a) | right.paint(b), LAMP, CAMERA, background="black", floor=False)
        return scene.render(SIZE, mode="path", spp=8, seed=3).linear[..., :3]

    both, one, other = seen(first, second), seen(first, first), seen(second, second)
    # Some of the light of one ball falls on the other.
    differ = np.abs(one - other).mean((0, 1)).max()
    assert np.abs(both - one)[:, :20].mean((0, 1)).max() < 0.1 * differ
    assert np.abs(both - other)[:, 20:].mean((0, 1)).max() < 0.1 * differ


def test_many_painted_parts_keep_their_functions():
    """A table of parts: colors in rows, the function by number."""
    row = [Sphere(0.1).translate(0.25 * i - 2.5, 0.3 * (i % 3), 0.0) for i in range(21)]
    colors = [(0.04 * i, 0.5, 1.0 - 0.04 * i) for i in range(21)]

    def seen(paint):
        shape = distal.union(*(s.paint(paint(c)) for s, c in zip(row, colors, strict=True)))
        scene = Scene(shape, LAMP, CAMERA, floor=False)
        return scene.render(SIZE, mode="path", spp=4, seed=3).linear[..., :3]

    assert np.abs(seen(lambda c: matte(c).bsdf(even)) - seen(matte)).max() < 1e-5


def test_caustics_fall_on_own_surfaces_as_on_the_librarys():
    ball = Sphere(0.5).translate(0, 0.8, 0).paint(glass())
    sun = Environment(np.full((4, 8, 3), 0.2, np.float32))

    def seen(material):
        floor = Box(4, 0.2, 4).paint(material)
        lamp = PointLight((0.0, 4.0, 0.0), 20.0, radius=0.05)
        scene = Scene(ball | floor, [lamp, sun], CAMERA, floor=False)
        return scene.render(SIZE, mode="path", spp=16, seed=3).linear[..., :3]

    known = seen(matte("white"))
    assert np.abs(seen(matte("white").bsdf(even)) - known).max() < 1e-4 * known.max()


def test_a_slider_that_a_function_reads_is_one_of_the_scene():
    material = matte("white").bsdf(phong, phong_sample, phong_density)
    scene = Scene(Sphere().paint(material))
    assert [p.label for p in scene.parameters()] == ["Sheen"]
    off, on = (light_of(material, 4, params={"Sheen": v}) for v in (0.0, 1.0))
    assert on.mean() > off.mean() + 0.01


# ------------------------------------------------------------------ furnace


def test_even_light_in_the_furnace():
    made = furnace(matte((0.2, 0.5, 1.0)).bsdf(even))
    assert (made.faults, made.notes) == ((), ())
    for view in made.views:
        assert view.albedo == pytest.approx((0.2, 0.5, 1.0), abs=2e-4)
        assert view.counted == pytest.approx((0.2, 0.5, 1.0), abs=2e-4)
        assert (view.density, view.specular) == (pytest.approx(1.0, abs=1e-4), (0.0, 0.0, 0.0))
    assert str(made).splitlines()[1].split()[:2] == ["1", "0.2"]


def test_a_lobe_in_the_furnace_has_its_closed_form():
    """Straight on, the integral of cos^20 over the hemisphere is 2 pi / 21."""
    lobe = matte("white").bsdf(phong, phong_sample, phong_density)
    made = furnace(lobe, [1.0], params={"Sheen": 1.0})
    whole = 2.0 * np.pi / 21.0
    assert made.views[0].counted[0] == pytest.approx(whole, rel=1e-3)
    assert made.views[0].albedo[0] == pytest.approx(whole, rel=0.01)
    assert not made.faults


@pytest.mark.parametrize(
    "material",
    [
        matte(),
        glass(),
        metal("gold", 0.3),
        metal("white", 0.05),
        distal.plastic("red", roughness=0.1),
        Material(diffuse=0.0, transmission=1.0, fresnel=True, roughness=0.3),
        mirror(),
    ],
)
def test_materials_of_the_library_pass(material):
    assert furnace(material).faults == ()
    assert furnace(material, 0.5, inside=True).faults == ()


def test_light_through_a_surface_needs_directions_there():
    made = furnace(matte().bsdf(through))
    assert made.faults == ("0.500 of the light comes from directions of density 0 at cosine 1",)
    whole = furnace(matte().bsdf(through, anywhere, anywhere_density))
    assert not whole.faults
    assert whole.views[2].albedo == pytest.approx((1, 1, 1), abs=0.01)


WRONG = {
    "space": (lambda: matte().bsdf(of_world), ""),
    "end": (lambda: matte().bsdf(endless), "evaluate gives a value that is not finite at cosine 1"),
    "both": (lambda: matte().bsdf(dark), "a value is below 0 (-"),
    "energy": (
        lambda: matte().bsdf(bright),
        "gives back 1.571 of the light at cosine 1: more than it gets",
    ),
    "sign": (
        lambda: matte().bsdf(dark, anywhere, anywhere_density),
        "a value is below 0 (-",
    ),
    "density": (
        lambda: matte().bsdf(even, anywhere, twice),
        "the density adds up to 2 instead of 1 at cosine 1",
    ),
    "sample": (
        lambda: matte().bsdf(even, anywhere, twice),
        "sample finds 0.5 0.5 0.5 of the light at cosine 1, all directions have 1 1 1",
    ),
    "directions": (
        lambda: matte("white").bsdf(even, uniform, even_density),
        "sample and density disagree in ",
    ),
    "none": (
        lambda: matte().bsdf(even, nowhere, anywhere_density),
        "sample finds 0 0 0 of the light at cosine 1, all directions have 1 1 1",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_wrong_is_named(name):
    make, text = WRONG[name]
    assert any(fault.startswith(text) for fault in furnace(make()).faults)


def test_what_is_not_reciprocal_is_noted():
    made = furnace(matte().bsdf(one_way))
    assert "view and light change places" in made.notes[0]
    assert not made.faults


@pytest.mark.parametrize(("inside", "relative"), [(False, 1.6), (True, 1.0 / 1.6)])
def test_the_index_is_that_beyond_the_surface(inside, relative):
    own = glass(1.6).bsdf(index, anywhere, anywhere_density)
    seen = furnace(own, [1.0], inside=inside).views[0]
    assert seen.counted[0] == pytest.approx(0.1 * relative * 2.0 * np.pi, rel=1e-3)


# ------------------------------------------------------------------ objects and errors


def test_a_material_keeps_its_functions():
    made = matte("red").bsdf(phong, phong_sample, phong_density)
    assert (made.evaluate, made.sample, made.density) == (phong, phong_sample, phong_density)
    assert made == matte("red").bsdf(phong, phong_sample, phong_density) != matte("red").bsdf(even)
    assert copy.deepcopy(made) == made == pickle.loads(pickle.dumps(made))
    other = made.replace(surface=matte("blue"))
    assert other == matte("blue").bsdf(phong, phong_sample, phong_density)
    assert {phong, phong_sample, phong_density} <= set(made.functions())
    assert matte("red").replace(priority=3).bsdf(even).priority == 3
    assert repr(matte("red").bsdf(even)).endswith(".bsdf(<func even>)")


REFUSED = {
    "type": (
        lambda: matte().bsdf(no_surface),
        "'no_surface' is no scattering function: it takes vec3, vec3, vec3 and returns vec3",
        "def no_surface(surface: Surface, n: vec3, view: vec3, light: vec3) -> vec3",
    ),
    "order": (
        lambda: matte().bsdf(in_other_order),
        "a scattering function takes surface, n, view, light; 'in_other_order' has surface, n, "
        "light, view",
        "def in_other_order(surface: Surface, n: vec3, view: vec3, light: vec3) -> vec3",
    ),
    "no cosine": (lambda: furnace(matte(), []), "furnace needs a cosine", "[1.0, 0.5]"),
    "no function": (
        lambda: matte().bsdf("even"),
        "a scattering function is a @func, not str 'even'",
        "@func above def scattering_function(",
    ),
    "density alone": (
        lambda: matte().bsdf(even, density=anywhere_density),
        "bsdf needs 'sample': sample and density belong together",
        "or leave out both",
    ),
    "sample alone": (
        lambda: matte().bsdf(even, anywhere),
        "bsdf needs 'density': sample and density belong together",
        "or leave out both",
    ),
    "sample for density": (
        lambda: matte().bsdf(even, anywhere, anywhere),
        "'anywhere' is no density of directions: it takes Surface, vec3, vec3, vec3 and returns",
        "-> float",
    ),
    "cosine": (lambda: furnace(matte(), [0.0]), "furnace: cosine 0 is out of range", "above 0"),
    "no material": (lambda: furnace(3), "a material or a color is wanted, not int 3", "matte("),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_refused(name):
    make, message, hint = REFUSED[name]
    with pytest.raises(CompileError) as caught:
        make()
    assert str(caught.value).startswith(f"error: {message}") or message in str(caught.value)
    assert hint in str(caught.value)


# ------------------------------------------------------------------ targets

MIXED = metal("gold", 0.4).mix(matte("orange").bsdf(through, anywhere, anywhere_density), 0.4)


def mixed_scene() -> Scene:
    shape = Sphere().paint(MIXED) | Box(1.0).translate(1.8, 0, 0).paint(matte("red").bsdf(even))
    return Scene(shape, LAMP, CAMERA, floor=True)


def mixed_light(size, device="cpu") -> np.ndarray:
    made = mixed_scene().render(size, mode="path", spp=1, filter="box", device=device)
    return made.linear[..., :3]


def off_by(found: np.ndarray, known: np.ndarray) -> float:
    """How far all but 3 % of the pixels are off: those whose path took another lobe."""
    return float(np.quantile(np.abs(found - known).max(-1), 0.97))


def test_the_reference_has_the_same_light():
    assert off_by(mixed_light((12, 8), "reference"), mixed_light((12, 8))) < 2e-3


@pytest.mark.parametrize("target", ["glsl-es300", "wgsl"])
def test_shaders_have_the_same_light(target):
    size = (24, 16)
    found = driver_picture(mixed_scene().view("color", paths=True, filter="box"), target, size)
    assert off_by(found[..., :3], mixed_light(size)) < 2e-3
