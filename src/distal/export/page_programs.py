"""The programs of a page: compiled texts and the data that they read, as plain JSON values.

Input: the images of a viewable object. Output: a program for each, which share textures and
buffers. Does not depend on HTML.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from pathlib import PurePath
from typing import TYPE_CHECKING, Any, Final

import distal
from distal.backends import emit, get_target
from distal.backends.base import Artifact
from distal.compiler.driver import run_passes
from distal.diagnostics import CompileError
from distal.export.tables import plain_resource, table
from distal.frontend import lower
from distal.ir.nodes import Module
from distal.ir.types import TEXTURE_2D, Buffer, Texture
from distal.lang.composed import Composed
from distal.lang.functions import Func, Image
from distal.lang.lazy_module import LazyModule
from distal.lang.live_textures import ImageInput, SoundFile, keyboard, microphone
from distal.lang.runtime_access import executor
from distal.passes.entry import FRAME_OFFSET
from distal.render import photons
from distal.render.live_film import FILM
from distal.scene.viewing.guide import Guide
from distal.scene.viewing.viewable import COLOR, Viewable

if TYPE_CHECKING:
    from distal.export import resources
else:
    resources = LazyModule("distal.export.resources")  # needs NumPy

PACKAGE: Final = PurePath(distal.__file__).parent
TARGET: Final = "glsl-es300"
_COMMENT: Final = re.compile(r"\s*//.*$")

Places = tuple[tuple[str, int] | None, ...]
Compile = Callable[[Func | Composed], tuple[Artifact, Module]]


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
        found = self._found_name(source)
        assert found is not None
        return found

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
    return framed(lower(image.emitted() if isinstance(image, Composed) else image))


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
