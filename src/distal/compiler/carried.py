"""Refuse what the text of a target cannot hold: resources of the host, and numbers.

Input: a module before the passes and after them, and the target. Output: nothing, or a
CompileError with the author's line and the targets that hold it.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Final

from distal.backends import TEXT_TARGETS
from distal.backends.targets import TextTarget
from distal.diagnostics import CompileError, Span
from distal.error_codes import ErrorCode
from distal.ir.limits import SMALLEST
from distal.ir.nodes import (
    Binary,
    BinaryOp,
    Const,
    EntryKind,
    Expr,
    Module,
    Origin,
    ResourceDeclaration,
    Splat,
    Unary,
    UnaryOp,
    span_in,
)
from distal.ir.types import Buffer, Kind, Texture, TextureShape, kind_of
from distal.ir.walk import children, expressions, nodes_in, statements_in
from distal.lang.live_textures import LiveTexture
from distal.passes.author_places import is_author_place, place_of_resource, place_of_uniform

_LARGEST: Final = 3.4028234663852886e38  # of 32-bit floats
PAGE: Final = "html"
_SHAPES: Final = {
    TextureShape.FLAT: "pictures",
    TextureShape.CUBE: "cube textures",
    TextureShape.VOLUME: "3D textures",
}


def check_resources(resources: Collection[ResourceDeclaration], of: Module, on: TextTarget) -> None:
    """Check that a target's text can read the resources of a program.

    Args:
        resources: What is left of the resources after the passes.
        of: The module before the passes, which has the author's places.
        on: The target.

    Raises:
        CompileError: It cannot read one of them.
    """
    for resource in resources:
        if (lacks := _lack(resource, on)) is None:
            continue
        able = [t.name for t in TEXT_TARGETS.values() if _lack(resource, t) is None]
        able += [PAGE] if of.kind is EntryKind.IMAGE else []
        raise CompileError.at(
            ErrorCode.TARGET,
            f"{on.host} has no {lacks}, and '{resource.name}' is read here",
            place_of_resource(of, resource.name),
            f"targets that have it: {', '.join(able)}",
        )
    if on.most_textures is not None and len(resources) > on.most_textures:
        names = [resource.name for resource in resources]
        raise CompileError.at(
            ErrorCode.TARGET,
            f"{on.host} has {on.most_textures} textures, and the picture reads {len(names)}: "
            f"{', '.join(names)}",
            place_of_resource(of, names[on.most_textures]),
            "put several pictures into one",
        )


def _lack(resource: ResourceDeclaration, target: TextTarget) -> str | None:
    """Return what the target lacks of a resource, in words; None if it has all."""
    source, type = resource.source, resource.type
    if isinstance(type, Buffer):
        return None if target.buffers else "buffers"
    assert isinstance(type, Texture)
    if isinstance(source, LiveTexture):
        return None if target.live else source.shown
    if type.shape not in target.textures:
        return _SHAPES[type.shape]
    return None


def check_numbers(module: Module, shaped: Module) -> None:
    """Check that the numbers in the author's code are numbers in a shader.

    GPUs compute with normal 32-bit floats: a smaller number is read as 0, and what an overflow
    gives is not defined in GLSL and WGSL.

    Args:
        module: The module before the passes.
        shaped: The module after the passes, in which constants are folded.

    Raises:
        CompileError: One is too small, or an operation on two literals overflows.
    """
    for function in (*module.functions, *shaped.functions):
        for stmt in statements_in(function.body):
            for e in nodes_in(*expressions(stmt)):
                if kind_of(e.type) is Kind.FLOAT:
                    _check_number(e, stmt.span)
    for uniform in module.uniforms:
        if uniform.origin is Origin.FRAME or kind_of(uniform.type) is not Kind.FLOAT:
            continue
        default = uniform.default
        for value in default if isinstance(default, tuple) else (default,):
            if 0.0 < abs(value) < SMALLEST:
                place = place_of_uniform(module, uniform.name)
                raise _too_small(value, place, f" ('{uniform.name}')")


def _check_number(e: Expr, stmt_span: Span | None) -> None:
    value = _value(e)
    if value is None:
        return
    # Of the expression within its statement: alone it may have the place of another scene's.
    span = next((s for s in (span_in(stmt_span, e), e.span) if is_author_place(s)), None)
    if span is None:
        return
    if isinstance(e, Const) and 0.0 < abs(value) < SMALLEST:
        raise _too_small(value, span)
    if abs(value) > _LARGEST and all(_is_held(part) for part in children(e)):
        raise CompileError.at(
            ErrorCode.NUMBER,
            f"this is {value:.3g}, and the largest number in a shader is {_LARGEST:.3g}",
            span,
            "scale the numbers so that products and sums stay below it",
        )


def _is_held(e: Expr) -> bool:
    value = _value(e)
    return value is not None and abs(value) <= _LARGEST


def _too_small(value: float, span: Span | None, whose: str = "") -> CompileError:
    return CompileError.at(
        ErrorCode.NUMBER,
        f"GPUs read {value!r}{whose} as 0: the smallest number in a shader is {SMALLEST:.3g}",
        span,
        "write 0.0, or scale the numbers",
    )


def _value(e: Expr) -> float | None:
    """Return the value of a float literal or of an operation on such; None for all else."""
    match e:
        case Const(bool() | int()):
            return None
        case Const(value):
            return float(value)
        case Splat(operand):
            return _value(operand)
        case Unary(UnaryOp.NEGATE, operand):
            negated = _value(operand)
            return None if negated is None else -negated
        case Binary(op, left, right):
            a, b = _value(left), _value(right)
            return None if a is None or b is None else _applied(op, a, b)
        case _:
            return None


def _applied(op: BinaryOp, a: float, b: float) -> float | None:
    try:
        match op:
            case BinaryOp.ADD:
                return a + b
            case BinaryOp.SUB:
                return a - b
            case BinaryOp.MUL:
                return a * b
            case BinaryOp.DIV:
                return a / b
            case _:
                return None
    except (OverflowError, ZeroDivisionError):
        return None
