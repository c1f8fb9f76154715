"""Tubes, minimal surfaces, volumes, terrain and fractals against what is known of them."""

from __future__ import annotations

import numpy as np
import pytest

from distal.fields.solids import coils, fractals, heightfield, lattices, tpms, tubes, volumes
from distal.lang import Buffer, Texture2D, Texture3D, func, vec2, vec3
from tests.fields.drawing import sample_with
from tests.fields.library import primitives

SURFACES = {
    "Gyroid": (tpms.GYROID_STEEPEST, tpms.GYROID_TYPICAL),
    "SchwarzP": (tpms.SCHWARZ_P_STEEPEST, tpms.SCHWARZ_P_TYPICAL),
    "SchwarzD": (tpms.SCHWARZ_D_STEEPEST, tpms.SCHWARZ_D_TYPICAL),
    "Neovius": (tpms.NEOVIUS_STEEPEST, tpms.NEOVIUS_TYPICAL),
    "Lidinoid": (tpms.LIDINOID_STEEPEST, tpms.LIDINOID_TYPICAL),
    "SplitP": (tpms.SPLIT_P_STEEPEST, tpms.SPLIT_P_TYPICAL),
    "IWP": (tpms.IWP_STEEPEST, tpms.IWP_TYPICAL),
    "FischerKochS": (tpms.FISCHER_KOCH_S_STEEPEST, tpms.FISCHER_KOCH_S_TYPICAL),
    "FRD": (tpms.FRD_STEEPEST, tpms.FRD_TYPICAL),
}


@pytest.mark.parametrize("name", SURFACES)
def test_minimal_surfaces_steepness_and_thickness(name):
    steepest, typical = SURFACES[name]
    sample = sample_with(primitives()[name], {"solid": True})
    points = np.random.default_rng(2).uniform(0.0, 1.0, (200000, 3))
    d, g = sample.evaluate(points)
    slope = np.linalg.norm(g, axis=1)
    top = points[np.argsort(-slope)[:200]]
    rng, step = np.random.default_rng(3), 0.02
    for _ in range(60):
        tried = top + rng.normal(size=top.shape) * step
        top = np.where(
            (
                np.linalg.norm(sample.evaluate(tried)[1], axis=1)
                > np.linalg.norm(sample.evaluate(top)[1], axis=1)
            )[:, None],
            tried,
            top,
        )
        step *= 0.9
    found = np.linalg.norm(sample.evaluate(top)[1], axis=1).max()
    assert 0.999 * steepest / typical < found <= steepest / typical * (1 + 1e-9)
    # A thin sheet is on average as thick as it says: its volume over the surface's area, which is
    # the mean gradient of the layer over the layer's nominal thickness, and so 1.
    assert slope[np.abs(d) < 0.002].mean() == pytest.approx(1.0, abs=0.02)


def test_the_diamond_lattice_against_all_bonds_around():
    # The atoms of one kind are a face-centred lattice; each has four bonds, to the corners of a
    # tetrahedron.
    cells = np.array(np.meshgrid(*[range(-2, 3)] * 3)).reshape(3, -1).T
    corners = np.array([(0, 0, 0), (0.5, 0.5, 0), (0.5, 0, 0.5), (0, 0.5, 0.5)])
    start = (cells[:, None] + corners).reshape(-1, 1, 3)
    ends = np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]) / 4
    points = np.random.default_rng(4).uniform(-1.0, 1.0, (200, 1, 1, 3))
    t = np.clip(((points - start) * ends).sum(-1) / (ends**2).sum(-1), 0.0, 1.0)
    away = points - start - t[..., None] * ends
    wanted = np.linalg.norm(away, axis=-1).min(axis=(1, 2))
    found = lattices.diamond_lattice(points[:, 0, 0], 1.0, 0.05) + 0.05
    np.testing.assert_allclose(found, wanted, atol=1e-12)
    moved = lattices.diamond_lattice(2.0 * points[:, 0, 0] + (7, 6, 5), 2.0, 0.1) + 0.1
    np.testing.assert_allclose(moved, 2.0 * wanted, atol=1e-9)


@pytest.mark.parametrize(
    ("lattice", "struts"),
    [
        (lattices.cubic_lattice, [((0, 0, 0), (1, 0, 0))]),
        (lattices.bcc_lattice, [((0, 0, 0), (0.5, 0.5, 0.5))]),
        (lattices.fcc_lattice, [((0, 0, 0), (0.5, 0.5, 0))]),
        (
            lattices.kelvin_lattice,
            [((0.5, 0.25, 0), (0.5, 0, 0.25)), ((0.5, 0.25, 0), (0.25, 0.5, 0))],
        ),
        (lattices.octet_lattice, [((0, 0, 0), (0.5, 0.5, 0)), ((0.5, 0, 0.5), (0.5, 0.5, 0))]),
    ],
)
def test_lattices_against_all_struts_around(lattice, struts):
    turns = [
        np.array(m)
        for m in (
            np.diag(s)[list(o)]
            for o in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (1, 0, 2), (0, 2, 1), (2, 1, 0))
            for s in np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T
        )
    ]
    cells = np.array(np.meshgrid(*[(-1, 0, 1)] * 3)).reshape(3, -1).T
    ends = np.array([[m @ a, m @ b] for a, b in np.array(struts, float) for m in turns])
    ends = (ends[:, None] + cells[None, :, None]).reshape(-1, 2, 3)
    points = np.random.default_rng(4).uniform(-0.5, 0.5, (200, 3))
    start, along = ends[:, 0], ends[:, 1] - ends[:, 0]
    from_start = points[:, None] - start
    t = np.clip((from_start * along).sum(2) / (along * along).sum(1), 0.0, 1.0)
    wanted = np.linalg.norm(from_start - t[..., None] * along, axis=2).min(axis=1)
    np.testing.assert_allclose(lattice(points, 1.0, 0.05) + 0.05, wanted, atol=1e-12)
    np.testing.assert_allclose(lattice(2.0 * points + 6.0, 2.0, 0.1) + 0.1, 2.0 * wanted, atol=1e-9)


