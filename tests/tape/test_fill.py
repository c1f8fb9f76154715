"""Filled pictures: every pixel has the color of its sign."""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal.devices.base import Cancelled
from distal.devices.features import host_levels
from distal.tape import runtime
from distal.tape.runtime import PlaneView, TapeProgram
from distal.tape.tape import Tape, TapeBuilder

WHITE, BLACK = (1.0, 1.0, 1.0, 1.0), (0.0, 0.0, 0.0, 1.0)


def rings(count: int = 12) -> Tape:
    """Rings of several centers, many of them crossing."""
    builder = TapeBuilder()
    x, y = builder.operation("x"), builder.operation("y")
    union = None
    for i in range(count):
        angle = 2.4 * i
        center = 0.6 * math.cos(angle), 0.6 * math.sin(angle)
        offsets = [
            builder.operation("sub", axis, builder.constant(c))
            for axis, c in zip((x, y), center, strict=True)
        ]
        squares = [builder.operation("square", offset) for offset in offsets]
        radius = builder.operation("sqrt", builder.operation("add", *squares))
        band = builder.operation("sub", radius, builder.constant(0.1 + 0.02 * i))
        ring = builder.operation("sub", builder.operation("abs", band), builder.constant(0.015))
        union = ring if union is None else builder.operation("min", union, ring)
    return builder.tape(union)


def centered(width: int, height: int, span: float = 2.0) -> PlaneView:
    step = span / height
    return PlaneView(-0.5 * width * step, step, 0.5 * height * step, -step)


def shades(samples: int) -> np.ndarray:
    """Black to white, for each number of samples inside."""
    shares = np.linspace(0.0, 1.0, samples + 1)[:, None]
    return shares * np.array(WHITE) + (1.0 - shares) * np.array(BLACK)


def pixel_centers(width: int, height: int, view: PlaneView) -> np.ndarray:
    """The coordinates, computed as the runtime computes them: product, then sum, in 32 bits."""
    f = np.float32
    x = f(view.x) + (np.arange(width, dtype=f) + f(0.5)) * f(view.step_x)
    y = f(view.y) + (np.arange(height, dtype=f) + f(0.5)) * f(view.step_y)
    return np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)


@pytest.mark.parametrize("level", host_levels(), ids=lambda level: level.name)
@pytest.mark.parametrize("size", [(1, 1), (7, 5), (64, 64), (200, 131), (513, 65)])
def test_every_pixel_has_the_sign_of_the_tape(level, size):
    program = TapeProgram(rings(), level)
    view = centered(*size)
    picture = program.fill(*size, view)
    inside = program.values(pixel_centers(*size, view)).reshape(size[1], size[0]) < 0
    assert (picture == np.where(inside[..., None], WHITE, BLACK)).all()
    assert size == (1, 1) or 0 < inside.mean() < 1


def test_a_long_tape_in_a_small_tile_gets_slots():
    """More than 64 operations that matter in one tile of 8 pixels."""
    builder = TapeBuilder()
    x, y = builder.operation("x"), builder.operation("y")
    total = builder.operation("add", x, y)
    for i in range(60):
        square = builder.operation("square", builder.operation("add", total, x))
        total = builder.operation("sub", square, builder.constant(0.01 * i))
    program = TapeProgram(builder.tape(total))
    view = centered(40, 40)
    picture = program.fill(40, 40, view)
    inside = program.values(pixel_centers(40, 40, view)).reshape(40, 40) < 0
    assert (picture[..., 0] == inside).all()


def test_samples_give_the_covered_area():
    builder = TapeBuilder()
    squares = [builder.operation("square", builder.operation(axis)) for axis in "xy"]
    radius = builder.operation("sqrt", builder.operation("add", *squares))
    disk = builder.operation("sub", radius, builder.constant(0.7))
    program = TapeProgram(builder.tape(disk))
    area = 0.7**2 * math.pi
    found = [
        float(program.fill(100, 100, centered(100, 100), colors=shades(n))[..., 0].mean()) * 4.0
        for n in (1, 16)
    ]
    assert abs(found[1] - area) < 1e-3
    assert abs(found[1] - area) < abs(found[0] - area) + 1e-4
    edges = program.fill(100, 100, centered(100, 100), colors=shades(16))[..., 0]
    assert set((edges * 16).ravel().tolist()) <= set(range(17))
    assert ((edges > 0) & (edges < 1)).any()


