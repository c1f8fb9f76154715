"""Build the data for a page's player: programs, parameters and resources as plain JSON values.

Input: a viewable object. Output: the payload, a dictionary for JSON. Does not depend on HTML. The
player's side of the format is ``web/src/payload.ts``.
"""

from __future__ import annotations

import ast
import base64
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from distal.deflating import deflated_text
from distal.diagnostics import CompileError, readable
from distal.export.page_options import PageOptions
from distal.export.page_programs import Compile, PagePrograms
from distal.export.pasted_code import code_around
from distal.fields.library import OPERATORS
from distal.frontend.parsing import parse
from distal.lang.chosen_values import checked_values
from distal.lang.functions import Image
from distal.lang.parameters import Parameter
from distal.scene.viewing.viewable import COLOR, Viewable, view_label
from distal.source_text import decoded
from distal.version import __version__

FORMAT: Final = 1
# Generic names; the name of the scene's file is more informative.
# An operator's name says nothing to those who see a page: "Union".
_PLAIN_NAMES: Final = frozenset({"scene", "picture", "shape", "image", "main", *OPERATORS})


@dataclass(frozen=True, slots=True)
class Facts:
    """What a page says of its object besides the programs.

    Attributes:
        parameters: The parameters.
        animated: Whether the picture depends on the time.
    """

    parameters: Sequence[Parameter]
    animated: bool


def payload(
    seen: Viewable,
    options: PageOptions,
    omit: Callable[[str, CompileError], None] | None = None,
    compile: Compile | None = None,
    *,
    packed: bool = True,
    facts: Facts | None = None,
    guided: bool = True,
    variable: str | None = None,
    more: Callable[[PagePrograms, str], dict[str, Any]] | None = None,
) -> dict[str, Any]:
    """Return all data that the player needs.

    Args:
        seen: The object to show.
        options: The options of the page.
        omit: Called with the name and error of each view that WebGL 2 cannot show.
        variable: The variable that holds the object in a notebook; None if that is not known.
        compile: Compiles each program; None: ``compiled``.
        packed: Whether to compress the programs and the numbers of resources.
        facts: What is known of the object; None: what ``seen`` finds out.
        guided: Whether the camera's guide is among the programs.
        more: Adds programs; returns further entries. It gets the programs and the page's name.

    Raises:
        CompileError: WebGL 2 cannot show the first view.
        ValueError: There is no such view or parameter, or a value is out of range.
    """
    programs = PagePrograms(seen, compile)
    shown = []
    for name in view_names(seen, options):
        try:
            number = programs.add(name)
        except CompileError as error:
            if name == options.view:
                raise
            if omit is not None:
                omit(name, error)
            continue
        shown.append({"name": name, "label": view_label(name), "program": number})
        if seen.film is not None and seen.is_traced(name):
            shown[-1]["film"] = programs.add_film(*seen.film)
    name = options.title or name_of(seen)
    facts = facts or Facts(seen.parameters, seen.animated)
    further = {} if more is None else more(programs, name)
    if seen.keeps_frames:
        further = {**further, "frames": programs.add_frames()}
    return {
        **further,
        "format": FORMAT,
        "distal": __version__,
        "name": name,
        "code": code_around(seen, options.size, variable),
        "description": description_of(seen, name),
        "size": list(options.size),
        "embed": options.embed,
        "panel": options.panel and not options.embed,
        "steering": _steering(seen, programs, guided=guided),
        "time": {
            "start": options.time,
            "duration": options.duration,
            "animated": facts.animated,
        },
        "parameters": [parameter_entry(p) for p in facts.parameters],
        "values": _start_values(facts.parameters, options.params),
        "views": shown,
        "view": options.view,
        "poster": None,
        "files": programs.files,
        "programs": _packed(programs.made) if packed else _plain_programs(programs.made),
        "resources": _smaller(programs.resources) if packed else programs.resources,
    }


def view_names(seen: Viewable, options: PageOptions) -> list[str]:
    """Return the names of the views that a page is asked to have."""
    names = list(dict.fromkeys(options.views or seen.views))
    return names if options.view in names else [options.view, *names]


