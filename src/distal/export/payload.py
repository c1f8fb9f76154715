"""Build the data for a page's player: programs, parameters and resources as plain JSON values.

Input: a viewable object. Output: the payload, a dictionary for JSON. Does not depend on HTML. The
player's side of the format is ``web/src/payload.ts``.
"""

from __future__ import annotations

import ast
import base64
import json
import re
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import PurePath
from typing import TYPE_CHECKING, Any, Final

import distal
from distal.backends import emit, get_target
from distal.backends.base import Artifact
from distal.compiler.driver import run_passes
from distal.diagnostics import CompileError
from distal.export.page_options import PageOptions
from distal.export.pasted_code import code_around
from distal.export.tables import plain_resource, table
from distal.fields.library import OPERATORS
from distal.frontend import lower
from distal.ir.nodes import Module
from distal.ir.types import TEXTURE_2D, Buffer, Texture
from distal.lang.chosen_values import checked_values
from distal.lang.composed import Composed
from distal.lang.functions import Func, Image
from distal.lang.lazy_module import LazyModule
from distal.lang.live_textures import ImageInput, SoundFile, keyboard, microphone
from distal.lang.parameters import Parameter
from distal.lang.runtime_access import executor
from distal.passes.entry import FRAME_OFFSET
from distal.render import photons
from distal.render.live_film import FILM
from distal.scene.viewing.guide import Guide
from distal.scene.viewing.viewable import COLOR, Viewable, view_label
from distal.version import __version__

if TYPE_CHECKING:
    from distal.export import resources
else:
    resources = LazyModule("distal.export.resources")  # needs NumPy

PACKAGE: Final = PurePath(distal.__file__).parent
FORMAT: Final = 1
TARGET: Final = "glsl-es300"
# Generic names; the name of the scene's file is more informative.
# An operator's name says nothing to those who see a page: "Union".
_PLAIN_NAMES: Final = frozenset({"scene", "picture", "shape", "image", "main", *OPERATORS})
_COMMENT: Final = re.compile(r"\s*//.*$")

Places = tuple[tuple[str, int] | None, ...]


Compile = Callable[[Func | Composed], tuple[Artifact, Module]]


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
        packed: Whether to compress the programs.
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
        "resources": programs.resources,
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
        return seen.file.stem.replace("_", " ")
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
        return ast.get_docstring(ast.parse(seen.file.read_text(encoding="utf-8"))) or ""
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
    press = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS, 9)
    packed = base64.b64encode(press.compress(text.encode()) + press.flush()).decode("ascii")
    if len(packed) < len(plain):
        return {"encoding": "deflate-raw", "data": packed}
    return _plain_programs(programs)


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


