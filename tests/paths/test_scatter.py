"""Scattering of surfaces: energy, reciprocity, densities; against formulas written out in NumPy."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

from distal.lang import vec3
from distal.render import material, microfacets, scatter
from distal.render.material import Surface
from tests.paths.counting import (
    SURPRISING,
    counted,
    deviation,
    directions_of,
    expected_in_cells,
    grid,
    places_of,
)

UP = (0.0, 0.0, 1.0)


def rough_glass(roughness, ior=1.5):
    return Surface(diffuse=0.0, transmission=1.0, fresnel=1.0, roughness=roughness, ior=ior)


MATERIALS = {
    "matte": material.matte(vec3(0.8, 0.5, 0.2)),
    "glossy": material.glossy(vec3(0.9, 0.6, 0.3), 0.4, 0.5, 0.5),
    "glossy, smooth": material.glossy(vec3(0.9, 0.6, 0.3), 0.4, 0.5, 0.0),
    "metal": material.metal(vec3(0.9, 0.7, 0.3), 0.4),
    "roughest metal": material.metal(vec3(0.9, 0.7, 0.3), 1.0),
    "mirror": material.mirror(),
    "glass": material.glass(),
    "rough glass": rough_glass(0.45),
    "roughest glass": rough_glass(1.0),
    "nearly smooth glass": rough_glass(0.12),
    "dense glass": rough_glass(0.4, 2.4),
    "air in glass": rough_glass(0.4, 0.7),
    "no glass": rough_glass(0.4, 1.0),
    "plastic": material.plastic(vec3(0.8, 0.2, 0.1), 0.4),
    "smooth plastic": material.plastic(vec3(0.8, 0.2, 0.1), 0.0),
    "emissive": material.emissive(vec3(1.0), 5.0),
    "everything": Surface(
        vec3(0.9, 0.8, 0.5), 0.3, 0.2, 0.5, 1.4, 0.5, 0.0, vec3(0.1), vec3(0.1), 0.6
    ),
    "half metal": Surface(vec3(0.9, 0.6, 0.5), 0.5, 0.2, 0.0, 1.4, 0.5, 0.5, fresnel=0.7),
    "black": Surface(color=vec3(0.0), diffuse=0.0),
}
SPREAD = [
    "matte", "glossy", "metal", "roughest metal", "rough glass", "roughest glass", "dense glass",
    "air in glass", "plastic", "smooth plastic", "everything",
    "half metal",
]  # fmt: skip


def seen_at(cosine, turn=0.4):
    level = math.sqrt(1 - cosine * cosine)
    return (level * math.cos(turn), level * math.sin(turn), cosine)


def numbers(count, seed=5):
    """Random triples; the first two stratified in cells."""
    rng = np.random.default_rng(seed)
    side = int(math.sqrt(count))
    flat = grid(side) + (rng.random((side * side, 2)) - 0.5) / side
    return np.column_stack([flat, rng.random(side * side)]).astype(np.float32)


def samples(surface, cosine, inside=False, count=1 << 14, seed=5):
    return scatter.sample(surface, seen_at(cosine), UP, inside, numbers(count, seed))


def albedo(surface, cosine, inside=False, count=1 << 14):
    return np.asarray(samples(surface, cosine, inside, count).weight, float).mean(0)


def respond(surface, view, lights, inside=False):
    return scatter.respond(surface, view, lights, UP, inside)


# ------------------------------------------------------------------ energy

COSINES = [1.0, 0.8, 0.5, 0.25, 0.12]


@pytest.mark.parametrize("inside", [False, True])
@pytest.mark.parametrize("cosine", [*COSINES, 0.03])
@pytest.mark.parametrize(
    "surface",
    [
        material.matte(),
        material.mirror(),
        material.glass(),
        material.glass(2.4),
        material.glass(1.0),
        material.metal(vec3(1.0), 0.0),
    ],
)
def test_smooth_surfaces_lose_nothing(surface, cosine, inside):
    assert albedo(surface, cosine, inside, 1 << 12) == pytest.approx((1, 1, 1), abs=2e-5)


@pytest.mark.parametrize("roughness", [0.15, 0.3, 0.5, 0.75, 1.0])
@pytest.mark.parametrize("cosine", COSINES)
def test_white_metal_loses_nothing(roughness, cosine):
    """0.006 is what the fit of ``white_loss`` is off by; the rest is noise."""
    found = albedo(material.metal(vec3(1.0), roughness), cosine)
    assert found == pytest.approx((1, 1, 1), abs=0.012)


@pytest.mark.parametrize("roughness", [0.0, 0.3, 0.6, 1.0])
@pytest.mark.parametrize("ior", [1.33, 1.5, 2.0])
@pytest.mark.parametrize("cosine", COSINES)
def test_white_plastic_loses_nothing(roughness, ior, cosine):
    found = albedo(material.plastic(vec3(1.0), roughness, ior), cosine)
    assert found == pytest.approx((1, 1, 1), abs=0.015)


@pytest.mark.parametrize("roughness", [0.3, 0.6, 1.0])
@pytest.mark.parametrize("cosine", COSINES)
def test_glossy_weights_hold_when_rough(roughness, cosine):
    surface = material.glossy(vec3(0.5, 1.0, 0.0), 0.5, 0.25, roughness)
    assert albedo(surface, cosine) == pytest.approx((0.5, 0.75, 0.25), abs=0.01)


@pytest.mark.parametrize("name", MATERIALS)
@pytest.mark.parametrize("inside", [False, True])
@pytest.mark.parametrize("cosine", [1.0, 0.5, 0.12, 0.01])
def test_no_surface_sends_more_than_it_gets(name, inside, cosine):
    found = albedo(MATERIALS[name], cosine, inside, 1 << 12)
    assert found.max() <= 1.02
    assert found.min() >= 0


def lam(cosine, alpha):
    """Smith's Lambda of GGX, as Heitz (2014) writes it."""
    return 0.5 * (np.sqrt(1 + alpha**2 * (1 - cosine**2) / cosine**2) - 1)


