"""The GPU device draws the CPU's pictures, on both paths, whole or in parts."""

from __future__ import annotations

import dataclasses
import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import distal
from distal.compiler.driver import run_passes
from distal.devices import adapters, cpu, gpu
from distal.devices.base import Cancelled, DeviceError
from distal.devices.gpu import GpuKernel
from distal.devices.gpu_program import GpuProgram
from distal.devices.tiles import TileSizer
from distal.frontend import lower
from distal.ir.types import VEC4
from distal.lang import (
    Buffer,
    Frame,
    Texture2D,
    TextureCube,
    func,
    image,
    mat3,
    sample,
    size,
    slider,
    struct,
    texel,
    uint,
    vec3,
    vec4,
)
from tests.pictures.comparison import difference

PATHS = ("compute", "fragment")
ODD_SIZES = ((1, 1), (17, 5), (1, 129))


@pytest.fixture(autouse=True, scope="module")
def _some_gpu() -> None:
    try:
        adapters.opened(adapters.chosen())
    except DeviceError as error:
        pytest.skip(str(error))


@pytest.fixture(params=PATHS)
def path(request: pytest.FixtureRequest) -> str:
    return str(request.param)


CHECKS = np.random.default_rng(7).random((5, 6, 4)).astype(np.float32)
SIDES = [np.random.default_rng(i).random((4, 4, 3)).astype(np.float32) for i in range(6)]

checks = Texture2D(CHECKS, wrap="repeat")
sky = TextureCube(SIDES)
heights = Buffer([0.25, 0.5, 0.125, 1.0, 0.75])
tints = Buffer(np.random.default_rng(3).random((4, 3)).astype(np.float32))
AMOUNT = slider("Amount", 0.5)


@image
def resources(frame: Frame) -> vec4:
    uv = frame.coord / frame.resolution.y
    turn = mat3(0.6, 0.8, 0.0, -0.8, 0.6, 0.0, 0.0, 0.0, 1.0)
    way = turn @ vec3(uv * 2.0 - 1.0, 0.7)
    column = int(frame.coord.x) % size(heights)
    tint = tints[int(frame.coord.y) % size(tints)]
    fetched = texel(checks, size(checks) - 1)
    soft = sample(checks, uv * 1.5) * heights[column] + sample(sky, way) * 0.25
    return vec4(soft.xyz * tint * AMOUNT, 1.0) + fetched * 0.01


@image
def place(frame: Frame) -> vec4:
    """Its own coordinate: any pixel in a wrong place is seen."""
    return vec4(frame.coord, frame.resolution)


@func
def graded(pixel: vec4) -> vec4:
    return vec4(pixel.xyz * AMOUNT + vec3(pixel.w, 0.0, 0.25), 1.0 - pixel.w)


def of(thing: Any, path: str) -> tuple[GpuKernel, dict[str, Any], dict[str, Any]]:
    """The kernel, the uniforms' values and the sources of the resources."""
    module = lower(thing)
    kernel = gpu.prepare(module, path=path)
    return kernel, {}, {r.name: r.source for r in module.resources}


@pytest.mark.parametrize("name", ["raymarcher", "raymarcher_objects"])
def test_examples_are_the_cpus(name: str, path: str) -> None:
    scene = distal.load(f"example:{name}")
    device = {"compute": "gpu", "fragment": "gpu-fragment"}[path]
    options = {"size": (160, 120), "time": 1.7}
    theirs = scene.render(device=device, **options)
    off = difference(scene.render(**options).array, theirs.array)
    assert off.is_agreement, off
    assert theirs.stats["path"] == path


@pytest.mark.parametrize("extent", [(40, 30), *ODD_SIZES])
def test_textures_buffers_and_matrices_are_the_cpus(path: str, extent: tuple[int, int]) -> None:
    kernel, _, sources = of(resources, path)
    uniforms = {"resolution": extent, "amount": 0.75}
    reference = cpu.prepare(lower(resources)).render(*extent, uniforms, sources)
    # Drivers filter with 8 bits of weight and more: half a step of an 8-bit picture.
    np.testing.assert_allclose(
        kernel.render(*extent, uniforms, sources), reference, atol=0.5 / 255, rtol=0.0
    )


@pytest.mark.parametrize("extent", ODD_SIZES)
def test_each_pixel_stands_in_its_place(path: str, extent: tuple[int, int]) -> None:
    width, height = extent
    kernel, _, sources = of(place, path)
    picture = kernel.render(width, height, {"resolution": extent}, sources)
    x, y = np.meshgrid(np.arange(width) + 0.5, height - 0.5 - np.arange(height))
    np.testing.assert_array_equal(picture[..., 0], x)
    np.testing.assert_array_equal(picture[..., 1], y)


