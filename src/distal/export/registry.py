"""Every kind of file that an export writes, by name and by suffix.

Input: a picture and a path. Output: the file, and what it is made of. The kinds of texts come from
the declarations of targets. To add another kind: one module with ``write``, and one row here.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, Final

from distal.backends import TEXT_TARGETS
from distal.export.exported import Exported
from distal.images.atomic_files import SaveError, check_destination
from distal.scene.viewing.viewable import viewable


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of file.

    Attributes:
        module: Whose ``write(seen, path, target, **options)`` makes it.
        suffix: What its files end in; None where another kind has the suffix.
        options: What ``export`` may be told of it.
    """

    module: str
    suffix: str | None
    options: frozenset[str]


_TEXT: Final = frozenset({"params", "view", "time"})
_PAGE: Final = _TEXT | {
    *("size", "duration", "title", "embed", "panel", "poster", "views", "device"),
}

KINDS: Final = {
    "html": Kind("distal.export.page", ".html", _PAGE),
    **{
        name: Kind("distal.export.texts", target.suffix, _TEXT)
        for name, target in TEXT_TARGETS.items()
    },
}


def export(
    obj: Any, path: str | PathLike[str], *, target: str | None = None, **options: Any
) -> Exported:
    """Write a scene, a shape or an ``@image`` as a file that shows it elsewhere.

    Args:
        obj: The picture.
        path: The file. Its suffix says what is written where ``target`` does not: .html a page,
            .glsl for Shadertoy, .fs for ISF, .frag for WebGL 2, .wgsl for WebGPU.
        target: "html", or that of a text, a name of ``distal.backends.TEXT_TARGETS``: "shadertoy",
            "glsl-es300" ...
        options: ``params`` (values of parameters by name), ``view`` (what is shown first) and
            ``time`` (seconds). Of a page also ``size`` (width and height in pixels), ``duration``
            (seconds after which the time begins anew), ``title``, ``embed`` (a fragment for other
            pages), ``panel``, ``poster`` (whether there are any), ``views`` (those to include), and
            ``device`` (what renders the poster, as for ``Scene.render``).

    Raises:
        SaveError: The suffix is unknown, or the file cannot be written.
        LoadError: It is no picture.
        CompileError: It says what the place cannot do.
        ValueError: There is no such view, parameter or target, or a value is out of range.
        TypeError: The target does not take such an option.
    """
    destination = Path(path)
    name = kind_of(destination, target)
    kind = KINDS[name]
    if unknown := sorted(set(options) - kind.options):
        known = ", ".join(sorted(kind.options))
        raise TypeError(f"'{unknown[0]}' is no option of {name}; options: {known}")
    check_destination(destination)
    seen = viewable(obj, options.get("params"), options.get("time", 0.0))
    write: Callable[..., Exported] = importlib.import_module(kind.module).write
    return write(seen, destination, name, **options)


def kind_of(path: Path, target: str | None) -> str:
    """The kind of file that a target or a suffix means.

    Raises:
        SaveError: The suffix means none.
        ValueError: There is no such target.
    """
    if target is not None:
        if target not in KINDS:
            raise ValueError(f"there is no target '{target}'; targets: {', '.join(KINDS)}")
        return target
    by_suffix = {kind.suffix: name for name, kind in KINDS.items() if kind.suffix}
    by_suffix[".htm"] = "html"
    found = by_suffix.get(path.suffix.lower())
    if found is None:
        named = f"the suffix '{path.suffix}'" if path.suffix else "no suffix"
        known = ", ".join(f"{suffix} ({name})" for suffix, name in by_suffix.items())
        raise SaveError(f"cannot write {path}: it has {named}; known are {known}")
    return found