@cache
def single_scattering(cosine, alpha, eta):
    """Mirrored and transmitted light of one meeting with facets, by an integral over facets.

    An integral over normals in slope space of visible facets: independent of the sampling.
    """
    radius = (np.arange(500) + 0.5) / 500
    turn = math.pi * (np.arange(120) + 0.5) / 120
    share, around = np.meshgrid(radius, turn, indexing="ij")
    tangent = alpha * np.sqrt(share / (1 - share))
    z = 1 / np.sqrt(1 + tangent**2)
    h = np.stack([tangent * z * np.cos(around), tangent * z * np.sin(around), z])
    v = np.array([math.sqrt(1 - cosine**2), 0, cosine])
    vh = np.maximum(np.tensordot(v, h, 1), 0)
    # D dh is d(share) d(turn) / (2 pi) / z: the projected area of facets is evenly distributed.
    visible = vh / z / (cosine * (1 + lam(cosine, alpha)))
    sine = (1 - vh**2) / eta**2
    sunk = np.sqrt(np.maximum(1 - sine, 0))
    along = (eta * vh - sunk) / (eta * vh + sunk + 1e-30)
    across = (vh - eta * sunk) / (vh + eta * sunk + 1e-30)
    mirrored = np.where(sine >= 1, 1.0, 0.5 * (along**2 + across**2))
    up = 2 * vh * z - cosine
    ok = up > 1e-9
    both = (1 + lam(cosine, alpha)) / (1 + lam(cosine, alpha) + lam(np.where(ok, up, 1), alpha))
    down = -(vh / eta - sunk) * z + cosine / eta
    through = down > 1e-9
    one = 1 / (1 + lam(np.where(through, down, 1), alpha))
    white = (visible * np.where(ok, both, 0)).mean()
    first = (visible * mirrored * np.where(ok, both, 0)).mean()
    second = (visible * (1 - mirrored) * np.where(through, one, 0)).mean()
    return white, first, second


