"""The raymarcher's frame on a GPU: our device and text against a hand-written WGSL shader.

Both on the same adapter, interleaved frame by frame, every frame at another time, on both paths:
computed into a buffer, drawn into a texture; each time until the floats are in an array. The rival
keeps its pipeline, buffers and bind groups, as a shader author would. The last pictures are
compared, so that no cached frame is measured. Prints a table: medians, then our time through
the rival's: of medians, of the fastest frames, and in core time, which a busy machine disturbs
least (in software the driver works in this process; with a real GPU it is what the host adds).

    python benchmarks/bench_gpu.py [--rounds 30] [--adapter NAME] [--size 640x480 ...]
"""

from __future__ import annotations

import argparse
import statistics
import struct
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import numpy as np
from numpy.typing import NDArray

import distal
from distal.devices import adapters
from distal.devices.gpu import prepare
from distal.frontend import lower
from tests.pictures.comparison import difference

FRAME_STEP_S = 1.0 / 60.0
WARM_UP_FRAMES = 4  # the device learns its pace, the driver compiles
SIZES = ((640, 480), (1920, 1080))
LARGE = (3840, 2160)  # in hardware only

Picture = NDArray[np.float32]
Render = Callable[[float], Picture]


class Rival:
    """The hand-written text, by the shortest way that wgpu has."""

    def __init__(self, gpu: adapters.Gpu, path: str, size: tuple[int, int]) -> None:
        self.wgpu, self.device = adapters.wgpu_module(), gpu.device
        self.size, self.path = size, path
        usage = self.wgpu.BufferUsage
        text = (Path(__file__).parent / "rivals" / "raymarcher.wgsl").read_text("utf-8")
        module = self.device.create_shader_module(code=text)
        self.frame = self.device.create_buffer(size=16, usage=usage.UNIFORM | usage.COPY_DST)
        self.stride = -(-size[0] * 16 // 256) * 256 if path == "fragment" else size[0] * 16
        self.staging = self.device.create_buffer(
            size=self.stride * size[1], usage=usage.COPY_DST | usage.MAP_READ
        )
        self.pipeline = self._pipeline(module)
        entries = [{"binding": 0, "resource": {"buffer": self.frame, "offset": 0, "size": 16}}]
        if path == "compute":
            self.output = self.device.create_buffer(
                size=size[0] * size[1] * 16, usage=usage.STORAGE | usage.COPY_SRC
            )
            whole = {"buffer": self.output, "offset": 0, "size": self.output.size}
            entries.append({"binding": 1, "resource": whole})
        else:
            textures = self.wgpu.TextureUsage
            self.output = self.device.create_texture(
                size=(*size, 1),
                format="rgba32float",
                usage=textures.RENDER_ATTACHMENT | textures.COPY_SRC,
            )
            self.view = self.output.create_view()
        layout = self.pipeline.get_bind_group_layout(0)
        self.group = self.device.create_bind_group(layout=layout, entries=entries)

    def _pipeline(self, module: Any) -> Any:
        if self.path == "compute":
            stage = {"module": module, "entry_point": "compute_main"}
            return self.device.create_compute_pipeline(layout="auto", compute=stage)
        targets = [{"format": "rgba32float"}]
        return self.device.create_render_pipeline(
            layout="auto",
            vertex={"module": module, "entry_point": "vertex_main"},
            fragment={"module": module, "entry_point": "fragment_main", "targets": targets},
        )

    def render(self, seconds: float) -> Picture:
        """The picture of a time."""
        width, height = self.size
        data = struct.pack("3f4x", width, height, seconds)
        self.device.queue.write_buffer(self.frame, 0, data)
        encoder = self.device.create_command_encoder()
        if self.path == "compute":
            step = encoder.begin_compute_pass()
        else:
            clear = {"view": self.view, "load_op": "clear", "store_op": "store"}
            step = encoder.begin_render_pass(color_attachments=[clear])
        step.set_pipeline(self.pipeline)
        step.set_bind_group(0, self.group)
        if self.path == "compute":
            step.dispatch_workgroups(-(-width // 8), -(-height // 8))
        else:
            step.draw(3)
        step.end()
        size = self.staging.size
        if self.path == "compute":
            encoder.copy_buffer_to_buffer(self.output, 0, self.staging, 0, size)
        else:
            rows = {"bytes_per_row": self.stride, "rows_per_image": height}
            target = {"buffer": self.staging, **rows}
            encoder.copy_texture_to_buffer({"texture": self.output}, target, (width, height, 1))
        self.device.queue.submit([encoder.finish()])
        self.staging.map_async(self.wgpu.MapMode.READ, 0, size).sync_wait()
        mapped = np.frombuffer(self.staging.read_mapped(0, size, copy=False), np.float32)
        picture = mapped.reshape(height, -1, 4)[:, :width].copy()
        self.staging.unmap()
        return picture


def ours(path: str, size: tuple[int, int], adapter: str | None) -> tuple[Render, dict[str, Any]]:
    """The emitted text on our device."""
    module = lower(distal.load("example:raymarcher"))
    kernel = prepare(module, path=path, adapter=adapter)
    return lambda t: kernel.render(*size, {"resolution": size, "time": t}, {}), kernel.stats


def measure(path: str, size: tuple[int, int], adapter: str | None, rounds: int) -> str:
    """A row of the table."""
    gpu = adapters.opened(adapters.chosen(adapter))
    emitted, stats = ours(path, size, adapter)
    runners = {"hand": Rival(gpu, path, size).render, "ours": emitted}
    for render in runners.values():
        for i in range(WARM_UP_FRAMES):
            render(i * FRAME_STEP_S)
    times: dict[str, list[float]] = {name: [] for name in runners}
    cores: dict[str, list[float]] = {name: [] for name in runners}
    tiles = []
    for i in range(rounds):
        order = list(runners.items())
        for name, render in order if i % 2 else order[::-1]:
            begin, busy = time.perf_counter(), time.process_time()
            render(i * FRAME_STEP_S)
            cores[name].append(time.process_time() - busy)
            times[name].append((time.perf_counter() - begin) * 1e3)
        tiles.append(stats["tiles"])
    last = {name: render(rounds * FRAME_STEP_S) for name, render in runners.items()}
    off = difference(last["hand"], last["ours"])
    if not off.is_agreement:
        sys.exit(f"the pictures differ: {off}")
    hand, own = (statistics.median(times[name]) for name in ("hand", "ours"))
    fastest = min(times["ours"]) / min(times["hand"])
    core = statistics.median(cores["ours"]) / statistics.median(cores["hand"])
    extent = f"{size[0]}x{size[1]}"
    parts = f"{statistics.median(tiles):.0f}"
    return (
        f"{extent:10} {path:9} {hand:9.2f} {own:9.2f} {own / hand:8.3f}x {fastest:8.3f}x"
        f" {core:8.3f}x {parts:>5} {off.mean:9.5f}"
    )


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--rounds", type=int, default=30)
    parser.add_argument("--adapter")
    parser.add_argument("--size", nargs="*", help="WIDTHxHEIGHT; two or three sizes by default")
    options = parser.parse_args()
    row = adapters.chosen(options.adapter)
    sizes = [*SIZES, *([] if row.is_software else [LARGE])]
    if options.size:
        sizes = [(int(w), int(h)) for w, _, h in (s.partition("x") for s in options.size)]
    print(f"{row.name}, {row.backend}; {options.rounds} frames of each, in turn; milliseconds")
    heads = ("hand", "ours", "ratio", "fastest", "cores")
    columns = " ".join(f"{head:>9}" for head in heads)
    print(f"{'size':10} {'path':9} {columns} parts   differs")
    for size in sizes:
        for path in ("compute", "fragment"):
            print(measure(path, size, options.adapter, options.rounds), flush=True)


if __name__ == "__main__":
    main()
