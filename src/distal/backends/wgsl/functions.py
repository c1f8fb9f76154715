"""Write a function as a WGSL compute program that calls it for each pixel or each point.

Input: the entry function of a module. Output: its bindings, its entry point, and the data that a
host needs. A function from vec4 to vec4 maps a picture: ``source`` to ``pixels``. Any other
function is called for points: ``arguments`` has a run of words for each leaf of the arguments, with
one word for each point, and ``results`` has the same for the result. The size of the buffer
determines the number of points.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, Final, assert_never

from distal.backends.clike.module_names import ModuleNames
from distal.backends.wgsl.names import OWN
from distal.backends.wgsl.writer import WgslWriter
from distal.ir.nodes import Function
from distal.ir.types import (
    VEC4,
    Array,
    Buffer,
    FunctionType,
    Kind,
    Matrix,
    Scalar,
    Struct,
    Texture,
    Type,
    Vector,
)

WORKGROUP: Final = 64  # a multiple of the SIMD width of every GPU
_LARGEST_LEAVES: Final = 4096  # larger values would need a text with one line per element

_READ: Final = {
    Kind.FLOAT: "bitcast<f32>({})",
    Kind.INT: "bitcast<i32>({})",
    Kind.UINT: "{}",
    Kind.BOOL: "({} != 0u)",
}
_WRITE: Final = {
    Kind.FLOAT: "bitcast<u32>({})",
    Kind.INT: "bitcast<u32>({})",
    Kind.UINT: "{}",
    Kind.BOOL: "u32({})",
}


def maps_pixels(function: Function) -> bool:
    """Return whether a function maps a vec4 to a vec4, such as a pixel to a pixel."""
    return [p.type for p in function.params] == [VEC4] and function.result is VEC4


def _is_callable(function: Function) -> bool:
    types = [*(p.type for p in function.params), function.result]
    return all(map(_is_value, types)) and sum(map(leaf_count, types)) <= _LARGEST_LEAVES


def _is_value(type: Type) -> bool:
    match type:
        case Scalar() | Vector() | Matrix():
            return True
        case Struct(_, fields):
            return bool(fields) and all(_is_value(t) for _, t in fields)
        case Array(element):
            return _is_value(element)
        case Texture() | Buffer() | FunctionType():
            return False
        case _:
            assert_never(type)


def leaf_count(type: Type) -> int:
    """Return how many 32-bit words a value has."""
    match type:
        case Scalar():
            return 1
        case Vector(_, size):
            return size
        case Matrix(size):
            return size * size
        case Struct(_, fields):
            return sum(leaf_count(t) for _, t in fields)
        case Array(element, length):
            return length * leaf_count(element)
        case Texture() | Buffer() | FunctionType():
            raise AssertionError(f"{type} is not a value")
        case _:
            assert_never(type)


def function_interface(function: Function) -> dict[str, Any]:
    """Return the interface's entries of a function; none for a function that no host can call."""
    if maps_pixels(function):
        return {
            "stages": {"compute": OWN.pixels_main},
            "workgroup": [WORKGROUP],
            "input": {"group": 0, "binding": 4, "layout": "vec4f"},
            "output": {"group": 0, "binding": 3, "layout": "vec4f"},
        }
    if not _is_callable(function):
        return {}
    layout = "u32, a run for each leaf, a word for each point"
    output = {"group": 0, "binding": 3, "layout": layout, "leaves": leaf_count(function.result)}
    found = {
        "stages": {"compute": OWN.points_main},
        "workgroup": [WORKGROUP],
        "output": output,
    }
    if leaves := sum(leaf_count(p.type) for p in function.params):
        found["input"] = {"group": 0, "binding": 4, "layout": layout, "leaves": leaves}
    return found


