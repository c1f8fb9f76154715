"""Load a lesson's scene and check everything that the lesson says of it.

Input: a lesson. Output: a ``StagedLesson`` with the scene and the values as numbers. Mistakes are
reported at the lesson's line.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from distal.diagnostics import CompileError, LoadError
from distal.example_files import EXAMPLE_PREFIX
from distal.frontend.parsing import parse
from distal.lang.parameter_values import Value
from distal.lessons.document import Goal, Layers, Lesson, Phrases, Try
from distal.lessons.mistakes import choice_hint, mistake
from distal.loading import load, split_source
from distal.scene.viewing.viewable import Viewable, viewable
from distal.source_text import decoded, with_plain_ends


@dataclass(frozen=True, slots=True)
class StagedLesson:
    """A lesson whose scene is loaded and whose values are checked.

    Attributes:
        lesson: The lesson.
        seen: The scene.
        values: The values of each experiment, phrase and goal, by the line of its fence or row.
        goals: The scene of each goal, by the line of its fence.
        views: The names of all views that the lesson shows; the first is shown first.
        source: The text of the scene's file.
    """

    lesson: Lesson
    seen: Viewable
    values: Mapping[int, dict[str, Value]]
    goals: Mapping[int, Viewable]
    views: tuple[str, ...]
    source: str


def staged(lesson: Lesson) -> StagedLesson:
    """Load the scene of a lesson and check its values, views and names.

    Raises:
        CompileError: Something that the lesson says of its scene is wrong, or the scene itself is.
    """
    seen = _scene(lesson, lesson.head.scene, lesson.head_lines.get("scene", 1))
    values: dict[int, dict[str, Value]] = {}
    goals: dict[int, Viewable] = {}
    views = dict.fromkeys([_view(lesson, seen, lesson.head.view, lesson.head_lines.get("view", 1))])
    for part in lesson.parts:
        match part:
            case Try():
                if not part.watch:
                    hint = "write :::watch below it, and what the reader will see"
                    raise _fail(lesson, part.line, "this experiment does not say its effect", hint)
                values[part.line] = _values(lesson, seen, part.values, part.line)
                if part.view:
                    views[_view(lesson, seen, part.view, part.line)] = None
            case Phrases():
                for row in part.rows:
                    values[row.line] = _values(lesson, seen, row.values, row.line)
            case Layers():
                for view in part.views.values():
                    views[_view(lesson, seen, view, part.line)] = None
            case Goal():
                values[part.line] = _values(lesson, seen, part.values, part.line)
                goals[part.line] = _scene(lesson, part.file, part.line)
    views["color"] = None
    source = _source(seen)
    known = _definitions(source)
    for name in lesson.head.code:
        if name not in known:
            line = lesson.head_lines.get("code", 1)
            message = f"the scene's file does not define '{name}'"
            raise _fail(lesson, line, message, choice_hint(name, known))
    return StagedLesson(lesson, seen, values, goals, tuple(views), source)


def _fail(lesson: Lesson, line: int, message: str, hint: str | None = None) -> CompileError:
    return mistake(str(lesson.file), lesson.lines, line, message, hint)


def _scene(lesson: Lesson, name: str, line: int) -> Viewable:
    path, wanted = split_source(name)
    if not path.startswith(EXAMPLE_PREFIX):
        folder = lesson.file.resolve().parent
        file = (folder / path).resolve()
        if not file.is_relative_to(folder):
            hint = "keep a lesson and its scenes in one folder, or use example:NAME"
            raise _fail(lesson, line, f"'{name}' is not in the lesson's folder", hint)
        # As the author would write it, so that messages name it so.
        path = str(lesson.file.parent / path)
    try:
        seen = viewable(load(path, wanted), None, lesson.head.time)
    except LoadError as error:
        hint = "name a .py file in the lesson's folder, or example:NAME"
        raise _fail(lesson, line, str(error), hint) from error
    if seen.keeps_frames:
        message = f"'{name}' reads earlier frames or keys, which a lesson's picture has not"
        raise _fail(lesson, line, message, "show it on a page: distal export FILE -o page.html")
    return seen


def _view(lesson: Lesson, seen: Viewable, name: str, line: int) -> str:
    try:
        seen.image(name)
    except ValueError:
        hint = choice_hint(name, seen.views)
        raise _fail(lesson, line, f"there is no view '{name}'", hint) from None
    return name


def _values(
    lesson: Lesson, seen: Viewable, texts: Mapping[str, str], line: int
) -> dict[str, Value]:
    known = {parameter.name: parameter for parameter in seen.parameters}
    values = {}
    for name, text in texts.items():
        if name not in known:
            hint = choice_hint(name, known)
            raise _fail(lesson, line, f"there is no parameter '{name}'", hint)
        try:
            values[name] = known[name].parse(text)
        except ValueError as error:
            raise _fail(lesson, line, f"'{name}': {error}", "write a value in range") from None
    return values


def _source(seen: Viewable) -> str:
    file = seen.file
    return with_plain_ends(decoded(Path(file).read_bytes())) if file is not None else ""


def _definitions(source: str) -> dict[str, ast.stmt]:
    """Return the statements at the top of a file by the names that they define."""
    found: dict[str, ast.stmt] = {}
    for statement in parse(source).body:
        if isinstance(statement, ast.FunctionDef | ast.ClassDef):
            found[statement.name] = statement
        elif isinstance(statement, ast.Assign):
            for target in ast.walk(ast.Module([ast.Expr(t) for t in statement.targets], [])):
                if isinstance(target, ast.Name):
                    found[target.id] = statement
    return found


def folded(source: str, shown: tuple[str, ...]) -> list[tuple[str, int, bool]]:
    """Return the parts of a file: text, number of its first line, whether it is shown unfolded.

    Args:
        source: The text of the file.
        shown: The names whose definitions are shown.
    """
    lines = source.splitlines()
    found = _definitions(source)
    ranges = sorted({_lines(found[name]) for name in shown})
    parts = []
    at = 1
    for first, last in ranges:
        if any(line.strip() for line in lines[at - 1 : first - 1]):
            parts.append(("\n".join(lines[at - 1 : first - 1]).strip("\n"), at, False))
        parts.append(("\n".join(lines[first - 1 : last]), first, True))
        at = last + 1
    if any(line.strip() for line in lines[at - 1 :]):
        parts.append(("\n".join(lines[at - 1 :]).strip("\n"), at, False))
    return parts


def _lines(statement: ast.stmt) -> tuple[int, int]:
    decorators = getattr(statement, "decorator_list", [])
    first = min([statement.lineno, *(d.lineno for d in decorators)])
    return first, statement.end_lineno or statement.lineno
