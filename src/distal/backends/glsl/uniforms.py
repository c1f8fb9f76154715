"""Write uniforms in GLSL, and select the numbers that exceed the limit of uniforms.

Input: the uniforms of a module. Output: their lines. WebGL 2 guarantees 224 vectors for a fragment
stage, and packs smaller values into them (GLSL ES 3.00, appendix A.7). A scene may have thousands
of numbers: those that exceed the limit become constants with the same names.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Final

from distal.backends.clike.literals import float_literal, int_literal
from distal.backends.clike.module_text import uniform_comment
from distal.ir.nodes import Origin, UniformDeclaration
from distal.ir.types import FLOAT, UINT, Matrix, Scalar, Type, Vector

ROOM: Final = 200  # vectors; the rest of the 224 is for the driver and the host

BEYOND_ROOM_COMMENT: Final = (
    "// Numbers beyond what a stage has room for are constants: they need a new text to change."
)


def beyond_room(uniforms: Sequence[UniformDeclaration]) -> frozenset[str]:
    """Return the numbers that become constants: the last ones in the order of declaration."""
    widths: Counter[int] = Counter()
    for uniform in uniforms:
        if uniform.origin is not Origin.NUMBER:
            widths.update(_rows(uniform.type))
    beyond = set()
    for uniform in uniforms:
        if uniform.origin is not Origin.NUMBER:
            continue
        tried = widths + Counter(_rows(uniform.type))
        if _vectors(tried) <= ROOM:
            widths = tried
        else:
            beyond.add(uniform.name)
    return frozenset(beyond)


def _rows(type: Type) -> tuple[int, ...]:
    """Return the widths of the rows that a value occupies."""
    match type:
        case Scalar():
            return (1,)
        case Vector(_, size):
            return (size,)
        case Matrix(size):
            return (4 if size == 2 else size,) * size
        case _:
            raise AssertionError(f"{type} is no uniform's")


def _vectors(widths: Counter[int]) -> int:
    """Return the number of vectors after packing: a scalar beside a vec3, two vec2 in one."""
    spare = widths[3] + 2 * (widths[2] % 2)
    pairs = -(-widths[2] // 2)
    return widths[4] + widths[3] + pairs + -(-max(0, widths[1] - spare) // 4)


def constant_line(uniform: UniformDeclaration, spelled: str) -> str:
    """Return a uniform's default as a constant with its name."""
    value = default_text(uniform)
    return f"const {uniform.type} {spelled} = {value};{uniform_comment(uniform)}"


def constant_lines(uniforms: Iterable[tuple[UniformDeclaration, str]]) -> list[str]:
    """Return the numbers that exceed the limit, after a comment with the reason."""
    lines = [constant_line(uniform, spelled) for uniform, spelled in uniforms]
    return ["", BEYOND_ROOM_COMMENT, *lines] if lines else []


def default_text(uniform: UniformDeclaration) -> str:
    """Return a uniform's default as a GLSL constant."""
    default = uniform.default
    if isinstance(default, bool):
        return "true" if default else "false"
    if isinstance(default, tuple):
        return f"{uniform.type}({', '.join(float_literal(float(v)) for v in default)})"
    if uniform.type is FLOAT:
        return float_literal(float(default))
    return f"{default}u" if uniform.type is UINT else int_literal(int(default))
