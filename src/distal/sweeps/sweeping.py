"""``distal.sweep``: render a scene for all combinations of some values.

Input: a picture, values by parameter, a file or a folder. Output: a sheet or numbered pictures, and
a table of what was measured of each. Pictures that a broken-off sweep has left in a folder are used
again.
"""

from __future__ import annotations

import csv
import io
import itertools
import json
import threading
import time as clock
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from distal.devices.base import PartError, cancel_test
from distal.diagnostics import DeviceError
from distal.file_writer import SaveError, check_destination, replacement
from distal.forking import new_lock
from distal.images.picture import Picture
from distal.images.png import encode_levels
from distal.lang.lazy_module import LazyModule
from distal.lang.presentable import Presentable
from distal.lang.render_options import Cancel, RenderOptions
from distal.loading import loaded_from
from distal.scene.objects.meshable import Meshable
from distal.scene.viewing.viewable import Viewable, viewable
from distal.sweeps.axes import TIME, Axis, chosen_axes, combinations, count_of
from distal.sweeps.sheet import Sheet
from distal.sweeps.solid_measures import COLUMNS, checked_solid, measured
from distal.version import __version__

if TYPE_CHECKING:
    from distributed import Client

    from distal.cluster.pool import WorkerPool
    from distal.video import frame_rendering, frames, moving_picture, overlap
else:
    # ``from distal import *`` imports this module.
    frame_rendering = LazyModule("distal.video.frame_rendering")
    frames = LazyModule("distal.video.frames")
    moving_picture = LazyModule("distal.video.moving_picture")
    overlap = LazyModule("distal.video.overlap")

_TABLE: Final = "sweep.csv"
_FIGURES: Final = ("seconds", "brightness", "samples", "noise")
# Called with the finished pictures, all pictures, and the kind of work.
Progress = Callable[[int, int, str], Any]


@dataclass(frozen=True, slots=True)
class FinishedSweep:
    """A finished sweep.

    Attributes:
        path: The sheet, or the folder of the pictures.
        table: The table, a CSV file.
        pictures: How many pictures there are.
        rendered: How many of them this call rendered.
        rows: The rows of the table: values by parameter, and figures.
        seconds: How long it took.
    """

    path: Path
    table: Path
    pictures: int
    rendered: int
    rows: tuple[Mapping[str, Any], ...]
    seconds: float

    def __str__(self) -> str:
        count = "1 picture" if self.pictures == 1 else f"{self.pictures} pictures"
        return f"{self.path}: {count}; {self.table}; {self.seconds:.1f} s"


