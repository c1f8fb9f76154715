"""The GLSL backend: WebGL 2 (ES 3.00), desktop 3.30, WebGL 1 (ES 1.00), glslCanvas, ISF, Shadertoy.

Input: a module after the passes. Output: its fragment text, its vertex text if the target has one,
and the interface. ``distal.backends.glsl.writer`` writes functions, and
``distal.backends.glsl.stages`` whole programs.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any, Final

from distal.backends.base import Artifact
from distal.backends.clike.interface import interface
from distal.backends.clike.keywords import (
    GLSL_FUNCTIONS,
    GLSL_KEYWORDS,
    GLSL_METHODS,
    GLSL_PREFIXES,
)
from distal.backends.clike.module_names import ModuleNames, Vocabulary, name_module, reachable
from distal.backends.clike.module_text import joined, without_frame
from distal.backends.clike.names import Reserved
from distal.backends.clike.packing import Packing, pack
from distal.backends.glsl import counting, timing
from distal.backends.glsl.counting import Counts
from distal.backends.glsl.isf import IsfHeader
from distal.backends.glsl.own_values import with_own_values
from distal.backends.glsl.stages import GlslProgram, fragment_lines, vertex_lines
from distal.backends.glsl.targets import GlslTarget
from distal.backends.glsl.timing import Repetitions
from distal.backends.glsl.uniforms import beyond_room
from distal.backends.glsl.writer import trust_macro
from distal.backends.targets import Declares
from distal.ir.intrinsics import INTRINSICS
from distal.ir.nodes import EntryKind, Module, Origin
from distal.ir.target import FramePlace, Target
from distal.ir.types import Type
from distal.ir.walk import expressions_in, per_frame_reads_in

_TRUST: Final = {i.name: trust_macro(i.name) for i in INTRINSICS.values() if i.careful}


def emit(module: Module, target: Target) -> Artifact:
    """Return the whole program.

    Raises:
        CompileError: The target cannot express the author's code.
    """
    assert isinstance(target, GlslTarget), target
    return _text(_program(without_frame(module), target), target)


def emit_counting(module: Module, target: Target, counts: Counts) -> Artifact:
    """Return a program of WebGL 2 that draws counts of lines (``glsl.counting``, ``glsl.work``).

    Raises:
        CompileError: The target cannot express the author's code.
    """
    assert isinstance(target, GlslTarget), target
    module = without_frame(module)
    if counts.splits:
        # All statements, not the author's alone: the work of what they call is added up as well.
        module = with_own_values(module, lambda _: True)
    program = counting.prepared(_program(module, target), counts)
    return counting.counting(_text(program, target), counts)


def emit_timing(module: Module, target: Target, measured: Repetitions) -> Artifact:
    """Return a program of WebGL 2 that does one line several times (``glsl.timing``).

    Raises:
        CompileError: The target cannot express the author's code.
    """
    assert isinstance(target, GlslTarget), target
    own = with_own_values(without_frame(module), measured.is_placed)
    program = timing.prepared(_program(own, target, macros=(timing.MEASURED,)), measured)
    return timing.timed(_text(program, target), measured)


def _text(program: GlslProgram, target: GlslTarget) -> Artifact:
    module = program.module
    text, places = joined(fragment_lines(program))
    # The header is added after wrapping, because its comment is data.
    text = "".join(f"{line}\n" for line in program.header) + text
    places = (*(None for _ in program.header), *places)
    if target.frame is not FramePlace.VERTEX or module.kind is not EntryKind.IMAGE:
        return Artifact(text, _interface(program, target), None, places)
    vertex, vertex_places = joined(vertex_lines(program))
    return Artifact(text, _interface(program, target), vertex, places, vertex_places)


def vocabulary(target: GlslTarget, macros: Iterable[str] = ()) -> Vocabulary:
    """Return the names that are reserved in a text for the target; ``macros``: the text's own."""
    # A macro replaces its word everywhere, even in names of locals and fields.
    macros = target.host_macros.union(macros, _TRUST.values() if target.rough else ())
    words = GLSL_KEYWORDS | GLSL_METHODS | macros
    fields = Reserved(words, (*GLSL_PREFIXES, *target.host_prefixes), target.host_parts)
    return Vocabulary(fields, fields | GLSL_FUNCTIONS | target.host_names | target.written_names)


