"""The gallery, at several times: what drivers make of the emitted texts is the CPU's picture."""

from __future__ import annotations

from functools import cache

import pytest

import distal
from tests.pictures.comparison import difference

SIZE = (160, 120)
TIMES = (0.0, 2.9, 11.3)
TARGETS = ("glsl-es300", "wgsl", "wgsl-compute")


@cache
def image(example):
    return distal.load(f"example:{example}")


@cache
def artifact(example, target):
    return distal.compile(image(example), target=target)


@cache
def cpu_picture(example, time):
    return image(example).render(size=SIZE, time=time).array


def drawn(program, time):
    values = {u["name"] for u in program.interface["uniforms"]} & {"time"}
    uniforms = dict.fromkeys(values, time)
    if program.interface["target"].startswith("wgsl"):
        gpu = pytest.importorskip("tests.gpu")
        try:
            return gpu.run_wgsl(program, SIZE, uniforms)
        except gpu.GpuUnavailableError as error:
            pytest.skip(str(error))
    glsl = pytest.importorskip("tests.glsl")
    try:
        return glsl.run_glsl(program, SIZE, uniforms)
    except glsl.egl.EglUnavailableError as error:
        pytest.skip(str(error))


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("example", sorted(distal.gallery()))
def test_driver_draws_the_cpu_picture(example, target, time):
    found = difference(drawn(artifact(example, target), time), cpu_picture(example, time))
    assert found.is_agreement, found


@pytest.mark.parametrize("example", sorted(distal.gallery()))
def test_reference_draws_the_cpu_picture(example):
    reference = image(example).render(size=SIZE, time=2.9, device="reference").array
    found = difference(reference, cpu_picture(example, 2.9))
    assert found.is_agreement, found


@pytest.mark.parametrize("size", [(1, 1), (3, 2), (17, 5), (65, 33), (127, 1), (1, 129)])
def test_odd_sizes_are_whole(size):
    cpu = image("raymarcher").render(size=size, time=1.0).array
    reference = image("raymarcher").render(size=size, time=1.0, device="reference").array
    assert cpu.shape == (size[1], size[0], 4)
    assert difference(cpu, reference).mean < 1.0
    assert abs(cpu - reference).max() < 0.02