def _steering(seen: Viewable, programs: PagePrograms, *, guided: bool) -> dict[str, Any] | None:
    """Return what the player needs to move the camera; ``guide`` is a program's index, or -1."""
    if seen.guide is None:
        return None
    form = seen.guide.form
    camera = {"name": form.name, "mirror": form.mirror, "extent": form.extent}
    guide = programs.add_guide(seen.guide) if guided else -1
    return {"elevation": seen.elevation, "guide": guide, "camera": camera}


def name_of(seen: Viewable) -> str:
    """Return the name for people: the object's own, or that of its file if its own is generic."""
    if seen.name in _PLAIN_NAMES and seen.file is not None:
        return readable(seen.file.stem).replace("_", " ")
    return seen.name.replace("_", " ")


def description_of(seen: Viewable, name: str) -> str:
    """Return one sentence for people who cannot see it: the author's, or one with the name."""
    text = _documentation(seen).strip()
    if text:
        return " ".join(text.split("\n\n")[0].split()).replace("``", "")
    return f"{name}: a picture drawn live."


def _documentation(seen: Viewable) -> str:
    """Return the docstring of an image's function, or else that of its file."""
    image = seen.image(COLOR)
    if isinstance(image, Image) and image.python_function.__doc__:
        return image.python_function.__doc__
    if seen.file is None:
        return ""
    try:
        return ast.get_docstring(parse(decoded(seen.file.read_bytes()))) or ""
    except (OSError, ValueError, SyntaxError):  # edited or deleted since it was loaded
        return ""


def _start_values(
    parameters: Sequence[Parameter], params: Mapping[str, Any] | None
) -> dict[str, Any]:
    """Return the values that differ from the defaults, by name, as JSON values.

    Raises:
        ValueError: There is no such parameter, or a value is out of range.
        TypeError: A value has the wrong type.
    """
    defaults = {p.name: p.default for p in parameters}
    chosen = checked_values(parameters, params)
    return {name: _plain(v) for name, v in chosen.items() if v != defaults[name]}


def parameter_entry(parameter: Parameter) -> dict[str, Any]:
    """Return the declaration of a parameter."""
    return {
        "name": parameter.name,
        "default": _plain(parameter.default),
        **{key: _plain(value) for key, value in parameter.interface},
    }


def _plain(value: Any) -> Any:
    return [_plain(v) for v in value] if isinstance(value, tuple | list) else value


def _plain_programs(programs: list[dict[str, Any]]) -> dict[str, Any]:
    return {"encoding": "plain", "data": programs}


def _packed(programs: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the programs, compressed by deflate if that is smaller.

    They are compressed field by field, and the texts function by function: programs of one scene
    have most of their functions in common, and deflate refers back by at most 32 kB. Nine views of
    the bunny take 50 kB instead of 99 kB.
    """
    plain = json.dumps(programs, separators=(",", ":"))
    columns: dict[str, Any] = {key: [p[key] for p in programs] for key in programs[0]}
    parts: dict[str, int] = {}
    for key in ("vertex", "fragment"):
        columns[key] = [
            [parts.setdefault(part, len(parts)) for part in _functions(text)]
            for text in columns[key]
        ]
    text = json.dumps({"parts": list(parts), **columns}, separators=(",", ":"))
    packed = deflated_text(text.encode())
    if len(packed) < len(plain):
        return {"encoding": "deflate-raw", "data": packed}
    return _plain_programs(programs)


def _smaller(resources: Mapping[str, dict[str, Any]]) -> dict[str, Any]:
    """Return textures and buffers with their numbers compressed, where that saves a tenth."""
    found: dict[str, Any] = {}
    for name, entry in resources.items():
        data = deflated_text(base64.b64decode(entry["data"]))
        is_smaller = len(data) < 0.9 * len(entry["data"])
        found[name] = {**entry, "packed": True, "data": data} if is_smaller else entry
    return found


def _functions(text: str) -> Iterator[str]:
    """Yield the parts of a text: one for each function or struct with what stands before it."""
    lines: list[str] = []
    depth = 0
    for line in text.splitlines(keepends=True):
        lines.append(line)
        opened, closed = line.count("{"), line.count("}")
        depth += opened - closed
        if depth == 0 and closed:
            yield "".join(lines)
            lines = []
    if lines:
        yield "".join(lines)
