"""Shapes from ``.vm`` files: the author's file or text, as a node.

Input: the path of a file, or its text. Output: a node whose function every target compiles.
"""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import Any, Final

from distal.diagnostics import LoadError, Span
from distal.fields.guarantees import Primitive
from distal.foreign_files import opened
from distal.scene.objects.binding import own_node
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.node import Node
from distal.tape.vm_file import VmProgram, read_vm
from distal.tape.vm_function import point_function, program_of

_HINT: Final = 'give the path of a file, or its text: "_0 var-x\\n_1 const 1\\n_2 sub _0 _1"'


def vm_node(source: Any, place: Span | None, *, slope: Any, bounds: Any) -> Node:
    """Return the node of a ``.vm`` file; see ``BaseShape.from_vm``.

    Args:
        source: The path of a file, or a text with more than one line.
        place: The author's line.
        slope: Bound on |gradient| everywhere; None is 1.
        bounds: Corners (low, high) of a box around the surface, or None.

    Raises:
        VmFileError: The text is invalid.
        SceneValueError: The file cannot be read.
        SceneTypeError: ``source`` is neither a path nor a text.
    """
    if isinstance(source, str) and "\n" in source.strip():
        program = read_vm(source, "text")
    elif isinstance(source, str | PathLike):
        program = read_vm(_text_of(Path(source), place), str(source))
    else:
        refuse_kind(f"a .vm file is a path or a text, not {source!r:.40}", _HINT, place)
    function = point_function(program)
    return own_node(function, {}, place, slope=slope, bounds=bounds, exact=False, growth=None)


def program_of_node(node: Node) -> VmProgram | None:
    """Return the operations of a node that is a ``.vm`` file and nothing else; None for others."""
    rule = node.rule
    return program_of(rule.distance) if isinstance(rule, Primitive) else None


def _text_of(path: Path, place: Span | None) -> str:
    try:
        with opened(".vm", path) as data:
            try:
                return data.decode("utf-8")
            except UnicodeDecodeError:
                raise LoadError("it is no text") from None
    except LoadError as error:
        refuse(error.message, _HINT, place)
