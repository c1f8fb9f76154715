"""Textures and buffers read alike everywhere: filtered, by texel, by element, and their sizes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from distal.backends import emit, get_target
from distal.backends.numpy import interpreter as reference_backend
from distal.compiler.driver import run_passes
from distal.devices import cpu as cpu_device
from distal.devices.cache import Cache
from distal.devices.resources import load
from distal.frontend import lower
from distal.ir.nodes import Module
from distal.ir.types import Texture
from distal.lang import (
    Buffer,
    Frame,
    Texture2D,
    Texture3D,
    TextureCube,
    image,
    ivec2,
    ivec3,
    sample,
    size,
    texel,
    vec2,
    vec3,
    vec4,
)
from tests import egl, gpu
from tests.glsl import run_glsl

SIZE = (32, 24)
RANDOM = np.random.default_rng(5)

photo = Texture2D(RANDOM.random((5, 7, 4), np.float32))
tiles = Texture2D(RANDOM.random((5, 7, 4), np.float32), wrap="clamp")
volume = Texture3D(RANDOM.random((3, 4, 5, 4), np.float32))
sky = TextureCube(RANDOM.random((6, 8, 8, 4), np.float32))
numbers = Buffer(RANDOM.random(11).tolist())
whole = Buffer([3, -1, 2147483647, -2147483648, 7])
points = Buffer([(0.5, 1.5, -2.5), (3.0, 4.0, 5.0), (6.0, 7.0, 8.0)])


@image
def repeated(frame: Frame) -> vec4:
    return sample(photo, frame.coord / 11.0 - 0.7)


@image
def clamped(frame: Frame) -> vec4:
    return sample(tiles, frame.coord / 20.0 - 0.3)


@image
def in_volume(frame: Frame) -> vec4:
    return sample(volume, vec3(frame.coord / 17.0 - 0.4, frame.coord.x * 0.03))


@image
def in_sky(frame: Frame) -> vec4:
    # Face by face and up to the edges, where the filter looks across to the next face.
    across = (frame.coord % 8.0 - 4.0) / 3.51
    face = int(frame.coord.x / 8.0) % 3
    way = 1.0 if frame.coord.y < 12.0 else -1.0
    if face == 0:
        return sample(sky, vec3(way, across))
    if face == 1:
        return sample(sky, vec3(across.x, way, across.y))
    return sample(sky, vec3(across, way))


@image
def texels(frame: Frame) -> vec4:
    at = ivec2(frame.coord) - 3
    inside = size(photo)
    return texel(photo, at) + vec4(vec2(inside), 0.0, 0.0)


@image
def volume_texels(frame: Frame) -> vec4:
    at = ivec3(ivec2(frame.coord) - 2, int(frame.coord.x) % 7 - 2)
    return texel(volume, at) + vec4(vec3(size(volume)), 0.0)


@image
def cube_texels(frame: Frame) -> vec4:
    return texel(sky, ivec3(ivec2(frame.coord) % 8, int(frame.coord.x / 6.0)))


@image
def elements(frame: Frame) -> vec4:
    i = int(frame.coord.x) - 5
    return vec4(numbers[i], float(whole[i] & 65535), points[i].yz)


@image
def counts(frame: Frame) -> vec4:
    return vec4(float(size(numbers)), float(size(whole)), float(size(points)), 1.0)


def data(module: Module) -> dict[str, NDArray[Any]]:
    return {r.name: load(r.source, r.type) for r in module.resources}  # type: ignore[arg-type]


def on_reference(module: Module) -> NDArray[np.float32]:
    shaped = run_passes(module, get_target("numpy"))
    return reference_backend.render(shaped, *SIZE, {}, data(module))


def on_cpu(module: Module) -> NDArray[np.float32]:
    return cpu_device.prepare(module, cache=Cache(None)).render(*SIZE, {}, data(module))


def split(module: Module) -> dict[str, dict[str, NDArray[Any]]]:
    found = data(module)
    names = {r.name for r in module.resources if isinstance(r.type, Texture)}
    return {
        "textures": {n: a for n, a in found.items() if n in names},
        "buffers": {n: a for n, a in found.items() if n not in names},
    }


def on_glsl(module: Module) -> NDArray[np.float32]:
    try:
        egl.context()
    except egl.EglUnavailableError as error:
        pytest.skip(str(error))
    target = get_target("glsl-es300")
    return run_glsl(emit(run_passes(module, target), target), SIZE, **split(module))


def on_wgsl(module: Module) -> NDArray[np.float32]:
    try:
        gpu.device()
    except gpu.GpuUnavailableError as error:
        pytest.skip(str(error))
    target = get_target("wgsl")
    return gpu.run_wgsl(emit(run_passes(module, target), target), SIZE, **split(module))


FILTERED = (repeated, clamped, in_volume, in_sky)
EXACT = (texels, volume_texels, cube_texels, elements, counts)


@pytest.mark.parametrize("run", [on_cpu, on_glsl, on_wgsl])
@pytest.mark.parametrize("picture", [*FILTERED, *EXACT], ids=lambda f: f.name)
def test_resources_read_alike(picture: Any, run: Any) -> None:
    module = lower(picture)
    expected = on_reference(module)
    assert np.ptp(expected, axis=(0, 1)).any() or picture is counts
    # Drivers weigh texels in steps of 1/256.
    tolerance = (1e-5 if run is on_cpu else 1 / 128) if picture in FILTERED else 1e-6
    assert np.max(np.abs(run(module) - expected)) <= tolerance


def test_the_lower_left_texel_is_the_last_rows_first() -> None:
    module = lower(texels)
    stored = np.asarray(photo.data)
    corner = on_reference(module)[-1, 0] - np.array([7, 5, 0, 0])
    assert corner == pytest.approx(stored[-1, 0], abs=1e-6)


def test_filtering_at_texel_centres_gives_the_texels() -> None:
    @image
    def centres(frame: Frame) -> vec4:
        return sample(tiles, frame.coord / vec2(size(tiles)))

    picture = on_reference(lower(centres))[::-1]
    stored = np.asarray(tiles.data)[::-1]
    assert picture[:5, :7] == pytest.approx(stored, abs=1e-5)
