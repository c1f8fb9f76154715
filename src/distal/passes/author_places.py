"""Find the author's line that a place in the library's scene code goes back to.

Input: a module, and one of its functions or a resource. Output: a place in the author's file, for
errors: nobody can change a line of the library.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable

from distal.diagnostics import Span
from distal.ir.nodes import Call, Expr, Function, FunctionRef, Module, Resource, Uniform
from distal.ir.walk import expressions, nodes_in, statements_in
from distal.lang.source_places import is_library


def is_author_place(span: Span | None) -> bool:
    """Return whether a place is in a file that an author can edit."""
    return span is not None and not is_library(span.file)


def _files_of(module: Module) -> set[str]:
    """Return the author's files: of functions and statements, not of expressions.

    Equal expressions are one object, which may have the place of another scene's.
    """
    spans = [f.span for f in module.functions]
    spans += [stmt.span for f in module.functions for stmt in statements_in(f.body)]
    return {span.file for span in spans if span is not None and not is_library(span.file)}


def author_place(module: Module, function: str) -> Span | None:
    """Return the place of a function in the author's code, or the nearest that calls it.

    Args:
        module: The module.
        function: The name of one of its functions.

    Returns:
        The place; None if the author wrote none of the functions from there to the entry.
    """
    files = _files_of(module)
    functions = {f.name: f for f in module.functions}
    callers = defaultdict(list)
    for each in module.functions:
        for callee in _calls(each):
            callers[callee].append(each)
    names, done = [function], {function}
    for name in names:  # it grows: breadth first, so that the nearest caller is found
        here = functions.get(name)
        if here is not None and is_author_place(here.span):
            return here.span
        for caller in callers[name]:
            if (place := _place_of_call(caller, name, files)) is not None:
                return place
            if caller.name not in done:
                done.add(caller.name)
                names.append(caller.name)
    return None


def place_of_resource(module: Module, resource: str) -> Span | None:
    """Return the place where the author's code reads a texture or buffer, itself or by a call.

    Args:
        module: The module.
        resource: The resource's name.
    """
    files = _files_of(module)
    readers = []
    for function in module.functions:
        for stmt in statements_in(function.body):
            read = [e for e in nodes_in(*expressions(stmt)) if isinstance(e, Resource)]
            if not any(e.name == resource for e in read):
                continue
            readers.append(function.name)
            spans = (*(e.span for e in read if e.name == resource), stmt.span)
            if (place := _first(spans, files)) is not None:
                return place
    return _first((author_place(module, name) for name in dict.fromkeys(readers)), files)


def place_of_uniform(module: Module, uniform: str) -> Span | None:
    """Return the place where the author's code gives or reads a number.

    Of a number of a camera or a light it is the place of the scene, whose functions read it.

    Args:
        module: The module.
        uniform: The uniform's name.
    """
    files = _files_of(module)
    readers = []
    for function in module.functions:
        for stmt in statements_in(function.body):
            for e in nodes_in(*expressions(stmt)):
                if not (isinstance(e, Uniform) and e.name == uniform):
                    continue
                if (place := _first((e.span, stmt.span), files)) is not None:
                    return place
                readers.append(function.name)
    return _first((author_place(module, name) for name in dict.fromkeys(readers)), files)


def _first(spans: Iterable[Span | None], files: Collection[str]) -> Span | None:
    return next((span for span in spans if span is not None and span.file in files), None)


def _calls(function: Function) -> set[str]:
    statements = statements_in(function.body)
    found = (_callee(e) for stmt in statements for e in nodes_in(*expressions(stmt)))
    return {name for name in found if name is not None}


def _callee(e: Expr) -> str | None:
    if isinstance(e, Call):
        return e.function
    return e.name if isinstance(e, FunctionRef) else None


def _place_of_call(caller: Function, callee: str, files: Collection[str]) -> Span | None:
    """Return the author's place of a call: its own, or that of a number that it is given."""
    for stmt in statements_in(caller.body):
        for e in nodes_in(*expressions(stmt)):
            if _callee(e) != callee:
                continue
            place = _first((e.span, stmt.span, *(part.span for part in nodes_in(e))), files)
            if place is not None:
                return place
    return None
