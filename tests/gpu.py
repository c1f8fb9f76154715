"""Runs the WGSL of a compiled image through wgpu, for tests, tools and benchmarks.

In: an ``Artifact`` of the target wgsl or wgsl-compute, the picture's size, values of uniforms,
textures and buffers by name. Out: the picture as the program wrote it, in 32-bit floats. What to
bind where is read from the artifact's interface alone: the runner is also a test of that.
"""

from __future__ import annotations

import os
import struct
import tempfile
from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
import wgpu
from numpy.typing import NDArray

from distal.backends.base import Artifact
from tests.buffer_data import buffer_data

# Mesa complains on stderr without one; any folder that exists will do.
os.environ.setdefault("XDG_RUNTIME_DIR", tempfile.gettempdir())

VIEWS = {"Texture2D": "2d", "TextureCube": "cube", "Texture3D": "3d"}
LETTERS = {"f": "f", "v": "f", "m": "f", "i": "i", "u": "I", "b": "I"}


class GpuUnavailableError(RuntimeError):
    """No adapter on this machine; a test skips aloud on it."""


@cache
def device() -> wgpu.GPUDevice:
    """The process's one device.

    Raises:
        GpuUnavailableError: There is no adapter, not even a software one.
    """
    try:
        adapter = wgpu.gpu.request_adapter_sync(power_preference="high-performance")
        if adapter is None:
            raise RuntimeError("no adapter")
        features = {"float32-filterable"} & set(adapter.features)
        return adapter.request_device_sync(required_features=list(features))
    except RuntimeError as error:
        raise GpuUnavailableError(f"wgpu finds no adapter: {error}") from error


def adapter_name() -> str:
    """What runs the programs, such as ``llvmpipe (LLVM 15.0.6, 256 bits)``."""
    return str(device().adapter.info["device"])


def uniform_bytes(artifact: Artifact, size: tuple[int, int], values: Mapping[str, Any]) -> bytes:
    """The uniform buffer, defaults filled in.

    Raises:
        ValueError: A value names no uniform.
    """
    entries = artifact.interface["uniforms"]
    if unknown := set(values) - {entry["name"] for entry in entries} - {"resolution"}:
        raise ValueError(f"the program has no uniform {', '.join(sorted(unknown))}")
    data = bytearray(artifact.interface["uniform_buffer"]["size"])
    for entry in entries:
        value = values.get(entry["name"], entry["default"])
        if entry["name"] == "resolution" and entry["origin"] == "frame":
            value = size
        numbers = np.ravel(value).tolist()
        letter = LETTERS[entry["type"][0]]
        cast = float if letter == "f" else int
        pattern = f"<{len(numbers)}{letter}"
        struct.pack_into(pattern, data, entry["offset"], *map(cast, numbers))
    return bytes(data)


def run_wgsl(
    artifact: Artifact,
    size: tuple[int, int],
    uniforms: Mapping[str, Any] | None = None,
    path: str | None = None,
    textures: Mapping[str, NDArray[np.float32]] | None = None,
    buffers: Mapping[str, NDArray[Any]] | None = None,
) -> NDArray[np.float32]:
    """The picture, float32 of shape (height, width, 4), top row first.

    Args:
        artifact: What was compiled.
        size: Width and height.
        uniforms: Values by the author's names; the rest take their defaults.
        path: ``fragment`` or ``compute``, to insist on one; else as the artifact is.
        textures: float32 arrays (height, width, 4) or (depth, height, width, 4), bottom row first.
        buffers: Arrays (count,) or (count, components).

    Raises:
        GpuUnavailableError: There is no adapter.
        wgpu.GPUValidationError: The text is refused.
    """
    is_compute = "compute" in artifact.interface["stages"]
    assert path in (None, "compute" if is_compute else "fragment"), "compiled for the other path"
    gpu = device()
    module = gpu.create_shader_module(code=artifact.text)
    shared = _shared_buffers(artifact, size, uniforms or {})
    resources = _resources(artifact, textures or {}, buffers or {})
    encoder = gpu.create_command_encoder()
    frame = artifact.interface.get("frame")
    if frame is not None:
        # Written here, read as a uniform by the pixels: two bindings of one buffer.
        written = _without(shared, frame["uniform"]["binding"])
        layout, groups = _bindings(artifact, (written, resources), wgpu.ShaderStage.COMPUTE)
        pipeline = gpu.create_compute_pipeline(
            layout=layout, compute={"module": module, "entry_point": "frame_main"}
        )
        step = encoder.begin_compute_pass()
        _dispatch(step, pipeline, groups, (1, 1))
        shared = _without(shared, frame["storage"]["binding"])
    things = (shared, resources)
    if is_compute:
        return _compute(encoder, module, artifact, size, things)
    return _fragment(encoder, module, artifact, size, things)


