"""Large tables of literals: quick to compile, the reference's numbers, in any shape they come."""

from __future__ import annotations

import base64
import re
from typing import Any

import numpy as np
import pytest

from distal.backends import emit, get_target
from distal.compiler.driver import run_passes
from distal.devices import gpu as gpu_device
from distal.export.page_programs import PagePrograms
from distal.frontend import lower
from distal.lang import Frame, array, func, image, ivec2, mat2, struct, uint, vec2, vec3, vec4
from distal.scene.viewing.viewable import viewable
from tests import egl, gpu
from tests.glsl import run_glsl
from tests.parity.targets import TARGETS, Unavailable, reference

SIZE = (24, 16)
LENGTH = 1024
SHORT = 100
RANDOM = np.random.default_rng(19)

FLOATS = RANDOM.normal(size=LENGTH).astype(np.float32).tolist()
OTHERS = RANDOM.normal(size=LENGTH).astype(np.float32)
FEW, FURTHER = FLOATS[:SHORT], FLOATS[SHORT : 2 * SHORT]
WHOLE = [2147483647, -2147483648, *range(-50, SHORT - 52)]
UNSIGNED = [uint(4294967295), uint(2147483648), *map(uint, range(100))]
FLAGS = [i % 3 == 0 or i % 7 == 2 for i in range(200)]
PAIRS = [vec2(float(x), float(y)) for x, y in RANDOM.normal(size=(50, 2)).astype(np.float32)]
POINTS = RANDOM.normal(size=(SHORT, 3)).astype(np.float32)
CELLS = [ivec2(i * 7 % 13, -i) for i in range(60)]
TURNS = [mat2(1.0, i / 8.0, -i / 4.0, 2.0) for i in range(40)]
ROWS = RANDOM.normal(size=(9, 32)).astype(np.float32).tolist()


@struct
class Ball:
    center: vec3
    radius: float
    glows: bool
    bounds: array[float, 3]


@struct
class Palette:
    count: int
    colors: array[vec3, 40]


BALLS = [
    Ball(vec3(i / 4.0, -i / 2.0, 1.0), i / 16.0, i % 5 == 0, (0.5, i / 2.0, -1.0))
    for i in range(48)
]
PALETTES = [Palette(k, [vec3(k + i / 8.0, i / 4.0, -k) for i in range(40)]) for k in range(3)]


@func
def place(frame: Frame, by: int) -> int:
    return int(frame.coord.x) * 37 + int(frame.coord.y) * 91 + by


@image
def floats(frame: Frame) -> vec4:
    i = place(frame, 0)
    return vec4(FLOATS[i % LENGTH], OTHERS[i * 7 % LENGTH], FLOATS[i - 300], FLOATS[5])


@image
def whole_numbers(frame: Frame) -> vec4:
    i = place(frame, 0)
    big = UNSIGNED[i % 5] >> 8
    flag = 1.0 if FLAGS[i % 200] else 0.0
    cell = CELLS[i % 60]
    low = float(WHOLE[i % SHORT] & 65535)
    return vec4(low, float(big), flag, float(cell.x * 100 + CELLS[i % 7].y))


@image
def vectors(frame: Frame) -> vec4:
    i = place(frame, 1)
    turn = TURNS[i % 40]
    return vec4(POINTS[i % SHORT][i % 3], turn[i % 2].y, TURNS[i % 7][1].x, PAIRS[i % 50].y)


@image
def rows(frame: Frame) -> vec4:
    i = place(frame, 2)
    row = ROWS[i % 9]
    found = 0.0
    for value in ROWS[i % 9]:
        found = value if value > found else found
    return vec4(row[i % 32], ROWS[i % 9][3], found, row[31])


@image
def structs(frame: Frame) -> vec4:
    i = place(frame, 3)
    ball = BALLS[i % 48]
    colors = PALETTES[i % 3].colors
    i += 7
    glow = 1.0 if ball.glows else 0.25
    inside = ball.bounds[i % 3] + colors[i % 40].x
    return vec4(ball.center.xy, ball.radius * glow, inside)


@func
def total(numbers: array[float, SHORT], start: int) -> float:
    found = 0.0
    for k in range(4):
        found = found * 2.0 + numbers[(start + k * k) % SHORT]
    return found