@pytest.mark.parametrize("first", [64, 200, 1600])
def test_parts_make_the_same_picture(path: str, first: int) -> None:
    kernel, _, sources = of(distal.load("example:raymarcher"), path)
    extent = (83, 61)
    uniforms = {"resolution": extent, "time": 1.7}
    kernel.tile_sizer = TileSizer(10**9, first=10**9)
    whole = kernel.render(*extent, uniforms, sources)
    assert kernel.stats["tiles"] == 1
    kernel.tile_sizer = TileSizer(first, first)
    parts = kernel.render(*extent, uniforms, sources)
    assert kernel.stats["tiles"] >= 83 * 61 // first
    np.testing.assert_array_equal(parts, whole)


def test_pixels_are_mapped_as_on_the_cpu() -> None:
    pixels = np.random.default_rng(1).random((37, 21, 4)).astype(np.float32)
    module = lower(graded, (VEC4,))
    kernel = gpu.prepare(module)
    uniforms = {"amount": 0.3}
    expected = cpu.prepare(module).map_pixels(pixels, uniforms, {})
    np.testing.assert_allclose(kernel.map_pixels(pixels, uniforms, {}), expected, atol=1e-6)
    kernel.tile_sizer = TileSizer(50, 50)
    np.testing.assert_allclose(kernel.map_pixels(pixels, uniforms, {}), expected, atol=1e-6)


@struct
class Mixed:
    flag: bool
    count: int
    bits: uint
    turn: mat3
    way: vec3


@func
def mixed(given: Mixed, x: float, steps: int) -> Mixed:
    return Mixed(
        not given.flag,
        given.count * steps,
        given.bits ^ uint(steps),
        given.turn @ given.turn,
        given.turn @ given.way * x,
    )


@pytest.mark.parametrize("first", [10**6, 100])
def test_a_function_of_all_kinds_of_values_is_called_for_points(first: int) -> None:
    random, n = np.random.default_rng(5), 1001
    given = (
        random.random(n) < 0.5,
        random.integers(-(10**6), 10**6, n, np.int32),
        random.integers(0, 2**32, n, np.uint32),
        random.random((n, 3, 3)).astype(np.float32),
        random.random((n, 3)).astype(np.float32),
    )
    args = [given, random.random(n).astype(np.float32), np.array([7], np.int32)]
    module = lower(mixed)
    kernel = gpu.prepare(module)
    kernel.tile_sizer = TileSizer(first, first)
    values, expected = (k.evaluate(args, {}, {}) for k in (kernel, cpu.prepare(module)))
    for value, right in zip(values, expected, strict=True):
        assert value.dtype == right.dtype
        np.testing.assert_allclose(value, right, rtol=1e-5)


def test_a_parameter_or_the_time_makes_no_new_pipeline(path: str) -> None:
    kernel, _, sources = of(resources, path)
    seen = []
    for amount in (0.1, 0.9):
        uniforms = {"resolution": (20, 20), "amount": amount, "time": amount}
        seen.append(kernel.render(20, 20, uniforms, sources)[..., :3].mean())
        if amount == 0.1:
            made, uploads = kernel.program.made, kernel.program.resources.uploads
    assert seen[1] > seen[0] * 2
    assert (kernel.program.made, kernel.program.resources.uploads) == (made, uploads)
    assert uploads == 4


def test_only_what_changed_is_uploaded_again() -> None:
    kernel, _, sources = of(resources, "compute")
    uniforms = {"resolution": (20, 20)}
    texels = CHECKS.copy()
    sources["checks"] = texels
    before = kernel.render(20, 20, uniforms, sources)
    texels *= 0.5
    after = kernel.render(20, 20, uniforms, sources)
    assert kernel.program.resources.uploads == 5
    assert after.mean() < before.mean()
    reference = cpu.prepare(lower(resources)).render(20, 20, uniforms, sources)
    np.testing.assert_allclose(after, reference, atol=0.5 / 255, rtol=0.0)


def test_it_ends_when_it_is_told_to(path: str) -> None:
    kernel, _, sources = of(distal.load("example:raymarcher"), path)
    kernel.tile_sizer = TileSizer(256, 256)
    told: list[float] = []
    with pytest.raises(Cancelled):
        kernel.render(
            64, 64, {}, sources, progress=told.append, cancel=lambda: bool(told) and told[-1] > 0.2
        )
    assert 0.2 < told[-1] < 0.5
    stop = threading.Event()
    stop.set()
    with pytest.raises(Cancelled):
        kernel.render(64, 64, {}, sources, cancel=stop)
    kernel.render(64, 64, {}, sources, progress=told.append)
    assert told[-1] == 1.0


@pytest.fixture
def lost_gpu() -> Iterator[None]:
    """Whatever a test loses is not given to the next one."""
    yield
    for opened in list(adapters._OPEN.values()):
        opened.drop()