def test_tapered_tubes_follow_their_curves():
    a, b, c, d = np.array([(-0.5, -0.3, 0.0), (-0.3, 0.7, 0.3), (0.3, -0.7, 0.3), (0.5, -0.3, 0.0)])
    t = np.linspace(0.0, 1.0, 400)[:, None]
    cubic = (1 - t) ** 3 * a + 3 * t * (1 - t) ** 2 * b + 3 * t**2 * (1 - t) * c + t**3 * d
    # A chord leaves its arc by at most an eighth of the second derivative, times its time squared.
    middle = -0.12 + 0.06 * t[:, 0]
    bend = 6.0 * ((1 - t) * (a - 2 * b + c) + t * (b - 2 * c + d))
    leaves = np.linalg.norm(bend, axis=1).max() / (8.0 * 16**2)
    np.testing.assert_allclose(tubes.cubic_bezier_tube(cubic), middle, rtol=0.0, atol=leaves)
    quadratic = (1 - t) ** 2 * a + 2 * t * (1 - t) * b + t**2 * d
    found = tubes.tapered_bezier_tube(quadratic, a, b, d, 0.12, 0.06)
    leaves = 2.0 * np.linalg.norm(a - 2 * b + d) / (8.0 * 16**2)
    np.testing.assert_allclose(found, middle, rtol=0.0, atol=leaves)
    thin = tubes.bezier_tube(quadratic, a, b, d, 0.1)
    np.testing.assert_allclose(thin, -0.1, rtol=0.0, atol=1e-7)


def test_a_coil_is_around_its_helix():
    t = np.linspace(-9.0, 9.0, 500)
    line = np.stack([0.5 * np.cos(t), 0.4 * t / (2 * np.pi), 0.5 * np.sin(t)], axis=1)
    np.testing.assert_allclose(
        coils.coil(line, 0.5, 0.1, 0.4), -0.1 / coils.coil_steepest(0.5, 0.4), atol=1e-9
    )
    assert coils.coil_steepest(0.5, 0.4) == pytest.approx(1.0, abs=0.01)


def test_metaballs_do_not_mind_their_order():
    balls = np.random.default_rng(6).uniform(-0.6, 0.6, (7, 4)).astype(np.float32).astype(float)
    balls[:, 3] = np.abs(balls[:, 3])
    points = np.random.default_rng(7).uniform(-2.0, 2.0, (500, 3))
    row = primitives()["Metaballs"]
    found = [
        sample_with(row, {"balls": list(map(tuple, b))}).evaluate(points)[0]
        for b in (balls, balls[::-1], balls[[3, 1, 0, 6, 2, 5, 4]])
    ]
    np.testing.assert_allclose(found[0], found[1], atol=1e-12)
    np.testing.assert_allclose(found[0], found[2], atol=1e-12)
    away = np.linalg.norm(points[:, None] - balls[:, :3], axis=2) - balls[:, 3]
    np.testing.assert_allclose(
        found[0], -0.1 * np.log2(np.exp2(-away / 0.1).sum(axis=1)), atol=1e-12
    )


COUNT = 16
MIDDLES = (np.arange(COUNT) + 0.5) / COUNT * 2.0 - 1.0
Z, Y, X = np.meshgrid(MIDDLES, MIDDLES, MIDDLES, indexing="ij")
BALL = Texture3D(np.sqrt(X**2 + (Y - 0.1) ** 2 + Z**2) - 0.6, wrap="clamp")
WIDE = Texture3D(np.abs(X) - 5.0, wrap="clamp")
HILLS = 0.3 * np.sin(MIDDLES * 3.0)[None, :] + 0.2 * np.sin(MIDDLES * 2.0)[:, None]
GROUND = Texture2D(HILLS, wrap="clamp")


@func
def stored_ball(p: vec3) -> float:
    return volumes.volume_field(p, BALL, vec3(2.0))


@func
def stored_block(p: vec3) -> float:
    return volumes.volume_field(p, WIDE, vec3(2.0))


@func
def ground(p: vec3) -> float:
    return heightfield.heightfield(p, GROUND, vec2(2.0), 1.0, vec2(0.0))