@pytest.mark.parametrize("roughness", [0.3, 0.6, 1.0])
@pytest.mark.parametrize("cosine", [1.0, 0.5, 0.2])
@pytest.mark.parametrize(("ior", "inside"), [(1.5, False), (1.5, True), (2.4, False)])
def test_rough_glass_is_single_scattering(roughness, cosine, ior, inside):
    """Glass loses the light that meets two facets; that much, and no more."""
    eta = 1 / ior if inside else ior
    _, mirrored, through = single_scattering(cosine, roughness**2, eta)
    found = samples(rough_glass(roughness, ior), cosine, inside)
    weight = np.asarray(found.weight, float)[:, 0]
    passed = np.asarray(found.transmitted)
    assert (weight * ~passed).mean() == pytest.approx(mirrored, abs=0.012)
    assert (weight * passed).mean() == pytest.approx(through, abs=0.012)


@pytest.mark.parametrize("roughness", [0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 1.0])
def test_the_fitted_losses_are_those_of_the_integral(roughness):
    alpha = roughness**2
    for cosine in (0.1, 0.2, 0.35, 0.5, 0.7, 0.9, 1.0):
        white, _, _ = single_scattering(cosine, alpha, 1.5)
        assert microfacets.white_loss(cosine, alpha) == pytest.approx(1 - white, abs=0.007)
        for ior in (1.33, 1.5, 2.0, 2.5):
            _, mirrored, _ = single_scattering(cosine, alpha, ior)
            found = microfacets.coat_reflectance(cosine, alpha, ior)
            assert found == pytest.approx(mirrored, abs=0.011)


@pytest.mark.parametrize("roughness", [0.0, 0.2, 0.5, 0.8, 1.0])
def test_the_fitted_means_are_the_means(roughness):
    cosines = ((np.arange(500) + 0.5) / 500).astype(np.float32)
    alpha = roughness**2
    loss = np.asarray(microfacets.white_loss(cosines, alpha), float)
    assert microfacets.mean_white_loss(alpha) == pytest.approx(
        (loss * 2 * cosines).mean(), abs=0.002
    )
    for ior in (1.1, 1.5, 2.0, 2.9):
        coat = np.asarray(microfacets.coat_reflectance(cosines, alpha, ior), float)
        mean = (coat * 2 * cosines).mean()
        found = microfacets.mean_coat_reflectance(alpha, ior)
        assert found == pytest.approx(mean, abs=0.0025)
        # Both ways through the surface pass the same light: etendue.
        assert 1 - microfacets.mean_coat_reflectance(alpha, 1 / ior) == pytest.approx(
            (1 - found) / ior**2, abs=1e-4
        )


def test_the_mean_of_a_metals_fresnel_is_its_mean():
    cosines = (np.arange(2000) + 0.5) / 2000
    color = np.array([0.9, 0.5, 0.02])
    values = np.array(material.fresnel_metal(cosines.astype(np.float32), (0.9, 0.5, 0.02)), float)
    mean = (values * 2 * cosines[:, None]).mean(0)
    assert np.asarray(microfacets.mean_fresnel_metal(tuple(color))) == pytest.approx(mean, rel=1e-4)


@pytest.mark.parametrize("alpha", [0.1, 0.5, 1.0])
def test_light_that_is_passed_on_is_a_sum_over_facets(alpha):
    """After the first facet each further one reflects r; the share 1 - l of that leaves."""
    lost = microfacets.mean_white_loss(alpha)
    r = np.array([1.0, 0.7, 0.2])
    total = sum(r ** (2 + k) * lost**k * (1 - lost) for k in range(400))
    assert np.asarray(microfacets.passed_on(tuple(r), alpha)) == pytest.approx(total, rel=1e-4)


