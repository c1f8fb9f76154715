"""The hand-written rivals draw the original's picture, or benchmarks against them mean nothing."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from tests.egl import EglShader, EglUnavailableError, context, to_bytes

ROOT = Path(__file__).parent.parent
RIVALS = ROOT / "benchmarks" / "rivals"
SIZE = (320, 240)
TIMES = (0.0, 1.7, 7.3)


def assert_agrees(picture: NDArray[np.uint8], time: float) -> None:
    original = np.asarray(Image.open(ROOT / "tests" / "originals" / f"raymarcher_{time}.png"))
    off = np.abs(picture.astype(int) - original.astype(int))
    assert off.mean() <= 1.0
    assert (off.max(axis=-1) > 2).mean() <= 0.002


@pytest.mark.parametrize("time", TIMES)
def test_glsl_rival_draws_the_original(time: float) -> None:
    try:
        context()
    except EglUnavailableError as error:
        pytest.skip(str(error))
    shader = EglShader((RIVALS / "raymarcher.frag").read_text("utf-8"))
    picture = shader.render(SIZE, {"u_time": time, "u_resolution": SIZE})
    shader.release()
    assert_agrees(to_bytes(picture), time)


@pytest.mark.parametrize("time", TIMES)
def test_wgsl_rival_draws_the_original(time: float) -> None:
    wgpu = pytest.importorskip("wgpu")
    try:
        device = wgpu.gpu.request_adapter_sync().request_device_sync()
    except RuntimeError as error:
        pytest.skip(f"no WebGPU adapter: {error}")
    module = device.create_shader_module(code=(RIVALS / "raymarcher.wgsl").read_text("utf-8"))
    texture = device.create_texture(
        size=(*SIZE, 1),
        format="rgba32float",
        usage=wgpu.TextureUsage.RENDER_ATTACHMENT | wgpu.TextureUsage.COPY_SRC,
    )
    pipeline = device.create_render_pipeline(
        layout="auto",
        vertex={"module": module, "entry_point": "vertex_main"},
        fragment={
            "module": module,
            "entry_point": "fragment_main",
            "targets": [{"format": "rgba32float"}],
        },
        primitive={"topology": "triangle-list"},
    )
    frame = device.create_buffer_with_data(
        data=struct.pack("3f4x", *SIZE, time), usage=wgpu.BufferUsage.UNIFORM
    )
    bindings = device.create_bind_group(
        layout=pipeline.get_bind_group_layout(0),
        entries=[{"binding": 0, "resource": {"buffer": frame, "offset": 0, "size": 16}}],
    )
    encoder = device.create_command_encoder()
    target = {"view": texture.create_view(), "load_op": "clear", "store_op": "store"}
    render = encoder.begin_render_pass(color_attachments=[target])
    render.set_pipeline(pipeline)
    render.set_bind_group(0, bindings)
    render.draw(3)
    render.end()
    device.queue.submit([encoder.finish()])
    layout = {"bytes_per_row": SIZE[0] * 16, "rows_per_image": SIZE[1]}
    data = device.queue.read_texture({"texture": texture}, layout, (*SIZE, 1))
    assert_agrees(to_bytes(np.frombuffer(data, np.float32).reshape(SIZE[1], SIZE[0], 4)), time)