def _without(bindings: dict[int, Any], number: int) -> dict[int, Any]:
    return {n: thing for n, thing in bindings.items() if n != number}


def _dispatch(step: Any, pipeline: Any, groups: list[Any], count: tuple[int, int]) -> None:
    step.set_pipeline(pipeline)
    for i, group in enumerate(groups):
        step.set_bind_group(i, group)
    step.dispatch_workgroups(*count)
    step.end()


def _compute(
    encoder: Any, module: Any, artifact: Artifact, size: tuple[int, int], things: Any
) -> NDArray[np.float32]:
    gpu = device()
    layout, groups = _bindings(artifact, things, wgpu.ShaderStage.COMPUTE)
    pipeline = gpu.create_compute_pipeline(
        layout=layout, compute={"module": module, "entry_point": "compute_main"}
    )
    across, down = artifact.interface["workgroup"]
    groups_of_pixels = (-(-size[0] // across), -(-size[1] // down))
    _dispatch(encoder.begin_compute_pass(), pipeline, groups, groups_of_pixels)
    gpu.queue.submit([encoder.finish()])
    output = things[0][artifact.interface["output"]["binding"]]
    pixels = np.frombuffer(gpu.queue.read_buffer(output), np.float32)
    return pixels.reshape(size[1], size[0], 4).copy()


def _fragment(
    encoder: Any, module: Any, artifact: Artifact, size: tuple[int, int], things: Any
) -> NDArray[np.float32]:
    gpu = device()
    layout, groups = _bindings(
        artifact, things, wgpu.ShaderStage.FRAGMENT | wgpu.ShaderStage.VERTEX
    )
    target = gpu.create_texture(
        size=(*size, 1),
        format="rgba32float",
        usage=wgpu.TextureUsage.RENDER_ATTACHMENT | wgpu.TextureUsage.COPY_SRC,
    )
    pipeline = gpu.create_render_pipeline(
        layout=layout,
        vertex={"module": module, "entry_point": "vertex_main"},
        fragment={
            "module": module,
            "entry_point": "fragment_main",
            "targets": [{"format": "rgba32float"}],
        },
    )
    attachment = {"view": target.create_view(), "load_op": "clear", "store_op": "store"}
    step = encoder.begin_render_pass(color_attachments=[attachment])
    step.set_pipeline(pipeline)
    for i, group in enumerate(groups):
        step.set_bind_group(i, group)
    step.draw(3)
    step.end()
    gpu.queue.submit([encoder.finish()])
    data = gpu.queue.read_texture({"texture": target}, {"bytes_per_row": size[0] * 16}, (*size, 1))
    return np.frombuffer(data, np.float32).reshape(size[1], size[0], 4).copy()


def _shared_buffers(
    artifact: Artifact, size: tuple[int, int], values: Mapping[str, Any]
) -> dict[int, wgpu.GPUBuffer]:
    """Group 0: binding -> buffer."""
    gpu, interface = device(), artifact.interface
    usage = wgpu.BufferUsage
    found = {
        interface["uniform_buffer"]["binding"]: gpu.create_buffer_with_data(
            data=uniform_bytes(artifact, size, values), usage=usage.UNIFORM
        )
    }
    if frame := interface.get("frame"):
        buffer = gpu.create_buffer(size=frame["size"], usage=usage.UNIFORM | usage.STORAGE)
        found[frame["uniform"]["binding"]] = found[frame["storage"]["binding"]] = buffer
    if output := interface.get("output"):
        found[output["binding"]] = gpu.create_buffer(
            size=size[0] * size[1] * 16, usage=usage.STORAGE | usage.COPY_SRC
        )
    return found


def _resources(
    artifact: Artifact,
    textures: Mapping[str, NDArray[np.float32]],
    buffers: Mapping[str, NDArray[Any]],
) -> dict[int, Any]:
    """Group 1: binding -> view, sampler or buffer."""
    found: dict[int, Any] = {}
    for entry in artifact.interface["textures"]:
        found[entry["binding"]] = _texture(entry, textures[entry["name"]])
        mode = "repeat" if entry["wrap"] == "repeat" else "clamp-to-edge"
        found[entry["sampler_binding"]] = device().create_sampler(
            mag_filter="linear",
            min_filter="linear",
            address_mode_u=mode,
            address_mode_v=mode,
            address_mode_w=mode,
        )
    for entry in artifact.interface["buffers"]:
        data = _padded(entry["element"], buffer_data(entry, buffers))
        found[entry["binding"]] = device().create_buffer_with_data(
            data=data, usage=wgpu.BufferUsage.STORAGE
        )
    return found


def _texture(entry: dict[str, Any], texels: NDArray[np.float32]) -> wgpu.GPUTextureView:
    shape = VIEWS[entry["type"]]
    texels = np.ascontiguousarray(texels, np.float32)
    layers = 1 if texels.ndim == 3 else texels.shape[0]
    height, width = texels.shape[-3:-1]
    texture = device().create_texture(
        size=(width, height, layers),
        dimension="3d" if shape == "3d" else "2d",
        format="rgba32float",
        usage=wgpu.TextureUsage.TEXTURE_BINDING | wgpu.TextureUsage.COPY_DST,
    )
    device().queue.write_texture(
        {"texture": texture},
        texels,
        {"bytes_per_row": width * 16, "rows_per_image": height},
        (width, height, layers),
    )
    return texture.create_view(dimension=shape)


def _padded(element: str, data: NDArray[Any]) -> bytes:
    letter = {"f": np.float32, "v": np.float32, "i": np.int32}.get(element[0], np.uint32)
    values = np.asarray(data).astype(letter)
    if values.ndim == 2 and values.shape[1] == 3:
        values = np.pad(values, ((0, 0), (0, 1)))  # a vec3 takes the room of a vec4
    return values.tobytes()


def _bindings(
    artifact: Artifact, things: tuple[dict[int, Any], dict[int, Any]], stages: int
) -> tuple[Any, list[Any]]:
    """A layout of everything, used or not, and its bind groups."""
    gpu = device()
    frame = artifact.interface.get("frame") or {}
    written = {
        place["binding"]
        for place in (artifact.interface.get("output"), frame.get("storage"))
        if place
    }
    layouts, groups = [], []
    for number, bindings in enumerate(things):
        entries, resources = [], []
        for binding, thing in bindings.items():
            entry: dict[str, Any] = {"binding": binding, "visibility": stages}
            if isinstance(thing, wgpu.GPUSampler):
                entry["sampler"] = {}
            elif isinstance(thing, wgpu.GPUTextureView):
                entry["texture"] = {"view_dimension": _dimension(artifact, binding)}
            else:
                kind = "uniform" if number == 0 else "read-only-storage"
                if number == 0 and binding in written:
                    kind = "storage"
                entry["buffer"] = {"type": kind}
                thing = {"buffer": thing, "offset": 0, "size": thing.size}
            entries.append(entry)
            resources.append({"binding": binding, "resource": thing})
        layouts.append(gpu.create_bind_group_layout(entries=entries))
        groups.append(gpu.create_bind_group(layout=layouts[-1], entries=resources))
    return gpu.create_pipeline_layout(bind_group_layouts=layouts), groups


def _dimension(artifact: Artifact, binding: int) -> str:
    entry = next(t for t in artifact.interface["textures"] if t["binding"] == binding)
    return VIEWS[entry["type"]]
