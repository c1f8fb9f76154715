"""The WGSL backend: a vertex and a fragment stage, or a compute program, for WebGPU.

Input: a module after the passes. Output: one text with all entry points, and the interface with
offsets and bindings. ``distal.backends.wgsl.writer`` writes functions, and
``distal.backends.wgsl.stages`` whole programs.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

from distal.backends.base import Artifact
from distal.backends.clike.interface import interface
from distal.backends.clike.module_names import ModuleNames, name_module
from distal.backends.clike.module_text import joined, without_frame
from distal.backends.clike.names import Namer
from distal.backends.wgsl.functions import function_interface
from distal.backends.wgsl.layout import lay_out
from distal.backends.wgsl.names import OWN, VOCABULARY
from distal.backends.wgsl.resources import texture_binding
from distal.backends.wgsl.stages import WgslProgram, program_lines
from distal.backends.wgsl.targets import WgslTarget
from distal.ir.nodes import EntryKind, Module, Origin, UniformDeclaration
from distal.ir.target import Target
from distal.ir.types import VEC2, Buffer, Kind, Vector, component_count
from distal.ir.walk import per_frame_reads_in

_RESOLUTION: Final = "resolution"
_TILE: Final = "tile"


def emit(module: Module, target: Target) -> Artifact:
    """Return the whole program."""
    assert isinstance(target, WgslTarget), target
    program = _program(_with_resolution(without_frame(module)), target)
    text, places = joined(program_lines(program))
    return Artifact(text, _interface(program, target), None, places)


def _is_resolution(uniform: UniformDeclaration) -> bool:
    return uniform.origin is Origin.FRAME and uniform.name == _RESOLUTION


def _with_resolution(module: Module) -> Module:
    """Return the module with the resolution as a uniform: entry points need it to flip rows."""
    if module.kind is EntryKind.FUNCTION or any(map(_is_resolution, module.uniforms)):
        return module
    size = UniformDeclaration(_RESOLUTION, VEC2, Origin.FRAME, (640.0, 480.0))
    return replace(module, uniforms=(size, *module.uniforms))


def _program(module: Module, target: WgslTarget) -> WgslProgram:
    names = name_module(module, VOCABULARY, has_members=True)
    # A value that only other per-frame values read is a local of frame_main.
    read = per_frame_reads_in(module.functions)
    frame = lay_out(tuple((name, value.type) for name, value in module.frame if name in read))
    size = next((u.name for u in module.uniforms if _is_resolution(u)), "")
    resolution = names.uniforms.get(size, "")
    tile = _tile_name(module, names)
    members = [(u.name, u.type) for u in module.uniforms]
    uniforms = lay_out((*members, *([(tile, Vector(Kind.UINT, 4))] if tile else [])))
    return WgslProgram(module, names, resolution, tile, uniforms, frame, target.compute)


def _tile_name(module: Module, names: ModuleNames) -> str:
    """Return the name of the uniform that contains the part of the picture to compute."""
    if module.kind is EntryKind.FUNCTION:
        return ""
    return Namer(VOCABULARY.fields, names.uniforms.values()).name(_TILE)


def _stride(buffer: Buffer) -> int:
    """Return the bytes from one element to the next: a vec3 takes the room of a vec4."""
    return {1: 4, 2: 8, 3: 16, 4: 16}[component_count(buffer.element)]


def _interface(program: WgslProgram, target: Target) -> dict[str, Any]:
    module, names = program.module, program.names
    result = interface(module, target, names)
    members = program.uniforms.members
    for entry, member in zip(result["uniforms"], members, strict=not program.tile):
        entry |= member.entry()
    result["uniform_buffer"] = {"group": 0, "binding": 0, "size": program.uniforms.size}
    if program.tile:
        # Corner and size in pixels, from the top left; zeros select the whole picture.
        place = {"type": "uvec4", **members[-1].entry()}
        result["tile"] = {"uniform": program.tile, "default": [0, 0, 0, 0], **place}
    numbers = {r.name: texture_binding(i) for i, r in enumerate(module.resources)}
    for texture in result["textures"]:
        binding = numbers[texture["name"]]
        texture |= {"group": 1, "binding": binding, "sampler_binding": binding + 1}
    strides = {r.name: _stride(r.type) for r in module.resources if isinstance(r.type, Buffer)}
    for buffer in result["buffers"]:
        name = buffer["name"]
        buffer |= {"group": 1, "binding": numbers[name], "stride": strides[name]}
    result["stages"] = {}
    if module.kind is EntryKind.FUNCTION:
        result["entry"] = names.functions[module.entry]
        if not program.compute:
            return result
        result |= function_interface(module.function(module.entry))
    elif program.compute:
        result["stages"] = {"compute": OWN.compute_main}
        result["workgroup"] = [8, 8]
        result["output"] = {"group": 0, "binding": 3, "layout": "vec4f, row by row, top row first"}
    else:
        result["stages"] = {"vertex": OWN.vertex_main, "fragment": OWN.fragment_main}
    if module.kind is EntryKind.IMAGE:
        result["entry"] = next(reversed(result["stages"].values()))
    if module.frame:
        result["stages"]["frame"] = OWN.frame_main
        result["frame"] = {
            "place": "dispatch",
            "size": program.frame.size,
            "uniform": {"group": 0, "binding": 1},
            "storage": {"group": 0, "binding": 2},
            "values": [
                {"name": names.frame[m.name], "type": str(m.type), **m.entry()}
                for m in program.frame.members
            ],
        }
    return result
