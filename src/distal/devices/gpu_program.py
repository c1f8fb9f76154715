"""A WGSL text as pipelines on an open device, with their inputs and outputs.

Input: an artifact, and values by name. Output: commands in an encoder. The bindings are read from
the artifact's interface. Pipelines, buffers and bind groups are reused between runs. Does not
depend on pictures or time.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any, Final

from distal.backends.base import Artifact
from distal.backends.messages import map_message
from distal.devices.adapters import Gpu
from distal.devices.base import DeviceError
from distal.devices.gpu_memory import Resources, UniformBytes, view_dimension
from distal.ir.types import Type

_SHARED, _READ = 0, 1  # groups: the program's own buffers; the author's textures and buffers
_PLACE: Final = re.compile(r"┌─ (.+:\d+)")
_SAID: Final = re.compile(r"\berror: (.+)")
LARGEST_DISPATCH: Final = 65535  # workgroups along one axis that every GPU allows


class GpuProgram:
    """One text on one device; the caller must hold the device's lock (``Gpu.commands``).

    Attributes:
        gpu: The device.
        interface: The text's description of its inputs.
        made: The number of pipelines created so far.
        resources: The author's textures and buffers.
    """

    def __init__(self, gpu: Gpu, artifact: Artifact, types: Mapping[str, Type]) -> None:
        self.gpu = gpu
        self._wgpu = gpu.wgpu
        self.interface = artifact.interface
        self.made = 0
        self._artifact = artifact
        self._device = device = gpu.device
        usage = self._wgpu.BufferUsage
        self._uniform_bytes = UniformBytes(self.interface)
        size = self.interface["uniform_buffer"]["size"]
        if size > gpu.limit("max-uniform-buffer-binding-size"):
            raise DeviceError(
                f"{gpu.adapter.name} cannot hold {size} bytes of parameters; or --device cpu"
            )
        self._uniforms = device.create_buffer(size=size, usage=usage.UNIFORM | usage.COPY_DST)
        self._written: bytes = b""
        self._frame_buffer = None
        self._is_frame_due = False
        if frame := self.interface.get("frame"):
            self._frame_buffer = device.create_buffer(
                size=frame["size"], usage=usage.UNIFORM | usage.STORAGE
            )
        self.resources = Resources(gpu, self.interface, types)
        self._bound: dict[int, Any] = {}
        self._layouts: dict[tuple[str, int], Any] = {}
        self._pipelines: dict[tuple[str, str], Any] = {}
        self._groups: dict[tuple[str, int], tuple[tuple[Any, ...], Any]] = {}
        self._module = self._compiled()

    def _compiled(self) -> Any:
        try:
            return self._device.create_shader_module(code=self._artifact.text)
        except self._wgpu.GPUValidationError as error:
            if "device is lost" in str(error).lower():
                raise
            raise DeviceError(self._refused(error)) from error

    def _refused(self, error: BaseException) -> str:
        """Return the error about the text on one line, with the author's place if it is known."""
        message = map_message(self._artifact, str(error))
        place, said = _PLACE.search(message), _SAID.search(message)
        where = f" at {place[1]}" if place else ""
        what = said[1] if said else " ".join(message.split())
        return f"{self.gpu.adapter.name} refuses the program{where}: {what}; or --device cpu"

    # Pipelines

    def compute(self, entry: str) -> Any:
        """Return the pipeline of a compute entry point."""
        return self._pipeline(entry, "")

    def fragment(self, format: str) -> Any:
        """Return the pipeline that draws into textures of a format."""
        return self._pipeline("fragment_main", format)

    def _pipeline(self, entry: str, format: str) -> Any:
        pipeline = self._pipelines.get((entry, format))
        if pipeline is None:
            try:
                pipeline = self._made(entry, format)
            except (self._wgpu.GPUValidationError, self._wgpu.GPUPipelineError) as error:
                if "device is lost" in str(error).lower():
                    raise
                raise DeviceError(self._refused(error)) from error
            self._pipelines[entry, format] = pipeline
            self.made += 1
        return pipeline

    def _made(self, entry: str, format: str) -> Any:
        sort = "frame" if entry == "frame_main" else "draw" if format else "compute"
        layouts = [self._layout(sort, group) for group in self._used_groups]
        layout = self._device.create_pipeline_layout(bind_group_layouts=layouts)
        if not format:
            stage = {"module": self._module, "entry_point": entry}
            return self._device.create_compute_pipeline(layout=layout, compute=stage)
        fragment = {"module": self._module, "entry_point": entry, "targets": [{"format": format}]}
        return self._device.create_render_pipeline(
            layout=layout,
            vertex={"module": self._module, "entry_point": "vertex_main"},
            fragment=fragment,
        )

    # Bindings

    @property
    def _used_groups(self) -> tuple[int, ...]:
        """The groups of the text; setting an empty one costs as much as a full one."""
        has_inputs = self.interface["textures"] or self.interface["buffers"]
        return (_SHARED, _READ) if has_inputs else (_SHARED,)

    def _kinds(self, sort: str, group: int) -> dict[int, dict[str, Any]]:
        """Return the layout entry of each binding, even if the text does not use it."""
        interface = self.interface
        kinds: dict[int, dict[str, Any]] = {}
        if group == _READ:
            for texture in interface["textures"]:
                sampled = {"view_dimension": view_dimension(texture)}
                kinds[texture["binding"]] = {"texture": sampled}
                kinds[texture["sampler_binding"]] = {"sampler": {}}
            for buffer in interface["buffers"]:
                kinds[buffer["binding"]] = {"buffer": {"type": "read-only-storage"}}
            return kinds
        kinds[interface["uniform_buffer"]["binding"]] = {"buffer": {"type": "uniform"}}
        if frame := interface.get("frame"):
            # One entry point writes it and the others read it: two bindings of one buffer.
            if sort == "frame":
                kinds[frame["storage"]["binding"]] = {"buffer": {"type": "storage"}}
            else:
                kinds[frame["uniform"]["binding"]] = {"buffer": {"type": "uniform"}}
        if sort == "compute":
            kinds[interface["output"]["binding"]] = {"buffer": {"type": "storage"}}
            if given := interface.get("input"):
                kinds[given["binding"]] = {"buffer": {"type": "read-only-storage"}}
        return kinds

    def _layout(self, sort: str, group: int) -> Any:
        layout = self._layouts.get((sort, group))
        if layout is None:
            stages = self._wgpu.ShaderStage
            seen = stages.FRAGMENT | stages.VERTEX if sort == "draw" else stages.COMPUTE
            kinds = self._kinds(sort, group)
            entries = [{"binding": b, "visibility": seen, **kind} for b, kind in kinds.items()]
            layout = self._device.create_bind_group_layout(entries=entries)
            self._layouts[sort, group] = layout
        return layout

    def _group(self, sort: str, group: int, extra: Mapping[int, tuple[Any, int]]) -> Any:
        """Return a bind group; the previous one if it binds the same objects."""
        interface, things = self.interface, dict(self._bound)
        sizes: dict[int, int] = {}
        if group == _SHARED:
            things = {interface["uniform_buffer"]["binding"]: self._uniforms}
            if frame := interface.get("frame"):
                for place in ("storage", "uniform"):
                    things[frame[place]["binding"]] = self._frame_buffer
            things |= {b: buffer for b, (buffer, _) in extra.items()}
            sizes = {b: size for b, (_, size) in extra.items()}
        kinds = self._kinds(sort, group)
        used = tuple((b, things[b], sizes.get(b, 0)) for b in kinds)
        known = self._groups.get((sort, group))
        if known is not None and known[0] == used:
            return known[1]
        entries = []
        for binding, thing, size in used:
            if "buffer" in kinds[binding]:
                thing = {"buffer": thing, "offset": 0, "size": size or thing.size}
            entries.append({"binding": binding, "resource": thing})
        made = self._device.create_bind_group(layout=self._layout(sort, group), entries=entries)
        self._groups[sort, group] = used, made
        return made

    # Runs

    def load(self, sources: Mapping[str, Any]) -> None:
        """Upload the textures and buffers that have changed."""
        self._bound, is_new = self.resources.bindings(self._device, sources)
        if is_new:
            self._groups.clear()

    def set_uniforms(self, values: Mapping[str, Any], tile: Sequence[int] = (0, 0, 0, 0)) -> None:
        """Write the uniforms; commands that are submitted later read them."""
        message = self._uniform_bytes.packed(values, tile).tobytes()
        if message != self._written:
            self._device.queue.write_buffer(self._uniforms, 0, message)
            self._written = message

    def start_frame(self) -> None:
        """Let the next commands begin with the computation of the per-frame values."""
        self._is_frame_due = self._frame_buffer is not None

    def encode_compute(
        self, encoder: Any, groups: tuple[int, int], extra: Mapping[int, tuple[Any, int]]
    ) -> None:
        """Encode a call of the main compute entry point.

        Args:
            encoder: The command encoder.
            groups: The number of workgroups in x and y.
            extra: Buffer and size in bytes of the output and the input, by binding.
        """
        step = encoder.begin_compute_pass()
        self._dispatch_frame(step)
        entry = self.interface["stages"]["compute"]
        self._dispatch(step, entry, "compute", extra, groups)
        step.end()

    def _dispatch_frame(self, step: Any) -> None:
        """Compute the per-frame values, if they are due."""
        if self._is_frame_due:
            self._is_frame_due = False
            self._dispatch(step, "frame_main", "frame", {}, (1, 1))

    def _dispatch(
        self,
        step: Any,
        entry: str,
        sort: str,
        extra: Mapping[int, tuple[Any, int]],
        groups: tuple[int, int],
    ) -> None:
        step.set_pipeline(self.compute(entry))
        for group in self._used_groups:
            step.set_bind_group(group, self._group(sort, group, extra))
        step.dispatch_workgroups(*groups)

    def encode_draw(
        self,
        encoder: Any,
        view: Any,
        format: str,
        place: tuple[int, int, int, int],
        *,
        keeps: bool = False,
    ) -> None:
        """Encode a drawing into a part of a texture view.

        Args:
            encoder: The command encoder.
            view: The texture view.
            format: The texture's format.
            place: The part: its corner from the top left, its width and height, in pixels.
            keeps: Whether the rest of the texture keeps its values; otherwise it is cleared.
        """
        if self._is_frame_due:
            before = encoder.begin_compute_pass()
            self._dispatch_frame(before)
            before.end()
        load = "load" if keeps else "clear"
        target = {"view": view, "load_op": load, "store_op": "store"}
        step = encoder.begin_render_pass(color_attachments=[target])
        step.set_pipeline(self.fragment(format))
        for group in self._used_groups:
            step.set_bind_group(group, self._group("draw", group, {}))
        step.set_scissor_rect(*place)
        step.draw(3)
        step.end()