def test_each_number_of_samples_has_its_color():
    program = TapeProgram(rings())
    view = centered(90, 60)
    colors = np.random.default_rng(1).uniform(size=(5, 4)).astype(np.float32)
    numbers = (program.fill(90, 60, view, colors=shades(4))[..., 0] * 4).astype(int)
    assert set(numbers.ravel().tolist()) == set(range(5))
    assert (program.fill(90, 60, view, colors=colors) == colors[numbers]).all()


@pytest.fixture
def dirty_memory(monkeypatch):
    """The runtime's memory begins with ones, not with the zeros of new pages."""
    aligned = runtime._aligned

    def filled_memory(size: int) -> np.ndarray:
        memory = aligned(size)
        memory[:] = 255
        return memory

    monkeypatch.setattr(runtime, "_aligned", filled_memory)


def test_nothing_is_read_before_it_is_written(dirty_memory):
    view = centered(300, 300)
    program = TapeProgram(rings())
    inside = program.values(pixel_centers(300, 300, view)).reshape(300, 300) < 0
    assert (program.fill(300, 300, view)[..., 0] == inside).all()


def test_pruned_tapes_refer_to_their_own_values(dirty_memory):
    """Also in fields that are not used: the next level looks them up."""
    builder = TapeBuilder()
    dropped = builder.operation("add", builder.operation("x"), builder.constant(9.0))
    far = builder.operation("abs", builder.operation("y"))
    near = builder.operation("sub", far, builder.constant(0.3))
    program = TapeProgram(builder.tape(builder.operation("min", near, dropped)))
    program.fill(64, 64, centered(64, 64), threads=1)
    offsets = runtime.workspace(len(program.tape), program.slots)[0]
    memory = program._memory
    (length,) = memory[offsets["lengths_0"] :][:8].view(np.int64)
    rows = memory[offsets["tapes_0"] :][: 12 * length].view(np.uint16).reshape(-1, 6)
    assert length == 4
    assert (rows[:, 1] == np.arange(4)).all()
    assert (rows[1:, 2:5].max(axis=1) < rows[1:, 1]).all()


def test_threads_do_not_change_the_picture():
    program = TapeProgram(rings())
    view = centered(1100, 600)
    one = program.fill(1100, 600, view, threads=1).copy()
    assert (program.fill(1100, 600, view, threads=3) == one).all()


def test_z_is_the_same_in_the_whole_picture():
    builder = TapeBuilder()
    x, z = builder.operation("x"), builder.operation("z")
    program = TapeProgram(builder.tape(builder.operation("sub", x, z)))
    view = centered(100, 100)
    moved = PlaneView(view.x, view.step_x, view.y, view.step_y, 0.5)
    assert program.fill(100, 100, view)[0, :, 0].sum() == 50
    assert program.fill(100, 100, moved)[0, :, 0].sum() == 75


def test_a_constant_fills_everything_or_nothing():
    for number, expected in ((-1.0, 1.0), (1.0, 0.0), (0.0, 0.0), (math.nan, 0.0)):
        builder = TapeBuilder()
        program = TapeProgram(builder.tape(builder.constant(number)))
        assert (program.fill(70, 70, centered(70, 70))[..., 0] == expected).all()


def test_what_is_nan_is_outside():
    """0 * inf at the left, where the tape's interval is infinite."""
    builder = TapeBuilder()
    x = builder.operation("x")
    big = builder.operation("mul", x, builder.constant(3e38))
    squared = builder.operation("mul", builder.operation("square", big), builder.constant(0.0))
    tape = builder.tape(builder.operation("sub", squared, builder.constant(1.0)))
    program = TapeProgram(tape)
    view = PlaneView(0.0, 0.02, 1.0, -0.02)
    values = program.values(pixel_centers(100, 100, view)).reshape(100, 100)
    assert np.isnan(values).any() and (values < 0).sum() == 0
    assert (program.fill(100, 100, view)[..., 0] == 0).all()


def test_sizes_and_samples_are_checked():
    program = TapeProgram(rings())
    with pytest.raises(ValueError, match="a picture is 1x1 to 32768x32768 pixels"):
        program.fill(0, 10, centered(10, 10))
    with pytest.raises(ValueError, match="samples of a pixel are a square number, not 3"):
        program.fill(10, 10, centered(10, 10), colors=shades(3))
    with pytest.raises(ValueError, match="threads must be at least 1, not -2"):
        program.fill(10, 10, centered(10, 10), threads=-2)


def test_cancel_stops():
    program = TapeProgram(rings(500))
    with pytest.raises(Cancelled):
        program.fill(4000, 4000, centered(4000, 4000), cancel=lambda: True)
