"""Read a lesson's file: TOML between ``+++``, then Markdown with fences ``:::NAME``.

Input: a path, or a text. Output: a ``Lesson``. Does not load the scene: ``scenes`` does. A fence
ends at a line ``:::``; fences of code are skipped.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields, replace
from pathlib import Path
from typing import Any, Final

from distal.diagnostics import CompileError, LoadError
from distal.foreign_files import opened
from distal.lessons.document import (
    GOAL_WITHIN,
    LAYERS,
    LEAST_DIFFERENCE,
    Goal,
    Head,
    Layers,
    Lesson,
    Part,
    Phrase,
    Phrases,
    Prose,
    Try,
)
from distal.lessons.mistakes import choice_hint, mistake
from distal.source_text import with_plain_ends

_RULE: Final = "+++"
_FENCE_LINE: Final = re.compile(r"^:::\s*(\S*)\s*(.*?)\s*$")
_CODE: Final = re.compile(r"^ {0,3}(`{3,}|~{3,})")
_ATTRIBUTE: Final = re.compile(r'([A-Za-z_]\w*)=(?:"([^"]*)"|([^\s"]+))(?:\s+|$)')
# A comma separates values only where another name follows: a point has commas of its own.
_NEXT_VALUE: Final = re.compile(r"[,;]\s*(?=[A-Za-z_]\w*\s*=)")
_TOML_LINE: Final = re.compile(r"at line (\d+)")


def read(path: str | Path) -> Lesson:
    """Read a lesson.

    Raises:
        LoadError: The file cannot be read.
        CompileError: The file is not a valid lesson.
    """
    file = Path(path)
    with opened("lesson", file) as data:
        try:
            text = with_plain_ends(data.decode("utf-8-sig"))
        except UnicodeDecodeError:
            raise LoadError("it is not text in UTF-8") from None
        return parse(text, file)


def parse(text: str, file: Path) -> Lesson:
    """Parse a lesson's text; ``file`` is its name in messages.

    Raises:
        CompileError: The text is not a valid lesson.
    """
    return _LessonReader(text, file).lesson()


@dataclass(frozen=True, slots=True)
class _Fence:
    """A fence: its name, its attributes, and the text inside with the line before it."""

    name: str
    line: int
    attributes: dict[str, str]
    body: tuple[str, ...]

    @property
    def text(self) -> str:
        return "\n".join(self.body).strip()


class _LessonReader:
    """One lesson's text while it is read."""

    def __init__(self, text: str, file: Path) -> None:
        self.file = file
        self.lines = tuple(text.removeprefix("\ufeff").splitlines())
        self.parts: list[Part] = []

    def fail(self, line: int, message: str, hint: str | None = None) -> CompileError:
        return mistake(str(self.file), self.lines, line, message, hint)

    def lesson(self) -> Lesson:
        settings, lines_of, start = self._settings()
        head = self._head(settings, lines_of)
        self._body(start)
        if not any(isinstance(part, Prose) for part in self.parts):
            raise self.fail(start, "the lesson has no text", "write it below the closing +++")
        return Lesson(self.file, self.lines, head, lines_of, tuple(self.parts))

    # The head

    def _settings(self) -> tuple[dict[str, Any], dict[str, int], int]:
        """Return the settings, their lines, and the number of the closing rule's line."""
        if not self.lines or self.lines[0].strip() != _RULE:
            raise self.fail(
                1, "a lesson begins with its settings", "write +++, settings in TOML, and +++"
            )
        ends = [i for i, line in enumerate(self.lines) if i and line.strip() == _RULE]
        if not ends:
            raise self.fail(1, "the settings do not end", "write +++ alone on the line after them")
        end = ends[0]
        try:
            settings = tomllib.loads("\n".join(self.lines[1:end]))
        except tomllib.TOMLDecodeError as error:
            found = _TOML_LINE.search(str(error))
            line = int(found[1]) + 1 if found else end
            reason = str(error).partition(" (")[0]
            hint = 'write NAME = VALUE, and texts in quotes: title = "Marching"'
            raise self.fail(line, f"this is not TOML: {reason}", hint) from None
        lines_of = {
            name.strip(): i + 1
            for i, line in enumerate(self.lines[1:end], 1)
            for name in [line.partition("=")[0]]
            if name.strip() in settings
        }
        return settings, lines_of, end + 1

    def _head(self, settings: Mapping[str, Any], lines_of: Mapping[str, int]) -> Head:
        known = {field.name: field for field in fields(Head)}
        for name in settings:
            if name not in known:
                line = lines_of.get(name, 1)
                raise self.fail(line, f"there is no setting '{name}'", choice_hint(name, known))
        for name, field in known.items():
            if name not in settings and field.default is MISSING:
                raise self.fail(1, f"the setting '{name}' is missing", _EXAMPLES[name])
        values = {
            name: self._setting(name, value, lines_of.get(name, 1))
            for name, value in settings.items()
        }
        return Head(**values)

    def _setting(self, name: str, value: Any, line: int) -> Any:
        check, what = _SETTINGS[name]
        if not check(value):
            raise self.fail(line, f"'{name}' is {what}, not {value!r:.60}", _EXAMPLES[name])
        return tuple(value) if isinstance(value, list) else value

    # The body

    def _body(self, start: int) -> None:
        prose: list[str] = []
        first = start + 1
        number, code = start, ""
        while number < len(self.lines):
            line = self.lines[number]
            number += 1
            fence = _CODE.match(line)
            if fence and (not code or fence[1].startswith(code)):
                code = "" if code else fence[1]
            if code or not line.startswith(":::"):
                prose.append(line)
                continue
            self._prose(prose, first)
            number = self._block(number)
            prose, first = [], number + 1
        self._prose(prose, first)

    def _prose(self, lines: Sequence[str], first: int) -> None:
        if any(line.strip() for line in lines):
            self.parts.append(Prose(first, "\n".join(lines)))

    def _block(self, line: int) -> int:
        """Read the fence that opens at a line; return the line where it ends."""
        found = _FENCE_LINE.match(self.lines[line - 1])
        assert found is not None
        name, rest = found[1], found[2]
        if not name:
            raise self.fail(line, "this fence closes nothing", "write :::try or remove the line")
        if name not in _BLOCKS:
            raise self.fail(line, f"there is no fence ':::{name}'", choice_hint(name, _BLOCKS))
        end = line
        while end < len(self.lines) and self.lines[end].rstrip() != ":::":
            if self.lines[end].startswith(":::"):
                hint = f"write ::: alone on a line before line {end + 1}"
                raise self.fail(line, f"':::{name}' is not closed", hint)
            end += 1
        if end == len(self.lines):
            hint = "write ::: alone on the line after its text"
            raise self.fail(line, f"':::{name}' is not closed", hint)
        attributes = self._attributes(line, name, rest)
        block = _Fence(name, line, attributes, self.lines[line:end])
        _BLOCKS[name].read(self, block)
        return end + 1

    def _attributes(self, line: int, name: str, text: str) -> dict[str, str]:
        taken = _BLOCKS[name]
        attributes: dict[str, str] = {}
        at = 0
        while at < len(text):
            found = _ATTRIBUTE.match(text, at)
            if not found:
                hint = f'write NAME="VALUE": :::{name} {taken.example}'.rstrip()
                raise self.fail(line, f"'{text[at:]:.40}' is not an attribute", hint)
            key, value = found[1], found[2] if found[3] is None else found[3]
            if key not in taken.attributes:
                hint = choice_hint(key, taken.attributes)
                raise self.fail(line, f"':::{name}' has no attribute '{key}'", hint)
            attributes[key] = value
            at = found.end()
        for key in taken.required:
            if not attributes.get(key):
                hint = f"write :::{name} {taken.example}"
                raise self.fail(line, f"':::{name}' needs the attribute '{key}'", hint)
        return attributes

    def values(self, text: str, line: int) -> dict[str, str]:
        """Parse ``name=value, name=value``."""
        values: dict[str, str] = {}
        for item in _NEXT_VALUE.split(text) if text.strip() else ():
            name, equals, value = item.partition("=")
            if not equals or not name.strip() or not value.strip():
                hint = 'write NAME=VALUE, with commas between: "max_steps=16, blend=0.5"'
                raise self.fail(line, f"'{item.strip():.40}' is not a value", hint)
            values[name.strip()] = value.strip()
        return values

    def number(self, block: _Fence, key: str, default: float) -> float:
        """Return an attribute that is a share between 0 and 1."""
        text = block.attributes.get(key)
        if text is None:
            return default
        try:
            number = float(text)
        except ValueError:
            number = -1.0
        if not 0.0 < number < 1.0:
            message = f"'{key}' is a number between 0 and 1, not '{text:.20}'"
            raise self.fail(block.line, message, f'write {key}="{default}"')
        return number

    # One method for each fence

    def read_try(self, block: _Fence) -> None:
        title = block.attributes["title"]
        values = self.values(block.attributes.get("values", ""), block.line)
        view = block.attributes.get("view", "")
        if not values and not view:
            hint = 'write values="max_steps=16" or view="steps"'
            raise self.fail(block.line, "this experiment changes nothing", hint)
        least = self.number(block, "least", LEAST_DIFFERENCE)
        self.parts.append(Try(block.line, title, values, block.text, "", view, least))

    def read_watch(self, block: _Fence) -> None:
        last = self.parts[-1] if self.parts else None
        if not isinstance(last, Try) or last.watch:
            hint = "put :::watch directly below the ::: of the experiment that it belongs to"
            raise self.fail(block.line, "':::watch' has no experiment", hint)
        if not block.text:
            raise self.fail(block.line, "':::watch' is empty", "write what the reader will see")
        self.parts[-1] = replace(last, watch=block.text)

    def read_phrases(self, block: _Fence) -> None:
        rows = []
        for i, line in enumerate(block.body, block.line + 1):
            if not line.strip():
                continue
            cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
            if len(cells) != 3 or not cells[0]:
                hint = "write PHRASE | NAME=VALUE | WHAT HAPPENS; the second may be empty"
                raise self.fail(i, "a phrase has three parts", hint)
            rows.append(Phrase(i, cells[0], self.values(cells[1], i), cells[2]))
        if not rows:
            hint = "write a line: PHRASE | NAME=VALUE | WHAT HAPPENS"
            raise self.fail(block.line, "':::phrases' is empty", hint)
        self.parts.append(Phrases(block.line, tuple(rows)))

    def read_layers(self, block: _Fence) -> None:
        if any(isinstance(part, Layers) for part in self.parts):
            hint = "keep one of them: the strip stands below the picture"
            raise self.fail(block.line, "a lesson has one ':::layers'", hint)
        captions = {}
        for i, line in enumerate(block.body, block.line + 1):
            if not line.strip():
                continue
            name, bar, caption = (part.strip() for part in line.partition("|"))
            if not bar or name not in LAYERS:
                hint = f"write LAYER | CAPTION; layers: {', '.join(LAYERS)}"
                raise self.fail(i, "this is not the caption of a layer", hint)
            captions[name] = caption
        views = {name: block.attributes.get(name, name) for name in LAYERS}
        self.parts.append(Layers(block.line, views, captions))

    def read_goal(self, block: _Fence) -> None:
        values = self.values(block.attributes["values"], block.line)
        within = self.number(block, "within", GOAL_WITHIN)
        self.parts.append(Goal(block.line, block.attributes["file"], values, block.text, within))


