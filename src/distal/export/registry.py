"""The formats of exported files, by name and suffix.

Input: a picture and a path. Output: the file, and a description of it. The text formats come from
the declarations of targets. To add another format, write a module with ``write`` and an entry here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from distal.backends import TEXT_TARGETS
from distal.export.exported import Exported
from distal.export.page_options import PageOptions, TextOptions
from distal.file_writer import SaveError, check_destination
from distal.lang.lazy_module import LazyModule
from distal.scene.viewing.viewable import viewable

if TYPE_CHECKING:
    from distal.export import page, printing, shadertoy, texts
else:
    printing = LazyModule("distal.export.printing")  # needs NumPy
    page = LazyModule("distal.export.page")
    shadertoy = LazyModule("distal.export.shadertoy")
    texts = LazyModule("distal.export.texts")


@dataclass(frozen=True, slots=True)
class FileFormat:
    """A format of exported files.

    Attributes:
        options: The class of its options.
        suffix: The suffix of its files; None if another format has the suffix.
    """

    options: type[TextOptions]
    suffix: str | None = None

    @property
    def option_names(self) -> frozenset[str]:
        """The names of the options that ``export`` accepts for it."""
        return frozenset(field.name for field in fields(self.options))


FORMATS: Final = {
    "html": FileFormat(PageOptions, ".html"),
    **{name: FileFormat(TextOptions, target.suffix) for name, target in TEXT_TARGETS.items()},
}


def export(
    obj: Any, path: str | PathLike[str], target: str | None, options: Mapping[str, Any]
) -> Exported:
    """Write a web page or the text of a shader, depending on the suffix or ``target``.

    A page is one file that needs no network: a live picture with controls. A text takes ``params``,
    ``view`` and ``time`` alone.

    Args:
        obj: The object to show.
        path: The file. Without ``target``, its suffix determines the format: .html for a page,
            .glsl for Shadertoy, .fs for ISF, .frag for WebGL 2, .wgsl for WebGPU.
        target: "html" or a text target, a name in ``distal.backends.TEXT_TARGETS``:
            "shadertoy", "glsl-es300" ...
        options: The fields of ``PageOptions`` for a page, those of ``TextOptions`` for a text.

    Raises:
        SaveError: The suffix is unknown, or the file cannot be written.
        LoadError: The object is not a picture.
        CompileError: The scene uses something that the target lacks.
        ValueError: There is no such view, parameter or target, or a value is out of range.
        TypeError: The target does not accept such an option.
    """
    destination = Path(path)
    name = kind_of(destination, target)
    taken = FORMATS[name].option_names
    defaults = {each.name: each.default for each in fields(PageOptions)}
    given = {name: value for name, value in options.items() if value != defaults[name]}
    if unknown := sorted(set(given) - taken):
        known = ", ".join(sorted(taken))
        raise TypeError(f"'{unknown[0]}' is no option of {name}; options: {known}")
    check_destination(destination)
    chosen = PageOptions(**given)
    if chosen.printable:
        printing.check_solid(obj)
    seen = viewable(obj, chosen.params, chosen.time)
    if name == "html":
        return page.write(seen, destination, chosen)
    if name == shadertoy.TARGET and shadertoy.has_passes(seen, chosen):
        return shadertoy.write(seen, destination, chosen)
    return texts.write(seen, destination, name, chosen)


def kind_of(path: Path, target: str | None) -> str:
    """Return the name of the format for a target or a suffix.

    Raises:
        SaveError: The suffix is unknown.
        ValueError: There is no such target.
    """
    if target is not None:
        if target not in FORMATS:
            raise ValueError(f"there is no target '{target}'; targets: {', '.join(FORMATS)}")
        return target
    by_suffix = {format.suffix: name for name, format in FORMATS.items() if format.suffix}
    by_suffix[".htm"] = "html"
    found = by_suffix.get(path.suffix.lower())
    if found is None:
        named = f"the suffix '{path.suffix}'" if path.suffix else "no suffix"
        known = ", ".join(f"{suffix} ({name})" for suffix, name in by_suffix.items())
        raise SaveError(f"cannot write {path}: it has {named}; known are {known}")
    return found