@func
def twice(numbers: array[float, SHORT], start: int) -> float:
    return total(numbers, start) - total(numbers, start + 1)


@func
def given() -> array[float, SHORT]:
    return FEW


@image
def passed_on(frame: Frame) -> vec4:
    i = place(frame, 4)
    chosen = FEW if i % 2 == 0 else FURTHER
    first = twice(FEW, i)
    return vec4(first, twice(chosen, i), chosen[i % SHORT], given()[i % SHORT])


@image
def once_a_frame(frame: Frame) -> vec4:
    k = int(frame.resolution.x) * 2
    return vec4(FLOATS[k], POINTS[k].x, frame.coord * 0.01)


PICTURES = (floats, whole_numbers, vectors, rows, structs, passed_on)

_IN_BUFFERS = ("glsl-es300", "glsl-330", "wgsl", "wgsl-compute")


@pytest.mark.parametrize("picture", PICTURES, ids=lambda f: f.name)
def test_large_tables_have_the_references_numbers(picture: Any) -> None:
    module = lower(picture)
    expected = reference(module, *SIZE, {})
    assert np.ptp(expected, axis=(0, 1)).any()
    ran = []
    for name in _IN_BUFFERS:
        try:
            found = TARGETS[name](module, *SIZE, {})
        except Unavailable:
            continue
        ran.append(name)
        assert np.array_equal(found, expected), name
    if not ran:
        pytest.skip("no graphics driver")


@pytest.mark.parametrize("name", _IN_BUFFERS)
@pytest.mark.parametrize("picture", (*PICTURES, once_a_frame), ids=lambda f: f.name)
def test_no_text_holds_a_large_array(picture: Any, name: str) -> None:
    target = get_target(name)
    artifact = emit(run_passes(lower(picture), target), target)
    lengths = re.findall(r"array<[^<>]*, (\d+)>|\w\[(\d+)\]\(", artifact.text)
    assert target.largest_table is not None
    assert all(int(a or b) <= target.largest_table for a, b in lengths)
    assert len(artifact.text) < 5000 or picture is not floats
    assert all("values" in entry for entry in artifact.interface["buffers"])
    assert artifact.interface["buffers"]


@pytest.mark.parametrize("name", _IN_BUFFERS)
def test_a_table_is_read_once_a_frame(name: str) -> None:
    target = get_target(name)
    artifact = emit(run_passes(lower(once_a_frame), target), target)
    size = {"resolution": SIZE}
    try:
        run = gpu.run_wgsl if name.startswith("wgsl") else run_glsl
        found = run(artifact, SIZE, size)
    except (gpu.GpuUnavailableError, egl.EglUnavailableError) as error:
        pytest.skip(str(error))
    assert found[0, 0, 0] == np.float32(FLOATS[2 * SIZE[0]])
    assert found[0, 0, 1] == POINTS[2 * SIZE[0]][0]


def test_a_page_carries_the_tables_once() -> None:
    programs = PagePrograms(viewable(floats))
    programs.add("color")
    programs.add("color")
    (program,) = programs.made
    (entry,) = program["buffers"]
    ((name, carried),) = programs.resources.items()
    assert (entry["name"], carried["format"], carried["size"]) == (name, "float32", [2 * LENGTH])
    numbers = np.frombuffer(base64.b64decode(carried["data"]), "<f4")
    assert np.array_equal(numbers, np.concatenate([np.float32(FLOATS), OTHERS]))


@pytest.mark.parametrize("picture", [floats, structs], ids=lambda f: f.name)
def test_the_device_uploads_the_tables(picture: Any) -> None:
    try:
        gpu.device()
    except gpu.GpuUnavailableError as error:
        pytest.skip(str(error))
    module = lower(picture)
    for path in ("compute", "fragment"):
        found = gpu_device.prepare(module, path=path).render(*SIZE, {"resolution": SIZE}, {})
        assert np.array_equal(found, reference(module, *SIZE, {})), path


def test_places_without_buffers_keep_arrays() -> None:
    target = get_target("shadertoy")
    for picture, start in ((floats, f"float[{LENGTH}]("), (structs, "Ball[48](Ball(")):
        artifact = emit(run_passes(lower(picture), target), target)
        assert not artifact.interface["buffers"]
        assert start in artifact.text
