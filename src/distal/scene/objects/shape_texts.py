"""Shapes as text that evaluates to an equal shape, for ``repr``.

Input: a shape. Output: the call that made it, and the operators that were applied to it:
``(Sphere(radius=1.0) | Box(size=(1.0, 1.0, 1.0))).translate((1.0, 0.0, 0.0))``.
"""

from __future__ import annotations

from typing import Any, Final

from distal.fields.library import OPERATORS
from distal.scene.tree.texts import TextWriter, shortened

# Operators without numbers that Python has a sign for.
_SIGNS: Final = {"union": "|", "intersection": "&", "difference": "-", "xor": "^"}


def text_of_shape(shape: Any, writer: TextWriter) -> str:
    """Return the text of a shape; a chain of operators is written without recursion.

    Args:
        shape: The shape.
        writer: The text that it becomes a part of.
    """
    steps: list[str] = []
    while True:
        steps += reversed(_dressed(shape, writer))
        children = shape.children
        if len(children) != 1 or shape.operator not in OPERATORS:
            break
        steps.append(_applied(shape, writer))
        (shape,) = children
    first = _first(shape, writer)
    if not steps and writer.depth == 1 and _has_sign(shape) and first.startswith("("):
        first = first[1:-1]
    return "".join([first, *shortened(steps[::-1], str, "operators")])


def _dressed(shape: Any, writer: TextWriter) -> list[str]:
    """Return the calls that give a shape the materials and the name that it was not made with."""
    node, (label, material, cut_material) = shape.node, shape._made_with
    calls = []
    if node.material is not material and node.material is not None:
        calls.append(f".paint({writer.text(node.material)})")
    if node.cut_material is not cut_material and node.cut_material is not None:
        calls.append(f".cut_material({writer.text(node.cut_material)})")
    if node.label != label:
        calls.append(f".named({writer.text(node.label)})")
    return calls


def _has_sign(shape: Any) -> bool:
    return shape.operator in _SIGNS and not shape.arguments


def _applied(shape: Any, writer: TextWriter) -> str:
    """Return the call of an operator of one shape."""
    name, arguments = shape.operator, shape.arguments
    if name in ("translate", "flat translate"):
        return f".translate({writer.text(arguments['offset'])})"
    numbers = "".join(f", {n}={writer.text(v)}" for n, v in arguments.items())
    return f".apply({name!r}{numbers})"


def _first(shape: Any, writer: TextWriter) -> str:
    """Return the text of a shape of the library, of one that a call made, or of several shapes."""
    origin, children, name = shape._origin, shape.children, shape.operator
    writer.shapes_left -= 1
    if origin is not None:
        return writer.call(origin.factory, {n: shape.arguments[n] for n in origin.given})
    if not children and shape._class is not None:
        return writer.call(shape._class, shape.arguments)
    if not children or name not in OPERATORS or writer.shapes_left < 0:
        count = f" of {len(children)} shapes" if children else ""
        return f"<{shape.node.rule.name}{count}>"
    if _has_sign(shape):
        return f"({writer.several(children, f' {_SIGNS[name]} ')})"
    first, *others = children
    numbers = "".join(f", {n}={writer.text(v)}" for n, v in shape.arguments.items())
    listed = writer.several(others, ", ")
    return f"{writer.text(first)}.apply({name!r}, others=[{listed}]{numbers})"
