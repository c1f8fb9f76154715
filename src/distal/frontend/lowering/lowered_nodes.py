"""Syntax nodes for values that are lowered already: a call is lowered in another form.

``f(*pair)`` is lowered as ``f(a, b)`` and ``ray.at(t)`` as ``at(ray, t)``: the values stand as
nodes among the author's other arguments, with the place of what the author wrote.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence

from distal.error_codes import ErrorCode
from distal.frontend.function_body import FunctionBody
from distal.frontend.problems import must_be
from distal.frontend.types.coercion import with_default_type
from distal.frontend.values import SequenceValue, Value
from distal.ir.build import integer
from distal.ir.nodes import Expr, Field, Index, Swizzle
from distal.ir.types import Array, Scalar, Struct, Vector
from distal.lang.functions import Func
from distal.lang.structs import METHODS

# The types whose values have parts: what ``*`` and assignments to several names take.
UNPACKED = "an array, a vector or a tuple"


class LoweredNode(ast.expr):
    """An expression whose value is known."""

    _fields = ()

    def __init__(self, value: Value, place: ast.expr) -> None:
        super().__init__()
        self.value = value
        ast.copy_location(self, place)


def lowered_value(body: FunctionBody, node: LoweredNode) -> Value:
    """Return the value of the node."""
    return node.value


def without_stars(body: FunctionBody, nodes: Sequence[ast.expr]) -> list[ast.expr]:
    """Return the nodes with each ``*values`` replaced by a node for each part of ``values``.

    Raises:
        SceneError: The value after a star has no parts, or their number is not known.
    """
    plain: list[ast.expr] = []
    for node in nodes:
        if not isinstance(node, ast.Starred):
            plain.append(node)
            continue
        value = body.expression(node.value)
        plain += [LoweredNode(part, node) for part in _starred_parts(body, value, node)]
    return plain


def unstarred(body: FunctionBody, node: ast.Call) -> ast.Call:
    """Return the call with its starred arguments written out; itself if there are none."""
    if not any(isinstance(a, ast.Starred) for a in node.args):
        return node
    plain = ast.Call(node.func, without_stars(body, node.args), node.keywords)
    return ast.copy_location(plain, node)


def _starred_parts(body: FunctionBody, value: Value, node: ast.Starred) -> Sequence[Value]:
    if isinstance(value, SequenceValue):
        return value.items
    parts = parts_of(body, with_default_type(body, value, node.value))
    if parts is None:
        given = with_default_type(body, value, node.value).type
        raise body.problem(ErrorCode.TYPE, must_be("what '*' unpacks", UNPACKED, given), node)
    return parts


def parts_of(body: FunctionBody, value: Expr) -> list[Value] | None:
    """Return the parts of a tuple, a vector or an array; None for other values."""
    match value.type:
        case Struct(_, fields, True):
            held = body.bind("values", value)
            return [Field(held, name, type) for name, type in fields]
        case Vector(kind, size):
            held = body.bind("values", value)
            return [Swizzle(held, lane, Scalar(kind)) for lane in "xyzw"[:size]]
        case Array(element_type, length):
            held = body.bind("values", value)
            return [Index(held, integer(i), element_type) for i in range(length)]
        case _:
            return None


def methods_of(type: object) -> Mapping[str, Func]:
    """Return the methods of a struct by name; none of another type."""
    owner = type.owner if isinstance(type, Struct) else None
    return vars(owner)[METHODS] if owner is not None else {}
