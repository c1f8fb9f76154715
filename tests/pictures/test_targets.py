"""The gallery, at several times: what drivers make of the emitted texts is the CPU's picture.

A sample of the scenes of objects is drawn, once each and at half the size; what they are made of is
drawn by every language in ``tests/parity``. ``make sweep`` sets ``DISTAL_ALL_PICTURES=1`` and draws
each as often and as large as the small examples.
"""

from __future__ import annotations

import os
from functools import cache

import pytest

import distal
from tests.buffer_data import buffers_of, text_of, textures_of
from tests.examples import functions_of_a_pixel
from tests.pictures.comparison import difference

SIZE = (160, 120)
SCENE_SIZE = (80, 60)  # a driver in software takes up to a minute for a scene of SIZE
# At 2.9 a lid of glass is seen at 4 degrees, and moving the camera by 1e-6 changes what it shows.
TIMES = (0.0, 2.5, 11.3)
TARGETS = ("glsl-es300", "wgsl", "wgsl-compute")
ALL = os.environ.get("DISTAL_ALL_PICTURES") == "1"
# NumPy follows all rays of mirrors and glass through all steps: a minute for some of these.
LONG_BY_REFERENCE = (
    "beach",
    "bolt_and_nut",
    "bricks",
    "castle",
    "catalogue",
    "caustics",
    "cornell_box",
    "enclosure",
    "forest",
    "gears",
    "gyroid_part",
    "molecule",
    "prism",
    "ripples",
    "sdfray_csg_on_checker",
    "sdfray_glass",
    "sdfray_refraction",
    "still_life",
    "wine",
)


def is_small(example):
    """Whether an example is a function of a pixel, with little besides."""
    text = distal.gallery()[example].read_text()
    return "Scene(" not in text and "distal.render" not in text


# Mesa's software Vulkan draws 10,000 parts wrong by the fragment stage, only along the diagonal of
# the screen where its two triangles meet; by compute, and by GLSL, they are right.
BY_COMPUTE = ("beach", "forest")
# Every shape in one scene: the driver and the CPU need 40 s for it, a twelfth of all these tests.
# Its shapes and operators are held against the reference one by one in ``tests/fields``.
LONG_BY_DRIVERS = ("catalogue",)


def is_drawn(example, target, time):
    """Whether a picture is among those that are drawn each time."""
    once = "wgsl" if example in BY_COMPUTE else "wgsl-compute"
    is_once = time == 2.5 and target != once and example not in LONG_BY_DRIVERS
    return is_small(example) or is_once


CASES = [
    (example, target, time)
    for example in sorted(distal.gallery())
    for target in TARGETS
    for time in TIMES
    if is_drawn(example, target, time) or (ALL and not (example in BY_COMPUTE and target == "wgsl"))
]


@cache
def image(example):
    return distal.load(f"example:{example}")


def direct(example):
    """The options by which an example shows what shader texts do, direct light."""
    return {"mode": "direct"} if isinstance(image(example), distal.Scene) else {}


@cache
def artifact(example, target):
    return text_of(image(example), target)


def size_of(example):
    """The size of the pictures by which drivers are held against the CPU."""
    return SIZE if ALL or is_small(example) else SCENE_SIZE


@cache
def cpu_picture(example, time):
    options = {"size": size_of(example), "samples": 1, "time": time}
    return image(example).render(**options, **direct(example)).array


@cache
def data(example, time):
    """The buffers and textures of an example, by the arguments of what draws it."""
    shown = image(example)
    return {"buffers": buffers_of(shown, time), "textures": textures_of(shown)}


def drawn(example, target, time):
    program, size = artifact(example, target), size_of(example)
    values = {u["name"] for u in program.interface["uniforms"]} & {"time"}
    uniforms = dict.fromkeys(values, time)
    if program.interface["target"].startswith("wgsl"):
        gpu = pytest.importorskip("tests.gpu")
        try:
            return gpu.run_wgsl(program, size, uniforms, **data(example, time))
        except gpu.GpuUnavailableError as error:
            pytest.skip(str(error))
    glsl = pytest.importorskip("tests.glsl")
    try:
        return glsl.run_glsl(program, size, uniforms, **data(example, time))
    except glsl.egl.EglUnavailableError as error:
        pytest.skip(str(error))


def assert_driver_agrees(example, target, time):
    found = difference(drawn(example, target, time), cpu_picture(example, time))
    assert found.is_agreement_of(example), found


# Each example by some of the languages at some of the times; the texts of all are compiled and run
# on smaller programs in tests/validity and tests/parity.
@pytest.mark.sample(3, each="example")
@pytest.mark.parametrize(("example", "target", "time"), [c for c in CASES if is_small(c[0])])
def test_driver_draws_the_cpu_picture(example, target, time):
    assert_driver_agrees(example, target, time)


@pytest.mark.sample(4)
@pytest.mark.parametrize(("example", "target", "time"), [c for c in CASES if not is_small(c[0])])
def test_driver_draws_the_cpu_picture_of_a_scene(example, target, time):
    assert_driver_agrees(example, target, time)


def test_files_that_draw_functions_of_a_pixel_leave_none_out():
    scenes = [name for name in sorted(distal.gallery()) if name not in functions_of_a_pixel()]
    assert [name for name in scenes if not isinstance(image(name), distal.Scene)] == []


BY_REFERENCE = [n for n in sorted(distal.gallery()) if ALL or n not in LONG_BY_REFERENCE]


@pytest.mark.sample(2)
@pytest.mark.parametrize("example", BY_REFERENCE)
def test_reference_draws_the_cpu_picture(example):
    size = SIZE if is_small(example) else (64, 48)
    cpu, reference = (
        image(example)
        .render(size=size, samples=1, time=2.9, device=device, **direct(example))
        .array
        for device in ("cpu", "reference")
    )
    found = difference(reference, cpu)
    assert found.is_agreement_of(example), found


@pytest.mark.parametrize("size", [(1, 1), (3, 2), (17, 5), (65, 33), (127, 1), (1, 129)])
def test_odd_sizes_are_whole(size):
    cpu = image("raymarcher").render(size=size, samples=1, time=1.0).array
    reference = image("raymarcher").render(size=size, samples=1, time=1.0, device="reference").array
    assert cpu.shape == (size[1], size[0], 4)
    assert difference(cpu, reference).mean < 1.0
    assert abs(cpu - reference).max() < 0.02
