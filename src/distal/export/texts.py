"""Export a picture as a shader text, with a comment that explains how to use it.

Input: a viewable object, or a compiled text. Output: files. The functions for the comment need the
standard library only, because ``distal compile`` uses them too.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from distal.backends import TEXT_TARGETS
from distal.backends.base import Artifact
from distal.backends.clike.module_text import comment_text
from distal.backends.glsl import isf
from distal.backends.targets import Declares
from distal.compiler.driver import TEXT_TABLE_FROM, text_of
from distal.diagnostics import readable
from distal.export.exported import Exported
from distal.export.host_data import refuse_passes, with_data
from distal.export.page_options import TextOptions
from distal.file_writer import SaveError, replacement
from distal.frontend import lower
from distal.ir.nodes import EntryKind, Module, Origin
from distal.lang.chosen_values import checked_values
from distal.lang.composed import Composed
from distal.lang.lazy_module import LazyModule
from distal.scene.tree.errors import warn
from distal.version import __version__

if TYPE_CHECKING:
    from distal.export import resources
    from distal.scene.viewing.viewable import Viewable
else:
    resources = LazyModule("distal.export.resources")  # needs NumPy

_PARAMETERS: Final = {
    Declares.NOBODY: "constants below, to be edited",
    Declares.PLACE: "inputs",
    Declares.TEXT: "uniforms",
}
_ISF: Final = "isf"
WIDTH: Final = 96


def with_header(artifact: Artifact, target: str, file: str, stem: str = "") -> str:
    """Return a text with a comment in front: its author's file and how to use it.

    Args:
        artifact: The compiled text with its complete interface.
        target: The name of its target.
        file: The name of the author's file, without its folder; may be empty.
        stem: The name of the text's own file, without its suffix.
    """
    described = TEXT_TARGETS.get(target)
    if described is None:
        return artifact.text
    use = described.use
    whose = comment_text(file).replace("*/", "* /") or "A scene"
    lines = [f"{whose}, written by distal {__version__} for {described.place}."]
    if artifact.interface.get("kind") == EntryKind.FUNCTION.value:
        use = "The functions alone: call the last one from a shader of your own."
    lines += _broken(use)
    uniforms = artifact.interface.get("uniforms", ())
    parameters = [u for u in uniforms if u["origin"] == Origin.PARAMETER.value]
    if parameters:
        names = ", ".join(_spelled(u["uniform"]) for u in parameters)
        lines += _broken(f"Parameters ({_PARAMETERS[described.parameters]}): {names}.")
    textures = artifact.interface.get("textures", ())
    read = (*textures, *artifact.interface.get("buffers", ()))
    if described.is_described and read:
        names = ", ".join(entry["uniform"] for entry in read)
        lines += _broken(f"Its data, in the file .json: {names}.")
    for texture in textures if described.textures_by else ():
        name = comment_text(picture_name(texture, stem) or f"{texture['name']} ({texture['live']})")
        lines += _broken(
            f"{texture['uniform']}: {name}, by {described.textures_by}; {texture['wrap']}."
        )
    comment = "\n".join(("/*", *(f" * {line}" for line in lines), " */", ""))
    text = artifact.text
    if described.name == _ISF:
        for texture in textures:
            name = texture["uniform"]
            file = picture_name(texture, stem) or ""
            text = text.replace(isf.imported(name, f"{name}.png"), isf.imported(name, file), 1)
    return _placed(text, comment)


def _placed(text: str, comment: str) -> str:
    """Insert the comment at the start, but after ``#version`` or the JSON of ISF."""
    if text.startswith("#version"):
        first, _, rest = text.partition("\n")
        return f"{first}\n{comment}{rest}"
    if text.startswith("/*{"):
        end = text.index("}*/") + len("}*/\n")
        return f"{text[:end]}\n{comment}{text[end:]}"
    return f"{comment}\n{text}"


def _spelled(name: str) -> str:
    return name.partition(".")[0]


def _broken(text: str) -> list[str]:
    lines = [""]
    for word in text.split(" "):
        if lines[-1] and len(lines[-1]) + len(word) >= WIDTH:
            lines.append("")
        lines[-1] += f" {word}" if lines[-1] else word
    return lines


