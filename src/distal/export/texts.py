"""Export a picture as a shader text, with a comment that explains how to use it.

Input: a viewable object, or a compiled text. Output: files. The functions for the comment need the
standard library only, because ``distal compile`` uses them too.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from distal.backends import TEXT_TARGETS
from distal.backends.base import Artifact
from distal.backends.clike.module_text import comment_text
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
from distal.version import __version__

if TYPE_CHECKING:
    from distal.scene.viewing.viewable import Viewable

_PARAMETERS: Final = {
    Declares.NOBODY: "constants below, to be edited",
    Declares.PLACE: "inputs",
    Declares.TEXT: "uniforms",
}
WIDTH: Final = 96


def with_header(artifact: Artifact, target: str, file: str) -> str:
    """Return a text with a comment in front: its author's file and how to use it.

    Args:
        artifact: The compiled text.
        target: The name of its target.
        file: The name of the author's file, without its folder; may be empty.
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
    for buffer in artifact.interface.get("buffers", ()):
        if "values" in buffer:
            lines += _broken(f"{buffer['uniform']}: constants of the scene, in the file .json.")
    for texture in artifact.interface["textures"] if described.textures_by else ():
        name = comment_text(texture["name"])
        lines.append(f"{texture['uniform']}: {name}, by {described.textures_by}.")
    comment = "\n".join(("/*", *(f" * {line}" for line in lines), " */", ""))
    return _placed(artifact.text, comment)


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


def write(seen: Viewable, path: Path, target: str, options: TextOptions) -> Exported:
    """Write the text and the files that belong to it.

    Args:
        seen: The object to show.
        path: The file.
        target: The text target, as for ``distal.compile``.
        options: The view, time and parameters.

    Raises:
        CompileError: The text cannot hold all that the picture reads.
        SaveError: The file system reports an error, or another file is where one would go.
    """
    artifact = text(seen, target, options)
    return Exported(path, {}, write_files(path, artifact, artifact.text, target))


def text(seen: Viewable, target: str, options: TextOptions) -> Artifact:
    """Return the text with its header, the vertex stage and the complete interface.

    Args:
        seen: The object to show.
        target: The text target.
        options: The view and parameters.

    Raises:
        CompileError: The text cannot hold all that the picture reads.
    """
    values = checked_values(seen.parameters, options.params)
    image = seen.image(options.view, encoded=True)
    description = TEXT_TARGETS[target]
    of_text = image.text() if isinstance(image, Composed) else image
    module = lower(of_text, table_from=TEXT_TABLE_FROM if description.buffers else None)
    refuse_passes(module)
    artifact = with_data(text_of(with_values(module, values), description), module)
    name = readable(seen.file.name) if seen.file is not None else ""
    return replace(artifact, text=with_header(artifact, target, name))


def write_files(path: Path, artifact: Artifact, text: str, target: str) -> tuple[Path, ...]:
    """Write a text and the files that belong to it: its vertex stage, its interface, its pictures.

    Args:
        path: The file of the text.
        artifact: The compiled text, its vertex stage and interface.
        text: The text to write.
        target: Its target.

    Returns:
        The other files.

    Raises:
        SaveError: The file system reports an error, or another file is where one would go.
    """
    others = beside(artifact, target)
    files = {path.with_name(name.format(path.stem)): content for name, content in others.items()}
    if path in files:
        kind = "interface" if path.suffix == ".json" else "vertex stage"
        raise SaveError(f"cannot write {path}: its {kind} goes there; give it another suffix")
    for place, content in {**files, path: text_bytes(text)}.items():
        with replacement(place) as file:
            file.write(content)
    return tuple(files)


def text_bytes(text: str) -> bytes:
    """Return a text as it is written to a file."""
    return text.rstrip("\n").encode() + b"\n"


def beside(artifact: Artifact, target: str) -> dict[str, bytes]:
    """Return the files that belong to a text, by name; "{}" is the stem of the text's file.

    Args:
        artifact: The compiled text with its complete interface.
        target: Its target.
    """
    files = {}
    if TEXT_TARGETS[target].is_described:
        files["{}.json"] = text_bytes(json.dumps(artifact.interface, indent=2))
    if artifact.vertex is not None:
        files["{}.vert"] = text_bytes(artifact.vertex)
    return files


def with_values(module: Module, values: Mapping[str, Any]) -> Module:
    """Return the module with these values as the defaults of its parameters."""
    uniforms = tuple(
        replace(u, default=values[u.name])
        if u.origin is Origin.PARAMETER and u.name in values
        else u
        for u in module.uniforms
    )
    return replace(module, uniforms=uniforms)
