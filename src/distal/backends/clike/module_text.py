"""Prepare a module for a text backend, and join the finished lines to a text."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable
from dataclasses import replace

from distal.backends.clike.code import Line
from distal.backends.clike.wrapping import wrapped
from distal.ir.nodes import EntryKind, Expr, Module, PerFrame, UniformDeclaration
from distal.ir.walk import map_expressions, substitute


def without_frame(module: Module) -> Module:
    """Return a ``@func``'s module with its per-frame values inlined: a library has no frames."""
    if module.kind is EntryKind.IMAGE or not module.frame:
        return module
    values: dict[Expr, Expr] = {}
    for name, value in module.frame:
        values[PerFrame(name, value.type)] = substitute(value, values, {})
    memo: dict[Expr, Expr] = {}
    functions = tuple(
        replace(f, body=map_expressions(f.body, lambda e: substitute(e, values, memo)))
        for f in module.functions
    )
    return replace(module, functions=functions, frame=())


def comment_text(text: str) -> str:
    """Return text for a comment in ASCII: old compilers reject other characters even there."""
    plain = unicodedata.normalize("NFKD", text).replace("\\", "/")
    return "".join(c for c in plain if " " <= c <= "~")


def uniform_comment(uniform: UniformDeclaration) -> str:
    """Return a comment with a parameter's label and range; "" if it has no label."""
    about = dict(uniform.interface)
    label = comment_text(str(about.get("label") or ""))
    if not label:
        return ""
    low, high = about.get("low"), about.get("high")
    span = f", {low} to {high}" if low is not None and high is not None else ""
    return f"  // {label}{span}"


def joined(lines: Iterable[Line]) -> tuple[str, tuple[tuple[str, int] | None, ...]]:
    """Return the text, and the author's file and line for each of its lines."""
    kept = list(wrapped(lines))
    while kept and not kept[0].text:
        kept.pop(0)
    while kept and not kept[-1].text:
        kept.pop()
    places = tuple((s.file, s.line) if (s := line.span) is not None else None for line in kept)
    return "".join(f"{line.text}\n" for line in kept), places
