"""Write changes into a source: a literal, the default of a parameter, the scene's camera.

Input: texts by file, and ``Change`` records. Output: ``Edit`` records with offsets in the texts as
they were, and the new texts. Reads the source by ``ast``; nothing is run.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence
from typing import Final

from distal.editor.literals import (
    LiteralError,
    Positions,
    find_literals,
    literal_at,
    spliced,
    written,
)
from distal.editor.messages import Change, Edit, LiteralValue
from distal.frontend.parsing import parse
from distal.lang.parameters import parameter_name

# The functions of the language that declare a parameter, whose second argument is the default.
_DECLARES: Final = frozenset({"slider", "integer", "toggle", "choice", "color", "point"})


class EditError(ValueError):
    """A change cannot be written; the message says why."""


def edits_of(files: Mapping[str, str], main: str, changes: Sequence[Change]) -> tuple[Edit, ...]:
    """Return the edits that make changes.

    Args:
        files: The texts by name.
        main: The name of the scene's file.
        changes: The changes.

    Raises:
        EditError: A change cannot be written.
    """
    made: list[Edit] = []
    for change in changes:
        try:
            made += _edits_of(files, main, change)
        except (LiteralError, SyntaxError) as error:
            raise EditError(str(error)) from None
    made = list(dict.fromkeys(made))
    for first, second in zip(sorted(made, key=_place), sorted(made, key=_place)[1:], strict=False):
        if first.file == second.file and first.end > second.start:
            raise EditError("two changes are at the same place")
    return tuple(made)


def applied(files: Mapping[str, str], edits: Sequence[Edit]) -> dict[str, str]:
    """Return the texts with edits made."""
    texts = dict(files)
    for edit in sorted(edits, key=_place, reverse=True):
        texts[edit.file] = spliced(texts[edit.file], edit.start, edit.end, edit.text)
    return texts


def _place(edit: Edit) -> tuple[str, int]:
    return edit.file, edit.start


def _edits_of(files: Mapping[str, str], main: str, change: Change) -> list[Edit]:
    file = change.file or main
    if file not in files:
        raise EditError(f"there is no file '{file[:80]}'")
    text = files[file]
    match change:
        case Change(what="literal", start=int(start), end=int(end)) if change.value is not None:
            return [_literal(file, text, (start, end), change.value)]
        case Change(what="parameter", name=str(name)) if change.value is not None:
            return [_parameter(file, text, name, change.value)]
        case Change(what="camera", text=str(camera)):
            return _camera(file, text, camera)
        case _:
            raise EditError(f"a change of a {change.what} lacks what to write")


def _literal(file: str, text: str, at: tuple[int, int], value: LiteralValue) -> Edit:
    found = literal_at(find_literals(file, text), *at)
    return Edit(file=file, start=at[0], end=at[1], text=written(found, text, value))


def _parameter(file: str, text: str, name: str, value: LiteralValue) -> Edit:
    positions = Positions(text)
    for node in ast.walk(parse(text)):
        default = _default_of(node, name)
        if default is not None:
            start, end = positions.span(default)
            try:
                return _literal(file, text, (start, end), value)
            except LiteralError:
                line = default.lineno
                message = f"the default of '{name}' in line {line} is computed, not written"
                raise EditError(message) from None
    raise EditError(f"no declaration of a parameter '{name[:40]}' is in {file}")


def _default_of(node: ast.AST, name: str) -> ast.expr | None:
    """Return the default in the declaration of a parameter."""
    if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Name | ast.Attribute):
        return None
    called = node.func.id if isinstance(node.func, ast.Name) else node.func.attr
    if called not in _DECLARES or not node.args or not isinstance(node.args[0], ast.Constant):
        return None
    by_name = {keyword.arg: keyword.value for keyword in node.keywords}
    label, chosen = node.args[0].value, by_name.get("name")
    try:
        own = parameter_name(label, getattr(chosen, "value", None))
    except (ValueError, TypeError):  # Python reports it
        return None
    if name not in (label, own):
        return None
    return by_name.get("default", node.args[1] if len(node.args) > 1 else None)


def _camera(file: str, text: str, camera: str) -> list[Edit]:
    """Return the edits that place the camera of the last scene of a file."""
    try:
        call = parse(camera, mode="eval").body
    except (SyntaxError, ValueError):
        call = None
    if not isinstance(call, ast.Call):
        raise EditError("a camera is written as a call")
    tree = parse(text)
    scenes = [n for n in ast.walk(tree) if isinstance(n, ast.Call) and _name_of(n) == "Scene"]
    if not scenes:
        raise EditError(f"there is no 'Scene(' in {file}")
    scene, positions = max(scenes, key=lambda n: n.lineno), Positions(text)
    made = _imported(file, tree, positions, ast.unparse(call.func).partition(".")[0])
    for keyword in scene.keywords:
        if keyword.arg == "camera":
            start, end = positions.span(keyword.value)
            return [*made, Edit(file=file, start=start, end=end, text=camera)]
    last = [*scene.args, *(k.value for k in scene.keywords)]
    if not last:
        raise EditError("the scene has no shape")
    end = max(positions.span(value)[1] for value in last)
    return [*made, Edit(file=file, start=end, end=end, text=f", camera={camera}")]


def _name_of(call: ast.Call) -> str:
    return call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")


def _imported(file: str, tree: ast.Module, positions: Positions, name: str) -> list[Edit]:
    """Return the edit that imports a name of distal; none if the file has it."""
    imports = [s for s in tree.body if isinstance(s, ast.ImportFrom) and s.module == "distal"]
    known = {
        a.asname or a.name
        for s in tree.body
        if isinstance(s, ast.ImportFrom | ast.Import)
        for a in s.names
    }
    if name in known or "*" in known or not imports:
        return []
    first = imports[0].names[0]
    at = positions.offset(first.lineno, first.col_offset)
    return [Edit(file=file, start=at, end=at, text=f"{name}, ")]
