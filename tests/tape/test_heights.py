"""Heights and normals: the first sample along each ray whose value is negative."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from distal.devices.base import Cancelled
from distal.devices.features import host_levels
from distal.tape.runtime import MOST_LAYERS, TapeProgram, VolumeView
from distal.tape.tape import Tape, TapeBuilder
from tests.tape.random_tapes import bits, tapes

F = np.float32
LEVELS = pytest.mark.parametrize("level", host_levels(), ids=lambda level: level.name)


def front_view(size: tuple[int, int, int], half: float = 1.0) -> VolumeView:
    """From +z onto a cube around the origin; heights are z."""
    width, height, depth = (2.0 * half / n for n in size)
    return VolumeView(
        (-half, half, half), (width, 0, 0), (0, -height, 0), (0, 0, -depth), half, -depth
    )


def slanted(size: tuple[int, int, int], scale: float = 1.0) -> VolumeView:
    """Along no axis; heights are numbers of layers."""
    turn = np.array([(0.8, -0.36, 0.48), (0.0, 0.8, 0.6), (-0.6, -0.48, 0.64)]) * 2.0 * scale
    column, row, layer = (turn[:, i] / n for i, n in enumerate(size))
    return VolumeView(-turn.sum(axis=1) / 2.0, column, row, layer)


def sample_points(size: tuple[int, int, int], view: VolumeView) -> np.ndarray:
    """The samples as the runtime computes them: (layers, rows, columns, 3), in 32 bits."""
    with np.errstate(all="ignore"):
        column, row, layer = (np.arange(n, dtype=F) + F(0.5) for n in size)
        point = [
            F(view.corner[axis])
            + column[None, None, :] * F(view.column[axis])
            + row[None, :, None] * F(view.row[axis])
            + layer[:, None, None] * F(view.layer[axis])
            for axis in range(3)
        ]
    return np.stack(point, axis=-1)


def expected(
    program: TapeProgram, size: tuple[int, int, int], view: VolumeView
) -> tuple[np.ndarray, np.ndarray]:
    """Layers (-1: nothing) by looking at all samples, and the picture, by the unpruned tape."""
    points = sample_points(size, view)
    inside = program.values(points.reshape(-1, 3)).reshape(points.shape[:3]) < 0
    layers = np.where(inside.any(axis=0), inside.argmax(axis=0), -1)
    rows, columns = np.nonzero(layers >= 0)
    hits = layers[rows, columns]
    picture = np.zeros((size[1], size[0], 4), F)
    picture[..., 3] = np.nan
    with np.errstate(all="ignore"):
        found = program.gradients(points[hits, rows, columns])
        slope = found[:, 1:]
        largest = np.abs(slope).max(axis=1, initial=0.0)
        parts = slope / largest[:, None]
        root = np.sqrt(parts[:, 0] ** 2 + parts[:, 1] ** 2 + parts[:, 2] ** 2)
        normal = np.where(root[:, None] > 0, parts / root[:, None], F(0))
        along = slope[:, 0] * F(view.layer[0])
        for axis in (1, 2):
            along = along + slope[:, axis] * F(view.layer[axis])
        place = hits.astype(F) + F(0.5)
        before = np.maximum(place - F(1), F(0))
        crossing = place - found[:, 0] / along
        crossing = np.where(crossing > before, crossing, before)
        crossing = np.where(along < 0, crossing, place - F(0.5))
    picture[rows, columns, :3] = normal
    picture[rows, columns, 3] = F(view.front) + crossing * F(view.step)
    return layers, picture


@LEVELS
def test_random_tapes_give_the_same_bits_as_all_samples(level):
    @settings(max_examples=30)
    @given(
        tape=tapes(),
        size=st.sampled_from([(21, 7, 70), (66, 5, 17), (5, 70, 9), (3, 2, 140), (1, 1, 1)]),
        scale=st.sampled_from([1.0, 5.0, 1e-3, 1e18, 3e37]),
        turned=st.booleans(),
    )
    def check(tape, size, scale, turned) -> None:
        program = TapeProgram(tape, level)
        view = slanted(size, scale) if turned else front_view(size, scale)
        found = program.heights(size, view, threads=1)
        _, picture = expected(program, size, view)
        assert (bits(found) == bits(picture)).all()

    check()


def union(spheres: list[tuple[float, float, float, float]]) -> Tape:
    """A union of spheres: centers and radii."""
    builder = TapeBuilder()
    axes = [builder.operation(axis) for axis in "xyz"]
    parts = None
    for *center, radius in spheres:
        offsets = [
            builder.operation("sub", axis, builder.constant(c))
            for axis, c in zip(axes, center, strict=True)
        ]
        x, y, z = (builder.operation("square", offset) for offset in offsets)
        total = builder.operation("add", builder.operation("add", x, y), z)
        length = builder.operation("sqrt", total)
        sphere = builder.operation("sub", length, builder.constant(radius))
        parts = sphere if parts is None else builder.operation("min", parts, sphere)
    return builder.tape(parts)


def cloud(count: int, seed: int = 3) -> Tape:
    rng = np.random.default_rng(seed)
    rows = np.concatenate(
        [rng.uniform(-0.8, 0.8, (count, 3)), rng.uniform(0.03, 0.2, (count, 1))], 1
    )
    return union([tuple(row) for row in rows.tolist()])


@LEVELS
@pytest.mark.parametrize("turned", [False, True], ids=["axis", "slanted"])
def test_many_spheres_at_an_odd_size(level, turned):
    size = (131, 97, 150)
    program = TapeProgram(cloud(60), level)
    view = slanted(size) if turned else front_view(size)
    layers, picture = expected(program, size, view)
    assert 0.1 < (layers >= 0).mean() < 0.95
    found = program.heights(size, view)
    assert (bits(found) == bits(picture)).all()


def test_a_sphere_has_its_heights_and_normals():
    size = (203, 155, 101)
    found = TapeProgram(union([(0.1, -0.2, 0.05, 0.7)])).heights(size, front_view(size))
    x, y = (sample_points(size, front_view(size))[0, ..., i].astype(float) for i in (0, 1))
    rest = 0.7**2 - (x - 0.1) ** 2 - (y + 0.2) ** 2
    surface = 0.05 + np.sqrt(np.maximum(rest, 0.0))
    inner = rest > 0.1
    # One step of Newton's method from at most a layer (0.02): half of its square by the curvature.
    assert np.abs(found[..., 3] - surface)[inner].max() < 0.5 * 0.02**2 * 0.7**2 / 0.1**1.5
    normal = np.stack([x - 0.1, y + 0.2, surface - 0.05], axis=-1) / 0.7
    assert np.abs(found[..., :3] - normal)[inner].max() < 0.02 / 0.7
    assert np.allclose(np.linalg.norm(found[..., :3], axis=-1)[inner], 1.0, atol=1e-6)
    assert np.isnan(found[rest < -0.02][:, 3]).all()
    assert (found[rest < -0.02][:, :3] == 0).all()
    edge = (rest > 0.0) & ~np.isnan(found[..., 3])
    assert np.abs(found[..., 3] - surface)[edge].max() < 0.02 + 1e-6


def _plane(normal: tuple[float, float, float], offset: float) -> Tape:
    builder = TapeBuilder()
    total = builder.constant(-offset)
    for axis, factor in zip("xyz", normal, strict=True):
        product = builder.operation("mul", builder.operation(axis), builder.constant(factor))
        total = builder.operation("add", total, product)
    return builder.tape(total)


def test_a_plane_is_exact_between_samples():
    size = (75, 33, 9)
    found = TapeProgram(_plane((0.2, -0.1, 1.0), 0.1)).heights(size, front_view(size))
    x, y = (sample_points(size, front_view(size))[0, ..., i] for i in (0, 1))
    assert np.abs(found[..., 3] - (0.1 - 0.2 * x + 0.1 * y)).max() < 1e-6
    normal = np.array([0.2, -0.1, 1.0]) / math.sqrt(1.05)
    assert np.abs(found[..., :3] - normal).max() < 1e-6


def _box(half: tuple[float, float, float]) -> Tape:
    builder = TapeBuilder()
    total = None
    for axis, extent in zip("xyz", half, strict=True):
        distance = builder.operation("abs", builder.operation(axis))
        side = builder.operation("sub", distance, builder.constant(extent))
        total = side if total is None else builder.operation("max", total, side)
    return builder.tape(total)


def test_a_box_shows_its_top():
    size = (99, 55, 77)
    found = TapeProgram(_box((0.5, 0.25, 0.3))).heights(size, front_view(size))
    x, y = (sample_points(size, front_view(size))[0, ..., i] for i in (0, 1))
    inside = (np.abs(x) < 0.5) & (np.abs(y) < 0.25)
    assert (np.isfinite(found[..., 3]) == inside).all()
    top = inside & (np.abs(x) < 0.45) & (np.abs(y) < 0.2)
    assert np.abs(found[..., 3][top] - 0.3).max() < 1e-6
    assert (found[top][:, :3] == (0, 0, 1)).all()


def test_a_torus_has_a_hole_and_its_closed_form():
    builder = TapeBuilder()
    squares = [builder.operation("square", builder.operation(axis)) for axis in "xyz"]
    ring = builder.operation("sqrt", builder.operation("add", *squares[:2]))
    offset = builder.operation("square", builder.operation("sub", ring, builder.constant(0.6)))
    length = builder.operation("sqrt", builder.operation("add", offset, squares[2]))
    tape = builder.tape(builder.operation("sub", length, builder.constant(0.25)))
    size = (121, 121, 201)
    found = TapeProgram(tape).heights(size, front_view(size))[..., 3]
    x, y = (sample_points(size, front_view(size))[0, ..., i].astype(float) for i in (0, 1))
    rest = 0.25**2 - (np.hypot(x, y) - 0.6) ** 2
    inner = rest > 0.01
    # The surface's second derivative is -0.25^2 / rest^1.5; one layer is 0.01.
    bound = 0.5 * 0.01**2 * 0.25**2 / 0.01**1.5
    assert np.abs(found - np.sqrt(np.maximum(rest, 0)))[inner].max() < bound
    assert np.isnan(found[np.hypot(x, y) < 0.33]).all()
    assert np.isnan(found[rest < -0.01]).all()


@pytest.mark.parametrize("size", [(1, 1, 1), (130, 70, 65), (64, 64, 64)])
def test_full_and_empty(size):
    for number, height in ((-1.0, 1.0), (1.0, math.nan), (0.0, math.nan), (math.nan, math.nan)):
        builder = TapeBuilder()
        program = TapeProgram(builder.tape(builder.constant(number)))
        found = program.heights(size, front_view(size))
        assert (bits(found[..., 3]) == bits(np.array(F(height)))).all()
        assert (found[..., :3] == 0).all()


def test_what_is_nan_is_outside():
    """0 * inf where x^2 overflows; elsewhere z - 0."""
    builder = TapeBuilder()
    big = builder.operation("mul", builder.operation("x"), builder.constant(3e38))
    nothing = builder.operation("mul", builder.operation("square", big), builder.constant(0.0))
    tape = builder.tape(builder.operation("add", builder.operation("z"), nothing))
    program = TapeProgram(tape)
    size = (40, 40, 40)
    view = VolumeView((-1e-19, 1, 1), (1e-20, 0, 0), (0, -0.05, 0), (0, 0, -0.05), 1.0, -0.05)
    values = program.values(sample_points(size, view).reshape(-1, 3)).reshape(40, 40, 40)
    is_nan = np.isnan(values[0])
    assert 0 < is_nan.mean() < 1
    found = program.heights(size, view)[..., 3]
    assert np.isnan(found[is_nan]).all()
    assert np.abs(found[~is_nan]).max() < 1e-6


def test_gradients_are_the_slopes_of_the_values():
    """Central differences of the tape in 64 bits, of one operation of each kind."""
    builder = TapeBuilder()
    x, y, z = (builder.operation(axis) for axis in "xyz")
    total = builder.operation("mul", builder.operation("sin", x), builder.operation("exp", y))
    total = builder.operation("add", total, builder.operation("atan2", z, x))
    total = builder.operation(
        "sub", total, builder.operation("pow", builder.operation("abs", z), y)
    )
    total = builder.operation(
        "div", total, builder.operation("sqrt", builder.operation("add", x, y))
    )
    points = np.random.default_rng(2).uniform(0.3, 1.0, (50, 3)).astype(F)
    found = TapeProgram(builder.tape(total)).gradients(points)

    def value(p: np.ndarray) -> np.ndarray:
        a, b, c = p.astype(float).T
        whole = np.sin(a) * np.exp(b) + np.arctan2(c, a) - np.abs(c) ** b
        return whole / np.sqrt(a + b)

    assert np.abs(found[:, 0] - value(points)).max() < 1e-5
    for axis in range(3):
        step = 1e-5 * np.eye(3)[axis]
        slope = (value(points + step) - value(points - step)) / 2e-5
        assert np.abs(found[:, 1 + axis] - slope).max() < 1e-4


def test_threads_do_not_change_the_heights():
    size = (300, 200, 100)
    program = TapeProgram(cloud(30))
    one = program.heights(size, front_view(size), threads=1).copy()
    for threads in (2, 3):
        found = program.heights(size, front_view(size), threads=threads)
        assert (bits(found) == bits(one)).all()


def test_the_deepest_volume():
    size = (3, 2, MOST_LAYERS)
    program = TapeProgram(_plane((0.0, 0.0, 1.0), -0.9))
    found = program.heights(size, front_view(size))[..., 3]
    assert np.abs(found + 0.9).max() < 1e-6


def test_sizes_are_checked():
    program = TapeProgram(cloud(2))
    view = front_view((4, 4, 4))
    for size in itertools.product((0, 1), repeat=2):
        if size != (1, 1):
            with pytest.raises(ValueError, match="a picture is 1x1 to 32768x32768 pixels"):
                program.heights((*size, 4), view)
    for layers in (0, MOST_LAYERS + 1):
        with pytest.raises(ValueError, match=f"there are 1 to 4096 layers, not {layers}"):
            program.heights((4, 4, layers), view)


def test_cancel_stops():
    size = (4000, 4000, 4000)
    with pytest.raises(Cancelled):
        TapeProgram(cloud(500)).heights(size, front_view(size), cancel=lambda: True)
