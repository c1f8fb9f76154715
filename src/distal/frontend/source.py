"""Parse captured source text, and map syntax nodes back to places in the author's file.

Input: a ``Source`` (file, lines, first line). Output: the node of the ``def``, and a ``SourceMap``
that makes spans. Does not depend on the rules of scene code.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from typing import TypeAlias

from distal.diagnostics import CompileError, Span
from distal.error_codes import ErrorCode
from distal.frontend.parsing import parse, parse_definitions
from distal.lang.source import Source

Node: TypeAlias = ast.expr | ast.stmt


class SourceMap:
    """Map from the nodes of one parsed definition to source spans."""

    def __init__(self, file: str, lines: Sequence[str], line_offset: int) -> None:
        self.file = file
        self._lines = lines
        self._offset = line_offset

    def text(self, line: int) -> str:
        """Return a line of the file, without its newline; ``line`` counts from 1."""
        return self._lines[line - 1].rstrip("\r\n") if 0 < line <= len(self._lines) else ""

    def span(self, node: ast.expr | ast.stmt | ast.arg | ast.keyword) -> Span:
        """Return the span of a node."""
        line = node.lineno + self._offset
        text = self.text(line)
        start, end = node.col_offset, len(text)
        end_line = (node.end_lineno or node.lineno) + self._offset
        if end_line == line and node.end_col_offset is not None:
            end = node.end_col_offset
        if not text.isascii():
            # Columns of the tree count UTF-8 bytes; columns of a span count characters.
            encoded = text.encode()
            start = len(encoded[:start].decode(errors="replace"))
            end = len(encoded[:end].decode(errors="replace")) if end_line == line else len(text)
        return Span(self.file, line, start, end, text, end_line)

    def name_span(self, node: ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef) -> Span:
        """Return the span of a definition's name, for errors about the whole definition."""
        line = node.lineno + self._offset
        text = self.text(line)
        found = text.find(node.name, node.col_offset)
        start = found if found >= 0 else min(node.col_offset, len(text))
        length = len(node.name) if found >= 0 else 1
        last = (node.end_lineno or node.lineno) + self._offset
        return Span(self.file, line, start, start + length, text, last)


def parse_definition(source: Source, name: str) -> tuple[ast.FunctionDef, SourceMap]:
    """Parse the ``def`` that begins at the source's first line.

    Raises:
        CompileError: There is no text, or no plain ``def`` with this name at that line.
    """
    if not source.lines or source.first_line > len(source.lines):
        raise CompileError.at(
            ErrorCode.SOURCE,
            f"the source text of '{name}' is not available",
            None,
            "write it in a file, or in a notebook cell",
        )
    here = SourceMap(source.file, source.lines, 0)
    text = here.text(source.first_line)
    indent = len(text) - len(text.lstrip())
    span = Span(source.file, source.first_line, indent, len(text), text, source.first_line)
    try:
        return _find(source, name, span)
    except (SyntaxError, ValueError):
        raise CompileError.at(
            ErrorCode.SOURCE,
            f"the source text of '{name}' is not what Python runs",
            span,
            "load the file again",
        ) from None
    except (RecursionError, MemoryError):
        raise CompileError.at(
            ErrorCode.RECURSION,
            f"'{name}' is too deeply nested",
            span,
            "split long expressions into several lines",
        ) from None


def _find(source: Source, name: str, span: Span) -> tuple[ast.FunctionDef, SourceMap]:
    segment = _segment(source.lines, source.first_line - 1)
    offset = source.first_line - 1
    if span.col:
        segment, offset = ["if 1:\n", *segment], offset - 1
    try:
        tree = parse_definitions("".join(segment))
    except SyntaxError:
        # The guess by indentation failed, for example at a multi-line string: parse the file.
        tree, offset = parse("".join(source.lines)), 0
    first = source.first_line - offset
    for node in ast.walk(tree):
        match node:
            case ast.FunctionDef() if _first_line(node) == first and node.name == name:
                return node, SourceMap(source.file, source.lines, offset)
            case ast.AsyncFunctionDef() if _first_line(node) == first:
                message = f"'{name}' is an async function; scene code is plain functions"
                raise CompileError.at(
                    ErrorCode.DEFINITION, message, span, "write def instead of async def"
                )
            case ast.Lambda() if node.lineno == first and name == "<lambda>":
                message = "a lambda cannot be scene code by itself"
                raise CompileError.at(
                    ErrorCode.DEFINITION, message, span, "write a def, and @func above it"
                )
            case _:
                pass
    raise CompileError.at(
        ErrorCode.SOURCE,
        f"the source text of '{name}' is not what Python runs",
        span,
        "load the file again",
    )


def _first_line(node: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    return min([node.lineno, *(d.lineno for d in node.decorator_list)])


def _segment(lines: Sequence[str], first: int) -> list[str]:
    """Return the lines of the definition by indentation: much faster than parsing the file."""
    indent = _indent(lines[first])
    body = first
    while body < len(lines) and not lines[body].lstrip().startswith(("def ", "def\t", "async ")):
        body += 1
    end = body + 1
    while end < len(lines):
        stripped = lines[end].strip()
        ends = stripped and not stripped.startswith((")", "]", "}", "#"))
        if ends and _indent(lines[end]) <= indent:
            break
        end += 1
    return list(lines[first:end])


def _indent(line: str) -> int:
    return len(line) - len(line.lstrip())