def _program(module: Module, target: GlslTarget, macros: Iterable[str] = ()) -> GlslProgram:
    fixed = {
        uniform.name: target.texts[uniform.name]
        for uniform in module.uniforms
        if uniform.origin is Origin.FRAME and uniform.name in target.texts
    }
    words = vocabulary(target, macros)
    header: tuple[str, ...] = ()
    resources = target.resource_names(module.resources) if target.resource_names else {}
    if target.described and module.kind is EntryKind.IMAGE:
        isf = IsfHeader.of(module, words.names)
        fixed |= isf.texts
        words = replace(words, names=words.names | isf.names)
        header, resources = isf.lines, isf.resources
    names = name_module(module, words, fixed, resources)
    packing = None
    if target.frame is FramePlace.VERTEX:
        packing = pack(_sent(module))
    own = target.numbers is Declares.TEXT
    constants = beyond_room(module.uniforms) if own else frozenset()
    vectors = _vectors(names, packing)
    return GlslProgram(module, names, target, fixed, constants, packing, vectors, header)


def _sent(module: Module) -> tuple[tuple[str, Type], ...]:
    """Return the per-frame values that the fragment stage reads."""
    entry = module.function(module.entry)
    functions = reachable(module, expressions_in(entry.body))
    read = per_frame_reads_in((*functions, entry))
    return tuple((name, value.type) for name, value in module.frame if name in read)


def _trust(module: Module) -> dict[str, str]:
    """Return the macros of the fragment text, by the built-ins whose careful functions it has."""
    entry = module.function(module.entry)
    functions = (*reachable(module, expressions_in(entry.body)), entry)
    natives = {f.native for f in functions}
    return {name: macro for name, macro in _TRUST.items() if name in natives}


def _vectors(names: ModuleNames, packing: Packing | None) -> list[str]:
    if packing is None:
        return []
    count = packing.float_vectors + packing.int_vectors
    return [names.namer.name(f"packed_{i}") for i in range(count)]


def _interface(program: GlslProgram, target: GlslTarget) -> dict[str, Any]:
    module, names = program.module, program.names
    result = interface(module, target, names)
    if program.constants:
        # They are constants in the text, so a host cannot set them.
        apart = [u for u in result["uniforms"] if u["name"] in program.constants]
        result["uniforms"] = [u for u in result["uniforms"] if u not in apart]
        result["constants"] = apart
    for uniform in result["uniforms"]:
        # The text builds a vector from the host's value: u_mouse in vec4(u_mouse, 0.0, 0.0).
        spelled = uniform["uniform"].removeprefix("vec4(").removeprefix("vec3(")
        uniform["uniform"] = spelled.partition(",")[0].partition(" ")[0]
    result["version"] = target.version
    if target.rough:
        # The macro that a host defines if its driver's built-in is accurate (fragment stage).
        result["trust"] = _trust(module)
    for buffer in result["buffers"]:
        buffer["count"] = names.counts[buffer["name"]]
        buffer["layout"] = "texture, one texel an element, row by row"
    if module.kind is EntryKind.FUNCTION:
        result["entry"] = names.functions[module.entry]
        result["stages"] = {}
        return result
    result["entry"] = target.entry
    result["stages"] = {"fragment": result["entry"]}
    if program.packing is not None:
        result["stages"]["vertex"] = "main"
        result["vertices"] = 3  # drawn as triangles, without buffers
    result["frame"] = {
        "place": target.frame.value,
        "values": [
            {"name": names.frame[name], "type": str(value.type)} for name, value in module.frame
        ],
        "vectors": program.vectors,
    }
    return result
