"""Write complete GLSL programs: declarations and entry points around the functions.

Input: a module after the passes for a GLSL target. Output: the fragment text and, for WebGL 2 and
desktop GL, the vertex text that computes the per-frame part. ``distal.backends.glsl.writer`` writes
the functions.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import assert_never

from distal.backends.clike.code import Code, Line
from distal.backends.clike.expense import Expense
from distal.backends.clike.functions import place
from distal.backends.clike.module_names import ModuleNames, reachable, types_in
from distal.backends.clike.module_text import uniform_comment
from distal.backends.clike.packing import Packing, value_text, vector_texts
from distal.backends.glsl.instruments import Instrument
from distal.backends.glsl.isf import IsfWriter, sampler_lines
from distal.backends.glsl.resources import accessor_lines, resource_lines
from distal.backends.glsl.targets import GlslTarget, target_name
from distal.backends.glsl.uniforms import constant_line, constant_lines, default_text
from distal.backends.glsl.writer import Glsl100Writer, GlslWriter
from distal.backends.targets import Declares
from distal.ir.nodes import (
    EntryKind,
    Expr,
    Function,
    Module,
    Origin,
    Resource,
    Texel,
    Uniform,
    UniformDeclaration,
)
from distal.ir.types import VEC2, Array, Buffer, Struct
from distal.ir.walk import expressions_in, nodes_in, per_frame_reads_in

_ES100_TYPES = {"resolution": "vec2 u_resolution", "time": "float u_time", "mouse": "vec2 u_mouse"}


@dataclass(frozen=True, slots=True)
class GlslProgram:
    """The data that all stages of one program share."""

    module: Module
    names: ModuleNames
    target: GlslTarget
    fixed: dict[str, str]  # the texts of the uniforms that the host provides
    constants: frozenset[str]  # numbers that exceed the limit of uniforms
    packing: Packing | None
    vectors: list[str]  # the names of the packed vectors
    header: tuple[str, ...] = ()  # comments that the host reads
    instrument: Instrument | None = None  # of a program that measures lines

    def writer(self) -> GlslWriter:
        """Return a new writer for one stage."""
        kind = Glsl100Writer if self.target.family == "glsl100" else GlslWriter
        kind = IsfWriter if self.target.described else kind
        return kind(self.names, Expense(self.module), self.fixed)

    def pixel_writer(self) -> GlslWriter:
        """Return a new writer for the stage of the pixels."""
        return self.writer() if self.instrument is None else self.instrument.writer(self)


def fragment_lines(program: GlslProgram) -> list[Line]:
    """Return the fragment stage; for a ``@func`` only its functions."""
    module = program.module
    entry = module.function(module.entry)
    is_image = module.kind is EntryKind.IMAGE
    writer = program.pixel_writer()
    writer.leaves_choice = True
    roots: list[Expr] = list(expressions_in(entry.body))
    here = program.packing is None  # whether this stage computes the per-frame part
    frame = [value for _, value in module.frame] if here else []
    functions = reachable(module, [*roots, *frame])
    _write_functions(writer, functions if is_image else (*functions, entry))
    in_functions = per_frame_reads_in(functions)
    if is_image:
        _write_main(program, writer, entry, in_functions)
    body = writer.lines
    used = (*functions, entry)
    lines = [Line(text) for text in program.target.head]
    lines += _uniform_lines(program, used, frame)
    lines += _frame_lines(program, in_functions)
    if is_image and program.target.output == "fragment_color":
        lines += [Line(""), *map(Line, _output_lines(entry))]
    if program.instrument is not None:
        lines += program.instrument.declaration_lines()
    lines += _type_lines(program, writer, used)
    lines += _table_lines(writer)
    return [*lines, Line(""), *body]


def vertex_lines(program: GlslProgram) -> list[Line]:
    """Return the vertex stage: one triangle over the whole picture, and the per-frame part.

    This stage always uses the careful functions: their cost for three vertices is negligible, and
    the driver's built-ins are not measured in this stage.
    """
    module = program.module
    writer = program.writer()
    frame = [value for _, value in module.frame]
    functions = reachable(module, frame)
    _write_functions(writer, functions)
    in_functions = per_frame_reads_in(functions)
    writer.span = None
    writer.line("void main() {")
    writer.depth = 1
    writer.local_namer = program.names.local_namer()
    corner = writer.temporary(
        "corner",
        Code("vec2(float(gl_VertexID % 2), float(gl_VertexID / 2))"),
        VEC2,
    )
    writer.line(f"gl_Position = vec4(4.0 * {corner.text} - 1.0, 0.0, 1.0);")
    _write_frame(program, writer, in_functions)
    if program.packing is not None:
        texts = vector_texts(program.packing, program.names.frame)
        for vector, text in zip(program.vectors, texts, strict=True):
            writer.line(f"{vector} = {text};")
    writer.depth = 0
    writer.line("}")
    lines = [Line(text) for text in program.target.head]
    lines += _uniform_lines(program, functions, frame)
    if program.packing is not None and program.vectors:
        lines += [Line(""), Line("// The per-frame part, handed to the fragment stage.")]
        lines += [Line(text) for text in _vector_declarations(program, "out")]
    lines += _globals(program, [n for n, _ in module.frame if n in in_functions])
    lines += _type_lines(program, writer, functions)
    lines += _table_lines(writer)
    return [*lines, Line(""), *writer.lines]


def _output_lines(entry: Function) -> list[str]:
    """Return the declarations of the pictures that are drawn; of several, each has a location."""
    if not isinstance(entry.result, Struct):
        return ["out vec4 fragment_color;"]
    return [
        f"layout(location = {i}) out vec4 {target_name(i)};"
        for i in range(len(entry.result.fields))
    ]


def _write_functions(writer: GlslWriter, functions: Sequence[Function]) -> None:
    for function in functions:
        writer.function(function)
        writer.span = None
        writer.line("")


def _write_main(
    program: GlslProgram, writer: GlslWriter, entry: Function, in_functions: set[str]
) -> None:
    writer.span = entry.span
    if entry.span is not None:
        writer.line(f"// {place(entry.span)}")
    target = program.target
    writer.line(f"{target.main} {{")
    writer.name_locals(entry, program.names.local_namer())
    writer.depth = 1
    coord = entry.params[0]
    if target.coord.isidentifier():
        writer.locals[coord.name] = target.coord
    elif any(getattr(e, "name", None) == coord.name for e in expressions_in(entry.body)):
        writer.line(f"vec2 {writer.locals[coord.name]} = {target.coord};")
    if program.packing is None:
        if program.module.frame:
            writer.line(
                "// Per frame: the same in every pixel, but there is no earlier stage here."
            )
        _write_frame(program, writer, in_functions)
    else:
        _unpack(program, writer, entry, in_functions)
    writer.output = target.output
    if isinstance(entry.result, Struct):
        writer.targets = entry.result
    writer.block(entry.body, tail=True)
    writer.output, writer.targets = None, None
    writer.depth = 0
    writer.span = None
    writer.line("}")


def _write_frame(program: GlslProgram, writer: GlslWriter, in_functions: set[str]) -> None:
    """Append the per-frame values; those that functions read are globals, the others locals."""
    for name, value in program.module.frame:
        spelled = program.names.frame[name]
        code = writer.expression(value)
        if name in in_functions:
            writer.line(f"{spelled} = {code.text};")
        else:
            writer.line(writer.declaration(spelled, code, value.type, mutable=False))


def _unpack(
    program: GlslProgram, writer: GlslWriter, entry: Function, in_functions: set[str]
) -> None:
    assert program.packing is not None
    wanted = per_frame_reads_in((entry,)) | in_functions
    for name, type in program.packing.values:
        if name not in wanted:
            continue
        spelled = program.names.frame[name]
        code = Code(value_text(program.packing, name, type, program.vectors))
        if name in in_functions:
            writer.line(f"{spelled} = {code.text};")
        else:
            writer.line(writer.declaration(spelled, code, type, mutable=False))


def _uniform_lines(
    program: GlslProgram, functions: Iterable[Function], roots: Iterable[Expr]
) -> list[Line]:
    used = [*nodes_in(*roots)]
    for function in functions:
        used += expressions_in(function.body)
    names = {e.name for e in used if isinstance(e, Uniform)}
    resources = {e.name for e in used if isinstance(e, Resource)}
    fetched = {e.texture for e in used if isinstance(e, Texel)}
    fetched |= {e for e in used if isinstance(e, Resource) and isinstance(e.type, Buffer)}
    fetched_names = {e.name for e in fetched if isinstance(e, Resource)}
    lines: list[str] = []
    accessors: list[str] = []
    uniforms = [u for u in program.module.uniforms if u.name in names]
    for uniform in uniforms:
        if uniform.name not in program.constants:
            lines += _uniform_line(program, uniform)
    constant = (u for u in uniforms if u.name in program.constants)
    lines += constant_lines((u, program.names.uniforms[u.name]) for u in constant)
    for resource in program.module.resources:
        if resource.name in resources:
            lines += resource_lines(resource, program.names, program.target)
        if program.target.described and resource.name in resources:
            accessors += ["", *sampler_lines(resource, program.names)]
        elif resource.name in fetched_names:
            accessors += ["", *accessor_lines(resource, program.names)]
    return [Line(""), *map(Line, lines), *map(Line, accessors)] if lines else []


def _uniform_line(program: GlslProgram, uniform: UniformDeclaration) -> list[str]:
    spelled = program.names.uniforms[uniform.name]
    target = program.target
    comment = uniform_comment(uniform)
    declares = _declares(target, uniform)
    if declares is Declares.PLACE:
        return []
    if declares is Declares.NOBODY:
        return [constant_line(uniform, spelled)]
    if uniform.origin is Origin.FRAME and uniform.name in target.texts:
        return [f"uniform {_ES100_TYPES.get(uniform.name, 'int u_frame')};"]
    if target.initialised and uniform.origin is not Origin.FRAME:
        return [f"uniform {uniform.type} {spelled} = {default_text(uniform)};{comment}"]
    return [f"uniform {uniform.type} {spelled};{comment}"]


def _declares(target: GlslTarget, uniform: UniformDeclaration) -> Declares:
    match uniform.origin:
        case Origin.FRAME:
            known = target.frame_uniforms is Declares.TEXT or uniform.name in target.texts
            return target.frame_uniforms if known else Declares.NOBODY
        case Origin.PARAMETER:
            return target.parameters
        case Origin.NUMBER:
            return target.numbers
        case _:
            assert_never(uniform.origin)


def _frame_lines(program: GlslProgram, in_functions: set[str]) -> list[Line]:
    lines: list[Line] = []
    if program.packing is not None and program.vectors:
        lines += [Line(""), Line("// Computed once a frame, by the vertex stage.")]
        lines += [Line(text) for text in _vector_declarations(program, "in")]
    return lines + _globals(program, [n for n, _ in program.module.frame if n in in_functions])


def _vector_declarations(program: GlslProgram, direction: str) -> list[str]:
    assert program.packing is not None
    return [
        f"flat {direction} {'vec4' if i < program.packing.float_vectors else 'ivec4'} {name};"
        for i, name in enumerate(program.vectors)
    ]


def _globals(program: GlslProgram, wanted: list[str]) -> list[Line]:
    types = {name: value.type for name, value in program.module.frame}
    lines = [Line(f"{types[name]} {program.names.frame[name]};") for name in wanted]
    return [Line(""), Line("// Per-frame values that functions read."), *lines] if lines else []


def _type_lines(
    program: GlslProgram, writer: GlslWriter, functions: Iterable[Function]
) -> list[Line]:
    types = list(types_in(program.module, functions))
    held = {t.element for t in types if isinstance(t, Array)}
    lines: list[Line] = []
    for type in types:
        if isinstance(type, Struct | Array):
            text = writer.struct_lines(type, type in held)
            lines += [Line(""), *map(Line, text)] if text else []
    return lines


def _table_lines(writer: GlslWriter) -> list[Line]:
    lines = []
    for table, name in writer.tables.items():
        code = writer.array_text(table)
        lines.append(Line(f"const {writer.type_name(table.type)} {name} = {code.text};"))
    return [Line(""), *lines] if lines else []