@pytest.mark.parametrize("roughness", [0.5, 1.0])
@pytest.mark.parametrize("cosine", [1.0, 0.4])
def test_colored_metal_sends_what_the_formulas_say(roughness, cosine):
    """One facet by Schlick's formula, and Kulla and Conty's sum of the rest."""
    alpha = roughness**2
    color = np.array([0.9, 0.5, 0.1])
    white, _, _ = single_scattering(cosine, alpha, 1.5)
    lights = directions_of(grid(256) * [0.5, 1.0] + [0.5, 0.0]).astype(float)
    v = np.array([math.sqrt(1 - cosine**2), 0, cosine])
    h = (lights + v) / np.linalg.norm(lights + v, axis=1)[:, None]
    up = lights[:, 2]
    facets = alpha**2 / (math.pi * (h[:, 2] ** 2 * (alpha**2 - 1) + 1) ** 2)
    both = 1 / (1 + lam(cosine, alpha) + lam(up, alpha))
    schlick = color + (1 - color) * (1 - (h @ v)[:, None]) ** 5
    single = (schlick * (facets * both / (4 * cosine))[:, None]).mean(0) * 2 * math.pi
    lost = microfacets.mean_white_loss(alpha)
    mean = (20 * color + 1) / 21
    rest = mean**2 * (1 - lost) / (1 - mean * lost) * (1 - white)
    found = albedo(material.metal(vec3(*color), roughness), cosine)
    assert found == pytest.approx(single + rest, abs=0.01)


# ------------------------------------------------------------------ density and value


def within_cells(name, cosine, inside, rows=24, columns=16, fine=32):
    surface = MATERIALS[name]
    view = seen_at(cosine)
    found = samples(surface, cosine, inside, 1 << 16)
    smooth = np.asarray(found.specular)
    lost = (np.asarray(found.density) <= 0) & ~smooth
    kept = ~lost & ~smooth
    places = places_of(np.asarray(found.direction)[kept])

    def density(d):
        return respond(surface, view, d, inside).density

    expected = expected_in_cells(density, rows, columns, fine)
    counts = counted(places, rows, columns)
    return counts, expected, len(lost), int(lost.sum()), int(smooth.sum())


@pytest.mark.parametrize("inside", [False, True])
@pytest.mark.parametrize("cosine", [0.95, 0.4])
@pytest.mark.parametrize("name", SPREAD)
def test_samples_are_as_dense_as_the_density(name, cosine, inside):
    counts, expected, total, lost, smooth = within_cells(name, cosine, inside)
    # Directions on the wrong side of the surface are lost; their density is not integrated.
    everything = expected.sum() + (lost + smooth) / total
    assert everything == pytest.approx(1, abs=0.006)
    if counts.sum() > 0:  # else all light is mirrored: the coat lets nothing pass at this angle
        assert deviation(counts, expected / expected.sum() * counts.sum()) < SURPRISING


@pytest.mark.parametrize("inside", [False, True])
@pytest.mark.parametrize("cosine", [0.95, 0.4, 0.05])
@pytest.mark.parametrize("name", SPREAD)
def test_the_weight_is_value_by_density(name, cosine, inside):
    surface = MATERIALS[name]
    found = samples(surface, cosine, inside, 1 << 10)
    density = np.asarray(found.density)
    weight = np.asarray(found.weight)
    kept = density > 0
    again = respond(surface, seen_at(cosine), np.asarray(found.direction)[kept], inside)
    assert np.asarray(again.density) == pytest.approx(density[kept], rel=2e-3, abs=1e-5)
    value = weight[kept] * density[kept][:, None]
    assert np.asarray(again.value) == pytest.approx(value, rel=2e-3, abs=1e-5)


@pytest.mark.parametrize("name", SPREAD)
@pytest.mark.parametrize("inside", [False, True])
def test_the_integral_of_the_value_is_the_mean_weight(name, inside):
    """Two estimates of what a surface sends back: by samples, and by all directions."""
    surface = MATERIALS[name]
    view = seen_at(0.6)

    def value(d):
        return np.asarray(respond(surface, view, d, inside).value)[:, 1]

    whole = expected_in_cells(value, 24, 16, 24).sum()
    found = samples(surface, 0.6, inside)
    spread = np.where(np.asarray(found.specular), 0, np.asarray(found.weight, float)[:, 1])
    assert whole == pytest.approx(spread.mean(), abs=0.006)