def test_a_stored_ball_is_a_ball():
    points = np.random.default_rng(8).uniform(-1.0, 1.0, (5000, 3))
    points = points[(np.abs(points) < MIDDLES[-1]).all(axis=1)]
    true = np.linalg.norm(points - [0.0, 0.1, 0.0], axis=1) - 0.6
    spacing = 2.0 / COUNT
    assert np.abs(stored_ball(points) - true).max() < 0.87 * spacing
    # Where the distance has a second derivative, 2 / radius, an eighth of that times the square.
    smooth = true > -0.4
    bend = 2.0 / (true[smooth] + 0.6 - spacing)
    assert (np.abs(stored_ball(points) - true)[smooth] < 0.125 * spacing**2 * bend).all()
    # Outside the box a lower bound, by the right angle at its edge.
    far = np.random.default_rng(9).normal(size=(5000, 3)) * 4.0
    far = far[(np.abs(far) > 1.0).any(axis=1)]
    true = np.linalg.norm(far - [0.0, 0.1, 0.0], axis=1) - 0.6
    value = stored_ball(far)
    assert (value <= true + 0.125 * spacing**2 * 4.0).all()
    assert (value >= 0.6 * true).all()


def test_what_goes_on_beyond_the_box_is_cut():
    points = np.random.default_rng(10).normal(size=(3000, 3)) * 1.5
    past = np.abs(points) - 1.0
    wanted = np.linalg.norm(np.maximum(past, 0.0), axis=1) + np.minimum(past.max(axis=1), 0.0)
    np.testing.assert_allclose(stored_block(points), wanted, atol=1e-6)


def test_terrain_lies_as_the_image_is_seen_from_above():
    x, z = np.meshgrid(MIDDLES, MIDDLES)
    # The first row of an array is the upper side, and lies farthest from the viewer.
    points = np.stack([x.ravel(), np.zeros(x.size), z.ravel()], axis=1)
    rows = ground(points).reshape(COUNT, COUNT)
    np.testing.assert_allclose(-rows, HILLS, atol=1e-6)
    np.testing.assert_allclose(
        ground(points + np.array([0.0, 2.5, 0.0])) - rows.ravel(), 2.5, atol=1e-6
    )


def test_relief_is_the_height_of_a_flat_field():
    p = np.random.default_rng(11).normal(size=(50, 3))
    found = heightfield.relief_value(p[:, 0], p, 0.75)
    np.testing.assert_allclose(found, (p[:, 1] - p[:, 0]) * 0.8, atol=1e-12)


def test_thickness_follows_the_other_shape():
    a = np.array([0.3, -0.3, 0.3, 0.3])
    b = np.array([-5.0, 0.0, 0.5, 9.0])
    found = tpms.graded(a, b, 0.1, 0.3, 1.0)
    np.testing.assert_allclose(found, [0.25, 0.25, 0.2, 0.15], atol=1e-12)


def test_the_sponge_loses_seven_of_27_parts_each_time():
    points = np.random.default_rng(12).uniform(-0.5, 0.5, (200000, 3))
    for times in (1, 2, 3):
        solid = (fractals.menger_sponge(points, 1.0, times) < 0.0).mean()
        assert solid == pytest.approx((20.0 / 27.0) ** times, abs=0.004)


@pytest.mark.parametrize(
    ("name", "numbers"),
    [
        ("Mandelbulb", {}),
        ("Mandelbulb", {"power": 3}),
        ("QuaternionJulia", {}),
        ("QuaternionJulia", {"c": (-1.0, 0.2, 0.0, 0.0)}),
        ("Mandelbox", {}),
        ("Mandelbox", {"fold_scale": -1.5}),
    ],
)
def test_a_marcher_hardly_ever_steps_through_a_fractal(name, numbers):
    sample = sample_with(primitives()[name], numbers)
    slope, low, high, _, _ = sample.promise()
    rng = np.random.default_rng(13)
    reach = float(np.max(high - low))
    towards = rng.uniform(low, high, (4000, 3))
    way = rng.normal(size=(4000, 3))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    points = towards - reach * way
    through = steps = 0
    for _ in range(40):
        d = sample.evaluate(points)[0]
        assert np.isfinite(d).all()
        step = np.where(d > 1e-3 * reach, d / slope, 0.0)[:, None]
        for part in (0.25, 0.5, 0.75, 1.0):
            inside = sample.evaluate(points + part * step * way)[0] < -1e-4 * reach
            through += int((inside & (step[:, 0] > 0.0)).sum())
        steps += int((step > 0.0).sum())
        points = points + step * way
    assert steps > 10000
    assert through <= 1e-4 * steps


def test_data_is_bound_when_a_tube_is_asked():
    row = primitives()["PolylineTube"]
    sample = sample_with(row, {"points": [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0)]})
    assert isinstance(sample.choices["points"], Buffer)
    points = np.array([(0.5, 0.0, 0.3), (1.0, 0.5, -0.2), (0.0, 1.0, 0.0)])
    np.testing.assert_allclose(sample.evaluate(points)[0] + 0.1, [0.3, 0.2, 1.0], atol=1e-12)