@dataclass(frozen=True, slots=True)
class TextFiles:
    """A text, and the files that belong to it.

    Attributes:
        text: The text.
        beside: Its interface, its vertex stage and its pictures: file names and contents.
    """

    text: str
    beside: Mapping[str, bytes]

    def write(self, path: Path) -> tuple[Path, ...]:
        """Write them, and return the paths of the other files.

        Args:
            path: The file of the text.

        Raises:
            SaveError: The file system reports an error, or another file would be in its place.
        """
        files = {path.with_name(name): content for name, content in self.beside.items()}
        if path in files:
            kind = "interface" if path.suffix == ".json" else "vertex stage"
            raise SaveError(f"cannot write {path}: its {kind} goes there; give it another suffix")
        for place, content in {**files, path: text_bytes(self.text)}.items():
            with replacement(place) as file:
                file.write(content)
        return tuple(files)


def write(seen: Viewable, path: Path, target: str, options: TextOptions) -> Exported:
    """Write the text and the files that belong to it.

    Args:
        seen: The object to show.
        path: The file.
        target: The text target, as for ``distal.compile``.
        options: The view, time and parameters.

    Raises:
        CompileError: The text cannot hold all that the picture reads.
        SaveError: The file system reports an error, or another file would be in its place.
    """
    return Exported(path, {}, text_files(seen, target, options, path.stem).write(path))


def text_files(seen: Viewable, target: str, options: TextOptions, stem: str) -> TextFiles:
    """Return the text of a picture, and the files that belong to it.

    Args:
        seen: The object to show.
        target: The text target.
        options: The view and parameters.
        stem: The name of the text's file, without its suffix.

    Raises:
        CompileError: The text cannot hold all that the picture reads.
    """
    values = checked_values(seen.parameters, options.params)
    if seen.scene is not None and seen.is_traced(options.view):
        warn(
            "a text draws direct light, and the scene is in mode 'path': export a page for paths, "
            "or give the scene mode='direct'",
            seen.scene.place,
        )
    image = seen.image(options.view, encoded=True)
    description = TEXT_TARGETS[target]
    of_text = image.emitted() if isinstance(image, Composed) else image
    module = lower(of_text, table_from=TEXT_TABLE_FROM if description.buffers else None)
    refuse_passes(module)
    artifact = with_data(text_of(with_values(module, values), description), module)
    name = readable(seen.file.name) if seen.file is not None else ""
    return files_of(artifact, target, name, stem)


def files_of(
    artifact: Artifact, target: str, file: str, stem: str, *, described: bool = False
) -> TextFiles:
    """Return a compiled text with its header, and the files that belong to it.

    Args:
        artifact: The compiled text with its complete interface.
        target: Its target.
        file: The name of the author's file, without its folder; may be empty.
        stem: The name of the text's file, without its suffix.
        described: Whether the interface is a file even where the host sets no inputs.
    """
    files = {}
    description = TEXT_TARGETS.get(target)
    if described or description is None or description.is_described:
        files[f"{stem}.json"] = text_bytes(json.dumps(artifact.interface, indent=2))
    if description is not None and not description.is_described:
        files |= pictures_of(artifact, stem)
    if artifact.vertex is not None:
        files[f"{stem}.vert"] = text_bytes(artifact.vertex)
    return TextFiles(with_header(artifact, target, file, stem), files)


def text_bytes(text: str) -> bytes:
    """Return a text as it is written to a file."""
    return text.rstrip("\n").encode() + b"\n"


def pictures_of(artifact: Artifact, stem: str) -> dict[str, bytes]:
    """Return the pictures that a text reads as PNG, for a host that reads files.

    Args:
        artifact: The compiled text with its complete interface.
        stem: The name of the text's file, without its suffix.
    """
    entries = artifact.interface.get("textures", ())
    return {name: resources.png(e) for e in entries if (name := picture_name(e, stem)) is not None}


def picture_name(texture: Mapping[str, Any], stem: str) -> str | None:
    """Return the name of the file of a texture beside a text; None if the host has the texture.

    Args:
        texture: Its entry in the interface.
        stem: The name of the text's file, without its suffix.
    """
    return None if "live" in texture else f"{stem}.{texture['uniform']}.png"


def with_values(module: Module, values: Mapping[str, Any]) -> Module:
    """Return the module with these values as the defaults of its parameters."""
    uniforms = tuple(
        replace(u, default=values[u.name])
        if u.origin is Origin.PARAMETER and u.name in values
        else u
        for u in module.uniforms
    )
    return replace(module, uniforms=uniforms)
