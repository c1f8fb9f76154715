"""Render a saved picture again from the record in its file.

Input: the file of a picture. Output: the same picture, and notes on what has changed. A scene's
file is run only after its text was compared with the recorded text.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LONGEST_MESSAGE, LoadError, printable
from distal.example_files import EXAMPLE_PREFIX
from distal.file_writer import SaveError
from distal.images import exr, jpeg, png
from distal.images.metadata import Provenance, ReadError
from distal.images.picture import Picture
from distal.images.picture_files import Record, read
from distal.lang.render_options import Cancel, Progress, RenderOptions
from distal.loading import SceneCode, digest_of, load, split_source
from distal.scene.rendering import render_scene
from distal.scene.section import CutPlane
from distal.scene.steering import Steering
from distal.scene.view_options import RECORDED
from distal.scene.viewing.viewable import viewable
from distal.version import __version__

MARK: Final = ".rerendered"
_LONGEST_PART: Final = 80  # characters of a quotation in a message
_MOST_SHOWN: Final = 20  # modules listed in a message


class RerenderError(Exception):
    """A picture cannot be rendered again. The message is one line with the reason."""

    def __init__(self, message: str) -> None:
        # The message quotes text of the picture's file, which is untrusted.
        super().__init__(printable(message, LONGEST_MESSAGE))


@dataclass(frozen=True, slots=True)
class RerenderPlan:
    """A picture's file, and the scene to render it from.

    Attributes:
        path: The file of the picture.
        record: The provenance recorded in the file.
        file: Where the scene was found: a file or ``example:NAME``.
        name: The object's name in the file; None if the file has only one.
        named: The source to record in the new picture: as it was written, without a local folder.
        notes: What has changed, one line each.
    """

    path: Path
    record: Record
    file: str
    name: str | None
    named: str
    notes: tuple[str, ...]

    @property
    def source(self) -> str:
        """The scene's source, as ``FILE[:NAME]``."""
        return self.file if self.name is None else f"{self.file}:{self.name}"


@dataclass(frozen=True, slots=True)
class Difference:
    """The difference of two pictures, in the levels or numbers that their files hold.

    Attributes:
        largest: The largest difference in a channel. 1 is the full range of the display, or one
            unit of linear light or of a layer.
        share: The fraction of pixels that differ at all.
    """

    largest: float
    share: float

    @property
    def is_none(self) -> bool:
        """Whether the pictures are equal."""
        return self.share == 0.0


def plan_rerender(path: Path, *, source: str | None = None, force: bool = False) -> RerenderPlan:
    """Find the scene of a picture and compare its text with the recorded one.

    Args:
        path: A PNG or EXR file that ``Picture.save`` wrote.
        source: ``FILE[:NAME]`` or ``example:NAME``, used instead of the recorded source.
        force: Continue although the scene has changed.

    Raises:
        ReadError: The file is broken, or does not say how it was made.
        RerenderError: The scene is missing, or has changed.
    """
    record = read(path)
    origin = record.provenance
    file, name = split_source(source) if source else _named_source(origin, path)
    try:
        digest = digest_of(file, origin.neighbors)
    except LoadError as error:
        raise RerenderError(f"cannot rebuild {path}: {error}") from None
    notes = []
    if digest != origin.source_hash:
        beside = printable(", ".join(origin.neighbors[:_MOST_SHOWN]), _LONGEST_PART)
        also = f" or what it imports ({beside})" if origin.neighbors else ""
        found = file if name is None else f"{file}:{name}"
        changed = f"{found}{also} is not what {path} was rendered of"
        if not force:
            raise RerenderError(f"{changed}: it has changed since; --force renders it as it is now")
        notes.append(printable(f"{changed}: rendered as it is now", LONGEST_MESSAGE))
    if record.version != __version__:
        version = printable(record.version, _LONGEST_PART)
        notes.append(f"{path} was made by distal {version}, this is {__version__}")
    if origin.live:
        notes.append(
            f"{path} was drawn frame by frame by hand, of which it does not tell: its earlier "
            "frames are computed with its last keys, mouse and parameters"
        )
    if origin.ruler is not None:
        notes.append(f"the ruler that is drawn over {path} is not rendered again")
    return RerenderPlan(path, record, file, name, source or origin.source, tuple(notes))