class PagePrograms:
    """The programs of a scene's views; shared data is stored once.

    Attributes:
        made: The programs.
        files: The names of the author's files, without folders.
        resources: Textures and buffers by name.
    """

    def __init__(self, seen: Viewable, compile: Compile | None = None) -> None:
        self._seen = seen
        self._compile = compile or compiled
        self.made: list[dict[str, Any]] = []
        self.files: list[str] = []
        self.resources: dict[str, Any] = {}
        self._names: dict[tuple[int, str], str] = {}  # resource -> its name in all programs
        self._image_inputs: list[dict[str, str]] = []
        self._sounds: dict[SoundFile, str] = {}

    def add(self, view: str) -> int:
        """Add the program of a view and return its index.

        Raises:
            CompileError: WebGL 2 cannot show it.
            LoadError: The data of a texture cannot be read.
        """
        scene = self._seen.steers
        # Of a scene, the player takes several samples where the picture rests.
        sampled = self._seen.is_sampled(view)
        return self.add_image(self._seen.image(view, steered=scene, encoded=True, sampled=sampled))

    def add_film(self, added: Composed, shown: Composed) -> dict[str, Any]:
        """Add the programs of a picture by paths; return their indices and the film's name.

        Args:
            added: The program that adds a pass to the film.
            shown: The program that shows the film.

        Raises:
            CompileError: WebGL 2 cannot run them.
        """
        trace, show = (self.add_image(image) for image in (added, shown))
        name = self._resource("Film", FILM, TEXTURE_2D)
        made: dict[str, Any] = {"trace": trace, "show": show, "name": name}
        if added.photons is not None:
            made["photons"] = self._photons(added.photons)
        return made

    def add_frames(self) -> dict[str, Any]:
        """Add the programs that each frame draws before the picture; return their indices."""
        image = self._seen.image(COLOR, encoded=True)
        read = executor().parts(image).read
        passes = [self._frame_pass(buffer) for buffer in read.buffers]
        itself = None if read.itself is None else self._frame_pass(read.itself)
        return {
            "passes": passes,
            "itself": itself,
            "keyboard": self._found_name(keyboard),
            "microphone": self._found_name(microphone),
            "sounds": [resources.sound(name, source) for source, name in self._sounds.items()],
            "images": self._image_inputs,
        }

    def _frame_pass(self, image: Image) -> dict[str, Any]:
        number = self.add_image(image)
        name = self._resource(image.name, image.last_frame, TEXTURE_2D)
        return {"program": number, "name": name}

    def _found_name(self, source: Any) -> str | None:
        """Return the name of a resource; None if no program reads it."""
        return next((name for (key, _), name in self._names.items() if key == id(source)), None)

    def _photons(self, programs: tuple[Composed, Composed]) -> dict[str, Any]:
        """Add the programs of photons; return their indices, tables and numbers."""
        plan, deposits = (self.add_image(image) for image in programs)
        tables = (photons.PLACES, photons.ARRIVALS, photons.STARTS)
        return {
            "plan": plan,
            "deposits": deposits,
            "tables": [self.name_of(table) for table in tables],
            "of_sample": photons.OF_A_SAMPLE,
            "fewest": photons.FEWEST,
            "most": photons.MOST_OF_A_PAGE,
        }

    def name_of(self, source: Any) -> str:
        """Return the name of a resource that a program already reads."""
        return next(name for (key, _), name in self._names.items() if key == id(source))

    def add_guide(self, guide: Guide) -> int:
        """Add the program that guides the camera; -1 if WebGL 2 cannot run it."""
        try:
            return self.add_image(guide.image)
        except CompileError:
            return -1

    def add_image(self, image: Func | Composed) -> int:
        """Add the program of an image and return its index.

        Raises:
            CompileError: WebGL 2 cannot run it.
        """
        artifact, module = self._compile(image)
        program = self.program(artifact, module)
        if program not in self.made:
            self.made.append(program)
        return self.made.index(program)

    def program(self, artifact: Artifact, module: Module) -> dict[str, Any]:
        """Return a program as a page has it."""
        assert artifact.vertex is not None
        interface = artifact.interface
        names = {r.name: self._resource(r.name, r.source, r.type) for r in module.resources}
        names |= {e["name"]: self._table(e) for e in interface["buffers"] if "values" in e}
        fragment, lines = self._lean(artifact.text, artifact.lines)
        vertex, vertex_lines = self._lean(artifact.vertex, artifact.vertex_lines)
        return {
            "vertex": vertex,
            "fragment": fragment,
            "uniforms": [_uniform(entry) for entry in interface["uniforms"]],
            "textures": [
                {key: entry[key] for key in ("uniform", "type", "wrap", "filter")}
                | {"name": names[entry["name"]]}
                for entry in interface["textures"]
            ],
            "buffers": [
                {key: entry[key] for key in ("uniform", "count", "element")}
                | {"name": names[entry["name"]]}
                for entry in interface["buffers"]
            ],
            "trust": interface["trust"],
            "lines": lines,
            "vertex_lines": vertex_lines,
        }

    def _resource(self, name: str, source: Any, type: Any) -> str:
        """Return a resource's name in the payload; equal names in two views may differ there."""
        key = (id(source), str(type))
        if key not in self._names:
            if isinstance(source, SoundFile):
                self._sounds[source] = name
            if isinstance(source, ImageInput):
                self._image_inputs.append({"name": name, "wrap": source.wrap})
            assert isinstance(type, Texture | Buffer)
            made = plain_resource(source, type) or resources.resource(source, type)
            self._names[key] = self._added(name, made)
        return self._names[key]

    def _table(self, entry: Mapping[str, Any]) -> str:
        """Return the name of a table of the program, added as a buffer; equal tables are shared."""
        made = table(entry)
        for name, known in self.resources.items():
            if known == made:
                return name
        return self._added(entry["name"], made)

    def _added(self, name: str, made: dict[str, Any]) -> str:
        free, count = name, 2
        while free in self.resources:
            free, count = f"{name}_{count}", count + 1
        self.resources[free] = made
        return free

    def _lean(self, text: str, places: Places) -> tuple[str, list[list[int]]]:
        """Return a text without comments, empty lines and indentation, and the lines' origins."""
        kept: list[str] = []
        origins: list[list[int]] = []
        for line, place in zip(text.splitlines(), places, strict=True):
            bare = _COMMENT.sub("", line).strip()
            if not bare:
                continue
            kept.append(bare)
            if place is None or _is_library(place[0]):
                continue
            number, origin = len(kept), [self._file(place[0]), place[1]]
            if origins and origins[-1][1:] == [number - 1, *origin]:
                origins[-1][1] = number
            else:
                origins.append([number, number, *origin])
        return "\n".join(kept) + "\n", origins

    def _file(self, path: str) -> int:
        name = PurePath(path).name
        if name not in self.files:
            self.files.append(name)
        return self.files.index(name)


@cache
def _is_library(file: str) -> bool:
    """Return whether a line is part of distal: no author edits it, and half of all lines are."""
    path = PurePath(file)
    return path.is_relative_to(PACKAGE) and not path.is_relative_to(PACKAGE / "gallery")


def compiled(image: Func | Composed) -> tuple[Artifact, Module]:
    """Return the compiled text of a picture, and its module, which has the data of textures."""
    module = lowered(image)
    return compiled_module(module), module


def lowered(image: Func | Composed) -> Module:
    """Return the IR of a picture for a page, before the passes."""
    return framed(lower(image.text() if isinstance(image, Composed) else image))


def framed(module: Module) -> Module:
    """Return the IR of a picture with the input that a page adds."""
    # The picture fills the page, the author's frame the part of it that nothing covers.
    return replace(module, uniforms=(*module.uniforms, FRAME_OFFSET))


def compiled_module(module: Module) -> Artifact:
    """Return the text of a picture's module."""
    target = get_target(TARGET)
    return emit(run_passes(module, target), target)


def _uniform(entry: dict[str, Any]) -> dict[str, Any]:
    """Return a uniform's entry, with the name by which a person sets it."""
    return {
        "name": entry.get("parameter", entry["name"]),
        "uniform": entry["uniform"],
        "type": entry["type"],
        "origin": entry["origin"],
        "default": entry["default"],
    }