def test_a_lost_gpu_is_said_and_the_next_run_opens_it_anew(path: str, lost_gpu: None) -> None:
    kernel, _, sources = of(resources, path)
    uniforms = {"resolution": (20, 20)}
    before = kernel.render(20, 20, uniforms, sources)
    kernel.program.gpu.device.destroy()
    name = adapters.chosen().name
    with pytest.raises(DeviceError) as caught:
        kernel.render(20, 20, uniforms, sources)
    assert str(caught.value) == (
        f"the GPU was lost while rendering ({name}): its driver was reset or updated, or the work"
        " took too long; try again, or --device cpu"
    )
    np.testing.assert_array_equal(kernel.render(20, 20, uniforms, sources), before)


def test_a_refused_text_names_the_authors_line() -> None:
    module = lower(resources)
    artifact = gpu.prepare(module)._artifact
    lines = artifact.text.split("\n")
    number = next(i for i, line in enumerate(lines) if artifact.lines[i] and "let " in line)
    file, line = artifact.lines[number]  # type: ignore[misc]
    lines[number] = "    let wrong = nothing_of_that_name;"
    bad = dataclasses.replace(artifact, text="\n".join(lines))
    shaped = run_passes(module, gpu.get_target("wgsl-compute"))
    with pytest.raises(DeviceError) as caught:
        GpuKernel(shaped, bad, lambda: adapters.opened(adapters.chosen()))
    name = adapters.chosen().name
    assert str(caught.value) == (
        f"{name} refuses the program at {file}:{line}: no definition in scope for identifier:"
        " `nothing_of_that_name`; or --device cpu"
    )


def test_out_of_memory_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    kernel, _, sources = of(place, "compute")
    wgpu = adapters.wgpu_module()

    def full(*_: Any) -> None:
        raise wgpu.GPUOutOfMemoryError("no")

    monkeypatch.setattr(GpuProgram, "set_uniforms", full)
    with pytest.raises(DeviceError, match=r"has not enough memory; a smaller picture, or --device"):
        kernel.render(8, 8, {}, sources)


def test_64_bits_are_refused_in_words() -> None:
    with pytest.raises(DeviceError, match="a GPU computes with 32 bits, not 64: --device cpu"):
        gpu.prepare(lower(graded, (VEC4,)), precision=64)


def texture_of_a_window(extent: tuple[int, int]) -> Any:
    wgpu, shown = adapters.wgpu_module(), adapters.opened(adapters.chosen())
    usage = wgpu.TextureUsage.RENDER_ATTACHMENT | wgpu.TextureUsage.COPY_SRC
    return shown.device.create_texture(size=(*extent, 1), format="rgba8unorm", usage=usage)


def pixels_of(texture: Any) -> Any:
    width, height, _ = texture.size
    queue = adapters.opened(adapters.chosen()).device.queue
    data = queue.read_texture({"texture": texture}, {"bytes_per_row": width * 4}, texture.size)
    return np.frombuffer(data, np.uint8).reshape(height, width, 4)


def test_it_draws_into_a_texture_of_a_window(lost_gpu: None) -> None:
    kernel, _, sources = of(resources, "fragment")
    extent, uniforms = (33, 20), {"resolution": (33, 20)}
    texture = texture_of_a_window(extent)
    kernel.draw(texture.create_view(), "rgba8unorm", *extent, uniforms, sources)
    off = difference(kernel.render(*extent, uniforms, sources), pixels_of(texture))
    assert off.mean < 0.5
    assert off.far_off == 0.0


def test_a_window_is_drawn_in_parts_which_can_be_stopped_between() -> None:
    kernel, _, sources = of(resources, "fragment")
    kernel.tile_sizer = TileSizer(64)
    extent, uniforms = (33, 20), {"resolution": (33, 20)}
    texture = texture_of_a_window(extent)
    view = texture.create_view()
    shares: list[float] = []
    stop = threading.Event()

    def progress(share: float) -> None:
        shares.append(share)
        if len(shares) == 3:
            stop.set()

    with pytest.raises(Cancelled):
        kernel.draw(view, "rgba8unorm", *extent, uniforms, sources, progress=progress, cancel=stop)
    assert len(shares) == 3
    assert 0 < shares[0] < shares[1] < shares[2] < 1
    kernel.draw(view, "rgba8unorm", *extent, uniforms, sources)
    assert kernel.stats["tiles"] >= 11
    off = difference(kernel.render(*extent, uniforms, sources), pixels_of(texture))
    assert off.mean < 0.5
    assert off.far_off == 0.0


def test_a_large_picture_needs_no_binding_as_large() -> None:
    kernel, _, sources = of(place, "compute")
    kernel.tile_sizer = TileSizer(2**18)
    picture = kernel.render(4096, 600, {"resolution": (4096, 600)}, sources)
    assert kernel.stats["tiles"] > 9
    assert picture[-1, -1].tolist() == [4095.5, 0.5, 4096.0, 600.0]