def rerender(
    plan: RerenderPlan,
    *,
    size: tuple[int, int] | None = None,
    samples: int | None = None,
    device: str | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> Picture:
    """Render a picture again; None keeps the recorded value.

    Args:
        plan: The plan made by ``plan_rerender``.
        size: Width and height in pixels.
        samples: Samples in each pixel.
        device: The device to render on, as for ``Scene.render``.
        threads: Number of CPU threads; None uses all that the process may use.
        progress: Called with the finished share, from 0 to 1.
        cancel: An event, or a function without arguments, that ends the work early.

    Raises:
        RerenderError: The scene has changed and lacks a recorded parameter or view.
        LoadError: The scene's file fails when run.
        CompileError: The scene has mistakes.
        DeviceError: The device is missing.
    """
    origin = plan.record.provenance
    obj = load(plan.file, plan.name)
    try:
        options = RenderOptions(
            size=size or plan.record.size,
            time=origin.time,
            params=origin.parameters,
            device=device or origin.device or "cpu",
            threads=threads,
            progress=progress,
            cancel=cancel,
            mouse=origin.mouse,
            buttons=origin.buttons,
            keys=origin.keys,
            delta=origin.delta,
            date=origin.date,
            index=origin.index,
            seed=origin.seed,
            samples=origin.samples if samples is None else samples,
            view=origin.view,
        )
        made = _rendered(obj, origin, options)
    except (ValueError, TypeError, OverflowError) as error:  # the scene no longer has it
        raise RerenderError(f"cannot rebuild {plan.path}: {error}") from None
    return made.with_provenance(source=plan.named)


def _rendered(obj: SceneCode, origin: Provenance, options: RenderOptions) -> Picture:
    seen = viewable(obj, *(origin.stage or ({}, 0.0)), origin.look)
    if seen.scene is None:
        return seen.render(options)
    scene = seen.scene.with_display(exposure=origin.exposure, tone_map=origin.tone_map)
    shown: dict[str, Any] = {"transparent": origin.transparent, "layers": origin.layers}
    if origin.view == "color":
        shown["mode"] = origin.mode
    if origin.steering is not None:
        yaw, pitch, zoom, *pan = origin.steering
        shown["steering"] = Steering(yaw, pitch, zoom, (pan[0], pan[1]))
    if origin.section is not None:
        shown["section"], scene = CutPlane.of(origin.section), scene.sectioned
    if origin.plane is not None:
        shown["plane"] = origin.plane
    asked = replace(options, freeze=origin.freeze, **shown, **_recorded(origin))
    return render_scene(scene, asked)


def _recorded(origin: Provenance) -> dict[str, Any]:
    """Return the recorded options of mode "path".

    Raises:
        RerenderError: There is no such option.
    """
    for name in origin.paths:
        if name not in {row.name for row in RECORDED}:
            raise RerenderError(f"the picture names an option '{printable(name, 40)}' of paths")
    return dict(origin.paths)


def difference(plan: RerenderPlan, picture: Picture) -> Difference:
    """Compare a picture with the recorded one; NaN is equal to NaN.

    Raises:
        RerenderError: The pictures differ in size.
        ReadError: The file is broken, or another program has rewritten its pixels.
    """
    if plan.record.stored_size != (picture.width, picture.height):
        stored, made = plan.record.stored_size, (picture.width, picture.height)
        sizes = f"it is {stored[0]}x{stored[1]}, the picture {made[0]}x{made[1]}"
        raise RerenderError(f"cannot compare {plan.path}: {sizes}")
    largest = 0.0
    differs = np.zeros((picture.height, picture.width), bool)
    for then, now in _channels(plan, picture):
        unequal = (then != now) & ~(np.isnan(then) & np.isnan(now))
        differs |= unequal
        if unequal.any():
            # The difference of two infinities is NaN; it counts as infinite.
            gaps = np.abs(then[unequal].astype(np.float64) - now[unequal].astype(np.float64))
            largest = max(largest, float(np.nan_to_num(gaps, nan=np.inf, posinf=np.inf).max()))
    return Difference(largest, float(differs.mean()))


def _channels(plan: RerenderPlan, picture: Picture) -> Iterator[tuple[NDArray[Any], NDArray[Any]]]:
    """Yield each channel of the recorded picture and of the new one, as stored in files."""
    bits = plan.record.bits
    try:
        stored = plan.path.read_bytes()
        if plan.record.format == "png":
            most = float(2**bits - 1)
            then = png.decode(stored) / most
            now = png.decode(png.encode(picture.array, {}, bits)) / most
            yield from ((then[..., i], now[..., i]) for i in range(4))
            return
        if plan.record.format == "jpg":
            then = jpeg.decode(stored) / 255.0
            now = jpeg.decode(jpeg.encode(picture.array, {})) / 255.0
            yield from ((then[..., i], now[..., i]) for i in range(3))
            return
        held = exr.decode(stored)
        made = exr.decode(exr.encode(picture.linear, picture.layers, {}, bits))
    except (OSError, ReadError, SaveError) as error:
        raise ReadError(f"cannot compare {plan.path}: {error}") from None
    if held.keys() != made.keys():
        raise ReadError(f"cannot compare {plan.path}: it was rewritten with other channels")
    yield from ((held[name], made[name]) for name in made)


def default_output(path: Path) -> Path:
    """Return the output path for a new picture: in the folder of the first one."""
    return path.with_name(f"{path.stem}{MARK}{path.suffix}")


def _named_source(origin: Provenance, path: Path) -> tuple[str, str | None]:
    """Return the file and the object name that a picture's record names.

    The picture's creator chose this name, and the file will be run. So the record may name only an
    example, or a Python file in the picture's folder or in the current one. If several such files
    exist, the first that has not changed is used.

    Raises:
        RerenderError: The record names no such file.
    """
    file, name = _split(origin.source)
    if file.startswith(EXAMPLE_PREFIX):
        return file, name
    shown = printable(origin.source, _LONGEST_PART)
    reason = _refused(file, shown)
    found: list[str] = []
    if reason is None:
        places = [(folder, _inside(folder, file)) for folder in (path.parent, Path())]
        found = list(dict.fromkeys(str(folder / file) for folder, is_in in places if is_in))
        reason = f"there is no {shown}, neither beside it nor here"
        if any(is_in is False for _, is_in in places):
            reason = f"it names {shown}, a link that leads out of its folder"
    if not found:
        raise RerenderError(f"cannot rebuild {path}: {reason}; name it: --source FILE[:NAME]")
    same = [place for place in found if _digest_or_none(place, origin) == origin.source_hash]
    return (same or found)[0], name


def _split(text: str) -> tuple[str, str | None]:
    """Split like ``split_source``, but without looking at files, which could change the result."""
    file, _, name = text.rpartition(":")
    if name.isidentifier() and file and f"{file}:" != EXAMPLE_PREFIX:
        return file, name
    return text, None


def _refused(file: str, shown: str) -> str | None:
    """Return why a picture may not name this file, or None if it may."""
    if not file:
        return "it names no file"
    parts = PurePosixPath(file)
    if parts.suffix != ".py":
        return f"it names no .py file, only '{shown}'"
    # On Windows a colon marks a drive, or a stream of another file.
    is_hidden = any(part.startswith(".") for part in parts.parts)
    is_plain = (
        not is_hidden and not any(c in "\\:" for c in file) and printable(file, len(file)) == file
    )
    if not is_plain or parts.is_absolute():
        return f"it names '{shown}', which is no plain path below its folder"
    return None


def _inside(folder: Path, file: str) -> bool | None:
    """Return whether a file is in a folder; None if it is no file, False if a link leads out."""
    try:
        real = (folder / file).resolve(strict=True)
        if not real.is_file():
            return None
        return real.is_relative_to(folder.resolve())
    except (OSError, ValueError, RuntimeError):  # an impossible name, or links in a circle
        return None


def _digest_or_none(file: str, origin: Provenance) -> str | None:
    try:
        return digest_of(file, origin.neighbors)
    except LoadError:
        return None