@pytest.mark.parametrize("name", SPREAD)
def test_light_goes_both_ways(name):
    """f(v, l) / n_l^2 = f(l, v) / n_v^2, with the index on each side (Veach 1997, 5.14)."""
    surface = MATERIALS[name]
    rng = np.random.default_rng(8)
    pairs = [directions_of(rng.random((2, 2))) for _ in range(60)]
    compared = 0
    for a, b in pairs:
        a, b = (tuple(float(x) for x in v) for v in (a, b))
        if abs(a[2]) < 0.02 or abs(b[2]) < 0.02:
            continue
        values = []
        for view, light in ((a, b), (b, a)):
            inside = view[2] < 0
            n = (0.0, 0.0, -1.0 if inside else 1.0)
            value = np.asarray(scatter.respond(surface, view, light, n, inside).value, float)
            index = surface.ior if light[2] < 0 else 1.0
            values.append(value / abs(light[2]) / index**2)
        assert values[0] == pytest.approx(values[1], rel=5e-3, abs=2e-5)
        compared += values[0].max() > 1e-4
    assert compared >= 10


# ------------------------------------------------------------------ closed forms


def test_a_matte_surface_is_the_color_by_pi():
    light = seen_at(0.7, 2.0)
    found = respond(MATERIALS["matte"], seen_at(0.3), light)
    expected = np.array([0.8, 0.5, 0.2]) * 0.7 / math.pi
    assert np.asarray(found.value) == pytest.approx(expected, rel=1e-5)
    assert found.density == pytest.approx(0.7 / math.pi, rel=1e-5)


def test_smooth_plastic_is_the_published_formula():
    """Color by pi, times what passes the coat both ways, by its mean from the outside."""
    surface = material.plastic(vec3(0.6), 0.0)
    passed = [1 - material.fresnel_dielectric(c, 1.5) for c in (0.3, 0.7)]
    mean = 1 - 0.0918  # of light from everywhere onto n = 1.5 (Egan and Hilgeman 1973)
    found = respond(surface, seen_at(0.3), seen_at(0.7, 2.0))
    assert found.value[0] == pytest.approx(
        0.6 * 0.7 / math.pi * passed[0] * passed[1] / mean, rel=5e-3
    )


def test_a_mirror_mirrors():
    found = samples(material.mirror(vec3(0.5, 0.7, 0.9)), 0.6, count=16)
    x, y, z = seen_at(0.6)
    assert np.asarray(found.direction) == pytest.approx(np.tile([-x, -y, z], (16, 1)), abs=1e-6)
    assert np.asarray(found.weight) == pytest.approx(np.tile([0.5, 0.7, 0.9], (16, 1)), abs=1e-6)
    assert np.asarray(found.specular).all()
    assert not np.asarray(found.density).any()


@pytest.mark.parametrize("inside", [False, True])
def test_smooth_glass_splits_by_fresnel_and_bends_by_snell(inside):
    eta = 1 / 1.5 if inside else 1.5
    found = samples(material.glass(), 0.9, inside, 1 << 14)
    passed = np.asarray(found.transmitted)
    assert 1 - passed.mean() == pytest.approx(material.fresnel_dielectric(0.9, eta), abs=0.01)
    directions = np.asarray(found.direction, float)[passed]
    x, y, _ = seen_at(0.9)
    assert directions[:, 0] == pytest.approx(-x / eta, abs=1e-6)
    assert directions[:, 1] == pytest.approx(-y / eta, abs=1e-6)
    assert (directions[:, 2] < 0).all()


def test_beyond_the_critical_angle_nothing_passes():
    found = samples(material.glass(), 0.5, True, 256)
    assert not np.asarray(found.transmitted).any()
    assert np.asarray(found.weight) == pytest.approx(1.0)


def test_index_one_lets_light_go_straight_on():
    for roughness in (0.0, 0.5, 1.0):
        found = samples(rough_glass(roughness, 1.0), 0.4, count=64)
        straight = -np.array(seen_at(0.4))
        assert np.asarray(found.direction) == pytest.approx(np.tile(straight, (64, 1)), abs=2e-6)
        assert np.asarray(found.transmitted).all()
        assert np.asarray(found.weight) == pytest.approx(1.0)


