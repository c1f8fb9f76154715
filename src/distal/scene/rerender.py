"""A saved picture, rendered again from what its file says.

Input: the file of a picture. Output: the same picture, and notes on what has
changed. A scene's file is run only after its text was compared with the recorded one.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LONGEST_MESSAGE, LoadError, printable
from distal.images import exr, png
from distal.images.metadata import Provenance, ReadError, Record, read
from distal.images.picture import Picture
from distal.lang.render_options import Cancel, Progress, RenderOptions
from distal.loading import EXAMPLE_PREFIX, SceneCode, digest_of, load, split_source
from distal.scene.rendering import render_scene
from distal.scene.steering import Steering
from distal.scene.view_options import ViewOptions
from distal.scene.viewing.viewable import viewable
from distal.version import __version__

MARK: Final = ".rerendered"
_LONGEST_PART: Final = 80  # characters of what a message quotes
_MOST_SHOWN: Final = 20  # modules beside a scene


class RerenderError(Exception):
    """A picture that cannot be rendered again as it was, and why, in one line."""

    def __init__(self, message: str) -> None:
        # It quotes what a picture's file says, and others may have made that.
        super().__init__(printable(message, LONGEST_MESSAGE))


@dataclass(frozen=True, slots=True)
class RerenderPlan:
    """A picture's file, and the scene that it is rendered of again.

    Attributes:
        path: The picture's file.
        record: What it says.
        file: Where the scene was found: a file or ``example:NAME``.
        name: Which object of the file; None for its only one.
        named: The same as the new picture says it: as it was written, without a folder of ours.
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
        """Where the scene was found, as ``FILE[:NAME]``."""
        return self.file if self.name is None else f"{self.file}:{self.name}"


@dataclass(frozen=True, slots=True)
class Difference:
    """How two pictures differ, in the levels or numbers that their files hold.

    Attributes:
        largest: The largest difference of a channel; 1 is the display's whole range, or a unit of
            linear light or of a layer.
        share: Of the pixels that differ at all.
    """

    largest: float
    share: float

    @property
    def is_none(self) -> bool:
        """Whether the pictures are equal."""
        return self.share == 0.0


def plan_rerender(path: Path, *, source: str | None = None, force: bool = False) -> RerenderPlan:
    """Find what a picture was rendered of, and compare it with the recorded text.

    Args:
        path: A PNG or EXR that ``Picture.save`` wrote.
        source: ``FILE[:NAME]`` or ``example:NAME`` instead of what the picture says.
        force: Go on with a scene that has changed.

    Raises:
        ReadError: The file is broken, or does not say how it was made.
        RerenderError: The scene is missing, or has changed.
    """
    record = read(path)
    origin = record.provenance
    file, name = split_source(source) if source else _named_source(origin, path)
    try:
        digest = digest_of(file, origin.neighbours)
    except LoadError as error:
        raise RerenderError(f"cannot rebuild {path}: {error}") from None
    notes = []
    if digest != origin.source_hash:
        beside = printable(", ".join(origin.neighbours[:_MOST_SHOWN]), _LONGEST_PART)
        also = f" or what it imports ({beside})" if origin.neighbours else ""
        found = file if name is None else f"{file}:{name}"
        changed = f"{found}{also} is not what {path} was rendered of"
        if not force:
            raise RerenderError(f"{changed}: it has changed since; --force renders it as it is now")
        notes.append(printable(f"{changed}: rendered as it is now", LONGEST_MESSAGE))
    if record.version != __version__:
        version = printable(record.version, _LONGEST_PART)
        notes.append(f"{path} was made by distal {version}, this is {__version__}")
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
        plan: The picture's file, and its scene.
        size: Width and height in pixels.
        samples: Rays for each pixel of a scene.
        device: What renders, as for ``Scene.render``.
        threads: How many CPU threads to use; None for all that the process may use.
        progress: Called with the finished share, from 0 to 1.
        cancel: An event, or a function without arguments, that ends the work early.

    Raises:
        RerenderError: The scene cannot show it: a parameter or a view is gone.
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
            index=origin.index,
            seed=origin.seed,
        )
        made = _rendered(obj, origin, samples, options)
    except (ValueError, TypeError, OverflowError) as error:  # what the scene does not have any more
        raise RerenderError(f"cannot rebuild {plan.path}: {error}") from None
    return made.with_provenance(source=plan.named)


