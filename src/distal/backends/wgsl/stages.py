"""Write complete WGSL programs: bindings and entry points around the functions.

Input: a module after the passes for WGSL. Output: the text. Group 0 contains the uniforms (binding
0) and the per-frame values, which one invocation of ``frame_main`` writes (binding 2) and all
pixels read as a uniform (binding 1). It also contains the output of a compute program (binding 3)
and the arguments of a function (binding 4). Group 1 contains textures with their samplers, and
buffers.

A large picture is computed in parts, so that the driver does not reset the GPU during a long
computation. The last member of the uniforms is the part's corner and size; zeros select the whole
picture.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final

from distal.backends.clike.code import Code, Line
from distal.backends.clike.expense import Expense
from distal.backends.clike.module_names import ModuleNames, called_by, reachable, types_in
from distal.backends.clike.module_text import uniform_comment
from distal.backends.wgsl.functions import function_binding_lines, function_entry_lines
from distal.backends.wgsl.layout import StructLayout, shared_type
from distal.backends.wgsl.names import OWN
from distal.backends.wgsl.resources import accessor_lines, binding_lines, fetched_resources
from distal.backends.wgsl.writer import WgslWriter
from distal.ir.nodes import EntryKind, Expr, Function, Module, Resource
from distal.ir.types import Kind, Matrix, Struct, Type, Vector, kind_of
from distal.ir.walk import expressions_in, nodes_in, per_frame_reads_in

# Uniforms and per-frame values are copied to private variables once per pixel. On targets where
# reading a uniform is an ordinary load, a loop would load it in every iteration: on lavapipe 8 % of
# the raymarcher's time, 10 % of its objects', 30 % of a scene with a hundred numbers. If reading a
# uniform is free, the copy makes no difference. Larger structs are not copied.
_COPIED_BYTES: Final = 4096


@dataclass(frozen=True, slots=True)
class WgslProgram:
    """The data from which the text is written."""

    module: Module
    names: ModuleNames
    resolution: str  # the member of the uniforms with the picture's size
    tile: str  # the member with the part of the picture to compute; "" for a function
    uniforms: StructLayout
    frame: StructLayout
    compute: bool

    def is_copied(self, layout: StructLayout) -> bool:
        """Whether an entry point copies a struct of inputs; functions alone have none."""
        has_entry_point = self.compute or self.module.kind is EntryKind.IMAGE
        return has_entry_point and layout.size <= _COPIED_BYTES


def program_lines(program: WgslProgram) -> list[Line]:
    """Return the whole text."""
    module, names = program.module, program.names
    is_image = module.kind is EntryKind.IMAGE
    entry = module.function(module.entry)
    if is_image:
        names.functions[entry.name] = OWN.pixel
    expense = Expense(module)
    reads = {name: f"{OWN.frame}.{names.frame[name]}" for name, _ in module.frame}
    writer = WgslWriter(names, expense, reads, {})
    functions = (*reachable(module, expressions_in(entry.body)), entry)
    for function in functions:
        writer.function(function)
        writer.span = None
        writer.line("")
    if is_image:
        writer.lines += map(Line, _entry_points(program))
    elif program.compute:
        writer.lines += map(Line, function_entry_lines(entry, writer, names, copy_lines(program)))
    used = list(functions)
    if module.frame:
        used += _write_frame(program, writer, functions)
    lines = _binding_lines(program, used)
    lines += _type_lines(program, writer, used)
    lines += _variable_lines(writer)
    return [*lines, Line(""), *writer.lines]


def _write_frame(
    program: WgslProgram, writer: WgslWriter, written: tuple[Function, ...]
) -> list[Function]:
    """Append the entry point of the per-frame part, and the functions that only it calls."""
    module, names = program.module, program.names
    needed = reachable(module, [value for _, value in module.frame])
    # Functions that read per-frame values are written twice: here they read the new values.
    stale: set[str] = set()
    for function in needed:
        if per_frame_reads_in((function,)) or called_by(function) & stale:
            stale.add(function.name)
    others = {
        names.functions[f]: names.namer.name(f"{names.functions[f]}_of_frame")
        for f in sorted(stale)
    }
    reads = {name: f"{OWN.frame_output}.{names.frame[name]}" for name, _ in module.frame}
    own = WgslWriter(names, writer.expense, reads, others)
    own.tables, own.variables_of_constants = writer.tables, writer.variables_of_constants
    own.lines = writer.lines
    done = {f.name for f in written}
    for function in needed:
        if function.name in stale or function.name not in done:
            own.function(function)
            own.span = None
            own.line("")
    own.span = None
    own.line("// Run once for each picture, before the pixels.")
    own.line("@compute @workgroup_size(1)")
    own.line(f"fn {OWN.frame_main}() {{")
    own.lines += map(Line, copy_lines(program, frame=False))
    own.depth = 1
    # A value that is already computed is read from its local.
    own.frame = dict(reads)
    own.local_namer = names.local_namer()
    for name, value in module.frame:
        code = own.expression(value)
        local = own.local_namer.name(name)
        own.line(own.declaration(local, code, value.type, mutable=isinstance(value.type, Struct)))
        if program.frame.has(name):
            shared = _to_shared(Code(local), value.type)
            own.line(f"{OWN.frame_output}.{names.frame[name]} = {shared};")
        own.frame = {**own.frame, name: local}
    own.depth = 0
    own.line("}")
    return list(needed)


def _to_shared(value: Code, type: Type) -> str:
    if kind_of(type) is not Kind.BOOL:
        return value.text
    converter = f"vec{type.size}u" if isinstance(type, Vector) else "u32"
    return f"{converter}({value.text})"


def copy_lines(program: WgslProgram, *, frame: bool = True) -> list[str]:
    """Return the first lines of an entry point: the copies of uniforms and per-frame values."""
    lines = []
    if program.module.uniforms and program.is_copied(program.uniforms):
        names = program.names.uniforms
        lines += _copy(OWN.uniforms, OWN.uniforms_input, program.uniforms, names)
    if frame and program.module.frame and program.is_copied(program.frame):
        lines += _copy(OWN.frame, OWN.frame_input, program.frame, program.names.frame)
    return lines


def _copy(name: str, source: str, layout: StructLayout, names: Mapping[str, str]) -> list[str]:
    """Return the copy of a struct, by members if it has a mat2, which naga 29 cannot copy whole."""
    if not any(isinstance(m.type, Matrix) and m.type.size == 2 for m in layout.members):
        return [f"    {name} = {source};"]
    members = (names.get(m.name, m.name) for m in layout.members)
    return [f"    {name}.{member} = {source}.{member};" for member in members]


def _input_lines(binding: int, name: str, source: str, type: str, *, is_copied: bool) -> list[str]:
    """Return the binding of a struct of uniforms, and the private variable for its copy."""
    here = f"@group(0) @binding({binding}) var<uniform>"
    if not is_copied:
        return [f"{here} {name}: {type};"]
    return [f"{here} {source}: {type};", f"var<private> {name}: {type};"]


def _entry_points(program: WgslProgram) -> list[str]:
    tile, resolution = (f"{OWN.uniforms}.{n}" for n in (program.tile, program.resolution))
    if program.compute:
        return [
            "@compute @workgroup_size(8, 8)",
            f"fn {OWN.compute_main}(@builtin(global_invocation_id) id: vec3u) {{",
            *copy_lines(program),
            f"    let part = {tile};",
            f"    let size = select(vec2u({resolution}), part.zw, part.z > 0u);",
            "    if (id.x >= size.x || id.y >= size.y) {",
            "        return;",
            "    }",
            "    // The picture's top row comes first; coordinates count from the bottom.",
            "    let center = vec2f(id.xy + part.xy) + 0.5;",
            f"    let coord = vec2f(center.x, {resolution}.y - center.y);",
            f"    {OWN.pixels}[id.y * size.x + id.x] = {OWN.pixel}(coord);",
            "}",
            "",
        ]
    return [
        "// One triangle over the whole picture.",
        "@vertex",
        f"fn {OWN.vertex_main}(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {{",
        "    let corner = vec2f(f32(index % 2u), f32(index / 2u));",
        "    return vec4f(4.0 * corner - 1.0, 0.0, 1.0);",
        "}",
        "",
        "@fragment",
        f"fn {OWN.fragment_main}(@builtin(position) position: vec4f) -> @location(0) vec4f {{",
        *copy_lines(program),
        "    // Positions count from the top, coordinates from the bottom.",
        f"    let center = position.xy + vec2f({tile}.xy);",
        f"    return {OWN.pixel}(vec2f(center.x, {resolution}.y - center.y));",
        "}",
        "",
    ]


def _binding_lines(program: WgslProgram, functions: Iterable[Function]) -> list[Line]:
    module, names = program.module, program.names
    lines: list[str] = []
    writer = WgslWriter(names, Expense(module), {}, {})
    if module.uniforms:
        lines += ["", f"struct {OWN.uniforms_type} {{"]
        for uniform in module.uniforms:
            type = writer.type_name(shared_type(uniform.type))
            comment = uniform_comment(uniform)
            lines.append(f"    {names.uniforms[uniform.name]}: {type},{comment}")
        if program.tile:
            note = "the part to compute: corner, size; zeros: the whole picture"
            lines.append(f"    {program.tile}: vec4u,  // {note}")
        own = (OWN.uniforms, OWN.uniforms_input, OWN.uniforms_type)
        is_copied = program.is_copied(program.uniforms)
        lines += ["}", "", *_input_lines(0, *own, is_copied=is_copied)]
    if module.frame:
        lines += ["", f"// Values that are the same in all pixels, computed by {OWN.frame_main}."]
        lines.append(f"struct {OWN.frame_type} {{")
        for member in program.frame.members:
            type = writer.type_name(shared_type(member.type))
            lines.append(f"    {names.frame[member.name]}: {type},")
        own = (OWN.frame, OWN.frame_input, OWN.frame_type)
        lines += [
            "}",
            "",
            *_input_lines(1, *own, is_copied=program.is_copied(program.frame)),
            f"@group(0) @binding(2) var<storage, read_write> {OWN.frame_output}: {OWN.frame_type};",
        ]
    if program.compute and module.kind is EntryKind.IMAGE:
        lines += ["", f"@group(0) @binding(3) var<storage, read_write> {OWN.pixels}: array<vec4f>;"]
    elif program.compute:
        lines += function_binding_lines(module.function(module.entry))
    nodes: list[Expr] = [*nodes_in(*(value for _, value in module.frame))]
    for function in functions:
        nodes += expressions_in(function.body)
    used = {e.name for e in nodes if isinstance(e, Resource)}
    fetched = fetched_resources(nodes)
    accessors: list[str] = []
    for i, resource in enumerate(module.resources):
        if resource.name in used:
            lines += ["", *binding_lines(resource, names, i)]
        if resource.name in fetched:
            accessors += ["", *accessor_lines(resource, names)]
    return [Line(text) for text in [*lines, *accessors]]


def _type_lines(
    program: WgslProgram, writer: WgslWriter, functions: Iterable[Function]
) -> list[Line]:
    lines: list[Line] = []
    for type in types_in(program.module, functions):
        if isinstance(type, Struct):
            lines += [Line(""), *map(Line, writer.struct_lines(type))]
    return lines


def _variable_lines(writer: WgslWriter) -> list[Line]:
    lines = []
    plain = WgslWriter(writer.names, writer.expense, {}, {})
    for table, name in writer.tables.items():
        lines.append(Line(f"var<private> {name} = {plain.array_text(table).text};"))
    for const, name in writer.variables_of_constants.items():
        lines.append(
            Line(
                f"var<private> {name}: {plain.type_name(const.type)} = {plain.literal(const).text};"
            )
        )
    return [Line(""), *lines] if lines else []