def test_a_rough_mirror_becomes_a_smooth_one():
    found = samples(material.metal(vec3(0.9), 0.011), 0.6, count=1 << 10)
    x, y, z = seen_at(0.6)
    off = np.linalg.norm(np.asarray(found.direction) - np.array([-x, -y, z]), axis=1)
    assert np.median(off) < 1e-3
    assert not np.asarray(found.specular).any()
    assert np.asarray(found.weight).mean(0) == pytest.approx((0.9, 0.9, 0.9), abs=0.01)


def test_weights_without_fresnel_are_the_probabilities():
    surface = Surface(vec3(1.0), 0.05, 0.1, 0.85, 1.4)
    found = samples(surface, 0.8, count=1 << 14)
    passed = np.asarray(found.transmitted)
    mirrored = ~passed & np.asarray(found.specular)
    assert passed.mean() == pytest.approx(0.85, abs=0.01)
    assert mirrored.mean() == pytest.approx(0.1, abs=0.01)
    assert np.asarray(found.weight) == pytest.approx(1.0, abs=1e-4)


def test_only_smooth_surfaces_without_scattering_need_no_lights():
    alone = {name for name, surface in MATERIALS.items() if scatter.all_specular(surface)}
    assert alone == {"mirror", "glass", "emissive", "black"}


def test_light_is_emitted_to_the_outside():
    surface = material.emissive(vec3(1.0, 0.5, 0.0), 4.0)
    assert tuple(scatter.emitted(surface, False)) == (4.0, 2.0, 0.0)
    assert tuple(scatter.emitted(surface, True)) == (0.0, 0.0, 0.0)


# ------------------------------------------------------------------ any input


def finite(found):
    names = [n for n in ("direction", "weight", "value", "density") if hasattr(found, n)]
    return all(np.isfinite(np.asarray(getattr(found, n))).all() for n in names)


EXTREME = {
    "index near 0": rough_glass(0.3, 1e-3),
    "index 100": rough_glass(0.3, 100.0),
    "index near 1": rough_glass(0.3, 1.0 + 1e-6),
    "coat of index 1": material.plastic(vec3(1.0), 0.5, 1.0),
    "coat of index 0.5": material.plastic(vec3(1.0), 0.5, 0.5),
    "just rough": material.metal(vec3(1.0), 0.0101),
    "just rough glass": rough_glass(0.0101),
    "too rough": material.metal(vec3(1.0), 2.0),
}


@pytest.mark.parametrize("name", [*MATERIALS, *EXTREME])
def test_numbers_are_finite_at_every_edge(name):
    surface = (MATERIALS | EXTREME)[name]
    edge = [0.0, 1e-7, 0.5, 0.99999994]
    u = np.array(np.meshgrid(edge, edge, edge)).reshape(3, -1).T.astype(np.float32)
    lights = np.array(
        [(0, 0, 1), (0, 0, -1), (1, 0, 0), (-1, 0, 0), (0.6, 0, 0.8), (-0.6, 0, -0.8),
         (1, 0, 1e-7), (1, 0, -1e-7)],
        np.float32,
    )  # fmt: skip
    for cosine in (1.0, 1e-3, 0.0, -0.1):
        for inside in (False, True):
            found = scatter.sample(surface, seen_at(cosine, 0.0), UP, inside, u)
            assert finite(found), (cosine, inside)
            assert np.asarray(found.weight).min() >= 0
            assert np.linalg.norm(np.asarray(found.direction), axis=1) == pytest.approx(1, abs=1e-5)
            answer = respond(surface, seen_at(cosine, 0.0), lights, inside)
            assert finite(answer)
            assert np.asarray(answer.value).min() >= 0
            assert np.asarray(answer.density).min() >= 0


def test_every_normal_gives_the_same():
    surface = MATERIALS["everything"]
    view, light = np.array(seen_at(0.5)), np.array(seen_at(0.3, 2.5))
    turn, _ = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))
    here = np.asarray(respond(surface, tuple(view), tuple(light)).value, float)
    there = scatter.respond(
        surface, tuple(turn @ view), tuple(turn @ light), tuple(turn @ np.array(UP)), False
    )
    assert np.asarray(there.value) == pytest.approx(here, rel=1e-4)