def _rendered(
    obj: SceneCode, origin: Provenance, samples: int | None, options: RenderOptions
) -> Picture:
    seen = viewable(obj, *(origin.stage or ({}, 0.0)))
    if seen.scene is None:
        if samples is not None:
            raise ValueError(f"samples are for scenes and shapes; '{seen.name}' is an @image")
        return seen.render(options, view=origin.view)
    scene = seen.scene.developed(exposure=origin.exposure, tone_map=origin.tone_map)
    moved = None
    if origin.steering is not None:
        yaw, pitch, zoom, *pan = origin.steering
        moved = Steering(yaw, pitch, zoom, (pan[0], pan[1]))
    view = ViewOptions(
        samples=origin.samples if samples is None else samples,
        view=origin.view,
        transparent=origin.transparent,
        steering=moved,
        layers=origin.layers,
    )
    if origin.plane is not None:
        view = replace(view, plane=origin.plane)
    return render_scene(scene, view, replace(options, freeze=origin.freeze))


def difference(plan: RerenderPlan, picture: Picture) -> Difference:
    """How a picture differs from what its file holds; NaN is equal to NaN.

    Raises:
        RerenderError: They are not of one size.
        ReadError: The file is broken, or another program wrote its pixels again.
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
            # Infinities less each other are no number, and as different as can be.
            gaps = np.abs(then[unequal].astype(np.float64) - now[unequal].astype(np.float64))
            largest = max(largest, float(np.nan_to_num(gaps, nan=np.inf, posinf=np.inf).max()))
    return Difference(largest, float(differs.mean()))


def _channels(plan: RerenderPlan, picture: Picture) -> Iterator[tuple[NDArray[Any], NDArray[Any]]]:
    """Each channel of the recorded picture and of the new one, as files hold it."""
    bits = plan.record.bits
    try:
        stored = plan.path.read_bytes()
        if plan.record.format == "png":
            most = float(2**bits - 1)
            then = png.decode(stored) / most
            now = png.decode(png.encode(picture.array, {}, bits)) / most
            yield from ((then[..., i], now[..., i]) for i in range(4))
            return
        held = exr.decode(stored)
        made = exr.decode(exr.encode(picture.linear, picture.layers, {}, bits))
    except (OSError, ReadError) as error:
        raise ReadError(f"cannot compare {plan.path}: {error}") from None
    if held.keys() != made.keys():
        raise ReadError(f"cannot compare {plan.path}: it was rewritten with other channels")
    yield from ((held[name], made[name]) for name in made)


def default_output(path: Path) -> Path:
    """Where a picture that is rendered again goes: into the folder of the first one."""
    return path.with_name(f"{path.stem}{MARK}{path.suffix}")


def _named_source(origin: Provenance, path: Path) -> tuple[str, str | None]:
    """The file that a picture names and the name in it: beside the picture, or from where one is.

    Who made the picture chose that name, and the file will be run: it may name an example, or a
    Python file in the picture's folder or in the current one, and nothing else. Of several files
    the first that has not changed.

    Raises:
        RerenderError: It names no such file.
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
    """As ``split_source``, by the text alone: no file can change what a picture says."""
    file, _, name = text.rpartition(":")
    if name.isidentifier() and file and f"{file}:" != EXAMPLE_PREFIX:
        return file, name
    return text, None


def _refused(file: str, shown: str) -> str | None:
    """Why a picture may not name a file by itself; None if it may."""
    if not file:
        return "it names no file"
    parts = PurePosixPath(file)
    if parts.suffix != ".py":
        return f"it names no .py file, only '{shown}'"
    # A colon is a drive, or a stream of another file, on Windows.
    is_hidden = any(part.startswith(".") for part in parts.parts)
    is_plain = (
        not is_hidden and not any(c in "\\:" for c in file) and printable(file, len(file)) == file
    )
    if not is_plain or parts.is_absolute():
        return f"it names '{shown}', which is no plain path below its folder"
    return None


def _inside(folder: Path, file: str) -> bool | None:
    """Whether a file is in a folder; None if it is no file, False if links lead out of it."""
    try:
        real = (folder / file).resolve(strict=True)
        if not real.is_file():
            return None
        return real.is_relative_to(folder.resolve())
    except (OSError, ValueError, RuntimeError):  # a name that no file can have, links in a circle
        return None


def _digest_or_none(file: str, origin: Provenance) -> str | None:
    try:
        return digest_of(file, origin.neighbours)
    except LoadError:
        return None