def sweep(
    obj: Presentable,
    values: Mapping[str, Any],
    path: str | PathLike[str],
    *,
    size: tuple[int, int] = (160, 120),
    time: float = 0.0,
    params: Mapping[str, Any] | None = None,
    view: str = "color",
    samples: int | None = None,
    mode: str | None = None,
    device: str = "cpu",
    threads: int | None = None,
    cluster: Client | WorkerPool | None = None,
    measure: bool = False,
    fresh: bool = False,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> FinishedSweep:
    """Render all combinations of some values.

    Args:
        obj: A scene, a shape or an ``@image``.
        values: The values of each parameter by its name: a list, or a text such as "0:1:20" (twenty
            numbers from 0 to 1) or "1,2,3"; "time" for seconds.
        path: A file that ends in .png, for a sheet of all pictures with their values, or a folder,
            for numbered pictures, each with all that is needed to render it again. The table is
            beside the sheet, or in the folder.
        size: Width and height of each picture in pixels.
        time: Seconds, if it is none of the values.
        params: Values of the other parameters by name.
        view: The view to show; see ``Scene.render``.
        samples: Samples in each pixel, as for ``render``.
        mode: How light is computed: "direct" or "path"; None: as the scene says.
        device: The device to render on, as for ``render``.
        threads: Number of CPU threads; None for all.
        cluster: A ``dask.distributed.Client`` whose workers render the pictures, with the same
            bits; None renders them in this process. Needs ``distal[cluster]``.
        measure: Whether the table has the volume, area, box and thinnest wall of each solid too, as
            ``Shape.measure`` finds them; they are computed on this machine.
        fresh: Render all pictures again, even those that an earlier sweep left in the folder.
        progress: Called with the finished pictures, all pictures, and the kind of work.
        cancel: An event, or a function without arguments, that stops the work early.

    Raises:
        CompileError: The scene has mistakes.
        SaveError: A file cannot be written.
        ValueError: There is no such parameter, view or mode, a value is out of range, or there are
            too many pictures.
    """
    begin = clock.perf_counter()
    stop, is_cancelled = threading.Event(), cancel_test(cancel)
    options = RenderOptions(
        size=size,
        time=time,
        params=params or {},
        device=device,
        samples=samples,
        threads=threads,
        cluster=cluster,
        cancel=lambda: stop.is_set() or is_cancelled(),
    )
    shown = viewable(obj, options.params, options.time)
    axes = chosen_axes(values, shown.parameters)
    both = {axis.name for axis in axes} & set(options.params)
    if both:
        raise ValueError(f"'{min(both)}' has values of the sweep, and another one")
    job = _Sweep(
        obj=obj,
        axes=axes,
        options=options,
        view=view,
        mode=mode,
        title=f"{_source(obj, shown.name)} · {count_of(axes)} pictures",
        progress=progress or (lambda done, total, what: None),
        stop=stop,
        solid=_solid(shown) if measure else None,
    )
    output = Path(path)
    found = job.sheet(output) if output.suffix.lower() == ".png" else job.folder(output, fresh)
    return replace(found, seconds=clock.perf_counter() - begin)


@dataclass(frozen=True, slots=True)
class _Sweep:
    obj: Any
    axes: list[Axis]
    options: RenderOptions
    view: str
    mode: str | None
    title: str
    progress: Progress
    stop: threading.Event
    solid: Meshable | None = None
    failed: dict[int, PartError] = field(default_factory=dict)

    def sheet(self, path: Path) -> FinishedSweep:
        """Render all pictures, and write them as a sheet."""
        check_destination(path)
        sheet = Sheet(self.axes, self.options.size, self.title)
        rows: dict[int, dict[str, Any]] = {}
        for index, picture, row in self._rendered(list(range(count_of(self.axes))), {}):
            if picture is not None:
                sheet.put(index, picture.levels)
            rows[index] = row
        texts = {"Software": f"distal {__version__}", "distal:sweep": json.dumps(self._recipe())}
        with replacement(path) as file:
            file.write(encode_levels(sheet.pixels(), texts))
        table = path.with_suffix(".csv")
        in_order = tuple(rows[i] for i in sorted(rows))
        _write_table(table, in_order)
        self._check("their places are empty")
        return FinishedSweep(path, table, len(rows), len(rows), in_order, 0.0)

    def folder(self, path: Path, fresh: bool) -> FinishedSweep:
        """Render the pictures that are not there yet, and write each of them."""
        if path.suffix:
            raise SaveError(f"a sweep is a .png or a folder, not {path}")
        frames.make_folder(path)
        count = count_of(self.axes)
        digits = max(3, len(str(count)))
        files = [path / f"{i + 1:0{digits}d}.png" for i in range(count)]
        known = {} if fresh else _known_rows(path / _TABLE)
        moving = [self._moving(values) for values in combinations(self.axes)]
        kept = [
            frames.Frames([file], [m.options.time], m)
            for file, m in zip(files, moving, strict=True)
        ]
        there = [] if fresh else [i for i, frame in enumerate(kept) if frame.is_there(0)]
        rows = {i: self._row(i, None, 0.0) | known.get(files[i].name, {}) for i in there}
        rows = {i: self._with_measures(i, row) for i, row in rows.items()}
        rendered = [i for i in range(count) if i not in rows]
        try:
            for index, picture, row in self._rendered(rendered, dict(enumerate(moving))):
                if picture is not None:
                    kept[index].write(0, picture)
                    rows[index] = row
        finally:
            in_order = tuple({"file": files[i].name, **rows[i]} for i in sorted(rows))
            _write_table(path / _TABLE, in_order)
        self._check("the other pictures are kept: the same command renders only what failed")
        return FinishedSweep(path, path / _TABLE, count, len(rendered), in_order, 0.0)

    def _moving(self, values: Mapping[str, Any]) -> moving_picture.MovingPicture:
        """Return the picture of some values."""
        own, time = {}, self.options.time
        for axis in self.axes:
            if axis.is_time:
                time = values[axis.name]
            else:
                own[axis.name] = values[axis.name]
        options = replace(self.options, time=time, params={**self.options.params, **own})
        return moving_picture.moving_picture(self.obj, options, self.view, self.mode)

    def _rendered(
        self, indices: list[int], known: Mapping[int, moving_picture.MovingPicture]
    ) -> Iterator[tuple[int, Picture | None, dict[str, Any]]]:
        """Return the number, the picture and the row of each picture, in order.

        Pictures that fail on the workers of a cluster are noted in ``failed``, and have no picture;
        if others may be the reason they are tried again alone, and come a second time.
        """
        every = list(combinations(self.axes))
        count, lock = len(every), new_lock()
        first = {i: known.get(i) or self._moving(every[i]) for i in indices[:1]}

        def made(index: int) -> tuple[int, Picture | None, dict[str, Any]]:
            begin = clock.perf_counter()
            with lock:
                moving = known.get(index) or first.get(index) or self._moving(every[index])
            try:
                picture = moving.picture(0, moving.options.time)
            except PartError as error:
                self.failed[index] = error
                return index, None, self._row(index, None, 0.0)
            self.failed.pop(index, None)
            return index, picture, self._row(index, picture, clock.perf_counter() - begin)

        done = count - len(indices)
        at_once = first[indices[0]].at_once if indices else 1
        for several in (at_once, 1):
            with closing(overlap.made_ahead(made, indices, several, self.stop.set)) as pictures:
                for index, picture, row in pictures:
                    yield index, picture, self._with_measures(index, row)
                    if picture is not None:
                        done += 1
                        self.progress(done, count, "rendering")
            indices = sorted(i for i, error in self.failed.items() if error.shared)

    def _with_measures(self, index: int, row: dict[str, Any]) -> dict[str, Any]:
        """Return a row of the table with the measures of its solid, if they are asked for."""
        if self.solid is None or row.get(COLUMNS[0]):
            return row
        moving = next(itertools.islice(combinations(self.axes), index, None))
        time = moving.pop(TIME, self.options.time) if self._sweeps_time else self.options.time
        values = {**self.options.params, **moving}
        return row | measured(self.solid, values, time, self.options.cancel)

    @property
    def _sweeps_time(self) -> bool:
        return any(axis.is_time for axis in self.axes)

    def _check(self, more: str) -> None:
        """Name the pictures that failed.

        Raises:
            DeviceError: There are some.
        """
        if not self.failed:
            return
        every = list(combinations(self.axes))
        names = []
        for index in sorted(self.failed):
            texts = self._row(index, None, 0.0)
            names.append(", ".join(f"{axis.label} {texts[axis.name]}" for axis in self.axes))
        reason = self.failed[min(self.failed)].reason
        raise DeviceError(
            f"{len(names)} of {len(every)} pictures failed: {frame_rendering.listed(names, '; ')}; "
            f"{'it' if len(names) == 1 else 'the first'} {reason}; {more}"
        )

    def _row(self, index: int, picture: Picture | None, seconds: float) -> dict[str, Any]:
        row: dict[str, Any] = {}
        for axis in reversed(self.axes):
            index, place = divmod(index, len(axis.values))
            row[axis.name] = axis.texts[place]
        row = dict(reversed(row.items()))
        if picture is None:
            return row | dict.fromkeys(_FIGURES, "")
        red, green, blue = (float(picture.array[..., i].mean(dtype=np.float64)) for i in range(3))
        stats = picture.stats
        figures = {
            "seconds": round(float(stats.get("render_s", seconds)), 4),
            "brightness": round(0.2126 * red + 0.7152 * green + 0.0722 * blue, 6),
            "samples": stats.get("samples", picture.provenance.samples),
            "noise": stats.get("noise"),
        }
        return row | {name: "" if value is None else value for name, value in figures.items()}

    def _recipe(self) -> dict[str, Any]:
        return {
            "axes": {axis.name: list(axis.values) for axis in self.axes},
            "parameters": dict(self.options.params),
            "time": self.options.time,
            "view": self.view,
            "mode": self.mode,
            "samples": self.options.samples,
            "size": list(self.options.size),
        }


def _solid(shown: Viewable) -> Meshable:
    return checked_solid(None if shown.scene is None else shown.scene.subject)


def _source(obj: Any, name: str) -> str:
    """Return where an object is from, as the author wrote it, or its name."""
    known = loaded_from(obj)
    return name if known is None else known.source


def _write_table(path: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Write the rows as CSV; what some of them do not have is empty there.

    Raises:
        SaveError: It cannot be written.
    """
    if not rows:
        return
    text = io.StringIO()
    columns = list(dict.fromkeys(name for row in rows for name in row))
    writer = csv.DictWriter(text, columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    with replacement(path) as file:
        file.write(text.getvalue().encode())


def _known_rows(path: Path) -> dict[str, dict[str, Any]]:
    """Return the figures of an earlier table by file; none if it cannot be read."""
    known = {*_FIGURES, *COLUMNS}
    try:
        with open(path, encoding="utf-8", newline="") as file:
            return {
                row["file"]: {name: text for name, text in row.items() if name in known}
                for row in csv.DictReader(file)
            }
    except (OSError, KeyError, csv.Error, UnicodeDecodeError):
        return {}