@dataclass(frozen=True, slots=True)
class _FenceKind:
    """A kind of fence: how it is read, and its attributes."""

    read: Callable[[_LessonReader, _Fence], None]
    attributes: tuple[str, ...] = ()
    required: tuple[str, ...] = ()
    example: str = ""


_BLOCKS: Final[Mapping[str, _FenceKind]] = {
    "try": _FenceKind(
        _LessonReader.read_try,
        ("title", "values", "view", "least"),
        ("title",),
        'title="Too few steps" values="max_steps=16"',
    ),
    "watch": _FenceKind(_LessonReader.read_watch),
    "phrases": _FenceKind(_LessonReader.read_phrases),
    "layers": _FenceKind(_LessonReader.read_layers, LAYERS, (), 'signal="steps"'),
    "goal": _FenceKind(
        _LessonReader.read_goal,
        ("file", "values", "within"),
        ("file", "values"),
        'file="solution.py" values="radius=0.5"',
    ),
}


def _is_text(value: Any) -> bool:
    return isinstance(value, str) and bool(value.strip())


def _is_whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and value > 0


def _is_time(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and value >= 0


_SETTINGS: Final[Mapping[str, tuple[Callable[[Any], bool], str]]] = {
    "number": (_is_whole, "a whole number from 1"),
    "title": (_is_text, "a text"),
    "summary": (_is_text, "a text"),
    "scene": (_is_text, "a file or example:NAME"),
    "size": (
        lambda v: isinstance(v, list) and len(v) == 2 and all(map(_is_whole, v)),
        "a width and a height",
    ),
    "time": (_is_time, "a number of seconds"),
    "view": (_is_text, "the name of a view"),
    "code": (lambda v: isinstance(v, list) and all(map(_is_text, v)), "a list of names"),
    "source": (_is_text, "a text"),
}
_EXAMPLES: Final[Mapping[str, str]] = {
    "number": "write number = 6",
    "title": 'write title = "Melting shapes"',
    "summary": 'write summary = "Two shapes become one."',
    "scene": 'write scene = "melting.py"',
    "size": "write size = [480, 360]",
    "time": "write time = 1.5",
    "view": 'write view = "color"',
    "code": 'write code = ["scene", "march"]',
    "source": 'write source = "Where the lesson comes from"',
}