def function_binding_lines(function: Function) -> list[str]:
    """Return the declarations of the input and output buffers."""
    if maps_pixels(function):
        return [
            "",
            f"@group(0) @binding(3) var<storage, read_write> {OWN.pixels}: array<vec4f>;",
            f"@group(0) @binding(4) var<storage, read> {OWN.source}: array<vec4f>;",
        ]
    if not _is_callable(function):
        return []
    lines = ["", f"@group(0) @binding(3) var<storage, read_write> {OWN.results}: array<u32>;"]
    if function.params:
        lines.append(f"@group(0) @binding(4) var<storage, read> {OWN.arguments}: array<u32>;")
    return lines


def function_entry_lines(
    function: Function, writer: WgslWriter, names: ModuleNames, first: Sequence[str]
) -> list[str]:
    """Return the entry point; no lines for a function that no host can call.

    Args:
        function: The function.
        writer: Writes types.
        names: The names in the text.
        first: The first lines of the entry point.
    """
    mapping = maps_pixels(function)
    if not mapping and not _is_callable(function):
        return []
    local = names.local_namer().name
    id, groups, here, count, value = map(local, ("id", "groups", "here", "points", "value"))
    called = names.functions[function.name]
    lines = [
        f"@compute @workgroup_size({WORKGROUP})",
        f"fn {OWN.pixels_main if mapping else OWN.points_main}(",
        f"    @builtin(global_invocation_id) {id}: vec3u, @builtin(num_workgroups) {groups}: vec3u",
        ") {",
        *first,
        f"    let {here} = {id}.x + {id}.y * {groups}.x * {WORKGROUP}u;",
    ]
    leaves = 1 if mapping else leaf_count(function.result)
    total = f"arrayLength(&{OWN.pixels})" if mapping else f"arrayLength(&{OWN.results}) / {leaves}u"
    lines += [
        f"    let {count} = {total};",
        f"    if ({here} >= {count}) {{",
        "        return;",
        "    }",
    ]
    if mapping:
        return [*lines, f"    {OWN.pixels}[{here}] = {called}({OWN.source}[{here}]);", "}", ""]
    words = (f"{OWN.arguments}[{i}u * {count} + {here}]" for i in range(_LARGEST_LEAVES))
    given = ", ".join(_read(p.type, words, writer) for p in function.params)
    lines.append(f"    let {value} = {called}({given});")
    for i, leaf in enumerate(_leaves(value, function.result, names)):
        lines.append(f"    {OWN.results}[{i}u * {count} + {here}] = {leaf};")
    return [*lines, "}", ""]


def _read(type: Type, words: Iterator[str], writer: WgslWriter) -> str:
    """Return a value made of the next words."""
    match type:
        case Scalar(kind):
            return _READ[kind].format(next(words))
        case Vector(kind, size):
            parts = [_READ[kind].format(next(words)) for _ in range(size)]
        case Matrix(size):
            parts = [_READ[Kind.FLOAT].format(next(words)) for _ in range(size * size)]
        case Struct(_, fields):
            parts = [_read(t, words, writer) for _, t in fields]
        case Array(element, length):
            parts = [_read(element, words, writer) for _ in range(length)]
        case Texture() | Buffer() | FunctionType():
            raise AssertionError(f"{type} is not a value")
        case _:
            assert_never(type)
    return f"{writer.type_name(type)}({', '.join(parts)})"


def _leaves(text: str, type: Type, names: ModuleNames) -> Iterator[str]:
    """Yield the words of a value, in the order that ``_read`` uses."""
    match type:
        case Scalar(kind):
            yield _WRITE[kind].format(text)
        case Vector(kind, size):
            yield from (_WRITE[kind].format(f"{text}.{c}") for c in "xyzw"[:size])
        case Matrix(size):
            for column in range(size):
                for c in "xyzw"[:size]:
                    yield _WRITE[Kind.FLOAT].format(f"{text}[{column}].{c}")
        case Struct(_, fields):
            for name, inner in fields:
                yield from _leaves(f"{text}.{names.fields[type, name]}", inner, names)
        case Array(element, length):
            for i in range(length):
                yield from _leaves(f"{text}[{i}]", element, names)
        case Texture() | Buffer() | FunctionType():
            raise AssertionError(f"{type} is not a value")
        case _:
            assert_never(type)
