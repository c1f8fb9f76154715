"""``distal.sweep``: render and measure a scene for many sets of values.

Input: a picture, sets of values, a file or a folder. Output: a sheet or numbered pictures, and a
table of the inputs, of figures of the pictures and of what was measured, to which each row is added
as it is finished. What a broken-off sweep has left is used again.
"""

from __future__ import annotations

import json
import threading
import time as clock
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
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
from distal.lang.chosen_values import checked_values
from distal.lang.lazy_module import LazyModule
from distal.lang.presentable import Presentable
from distal.lang.render_options import FrameProgress, RenderOptions
from distal.loading import loaded_from
from distal.scene.viewing.viewable import Viewable, viewable
from distal.sweeps.inputs import Inputs, inputs_of
from distal.sweeps.sheet import Sheet
from distal.sweeps.solid_measures import MEASURES, SolidMeasures, checked_solid
from distal.sweeps.table import KEY, SweepRow, SweepTable
from distal.version import __version__

if TYPE_CHECKING:
    from distributed import Client

    from distal.cluster import pool as cluster_pool
    from distal.cluster.pool import WorkerPool
    from distal.video import frame_rendering, frames, moving_picture, overlap
else:
    # ``from distal import *`` imports this module.
    cluster_pool = LazyModule("distal.cluster.pool")
    frame_rendering = LazyModule("distal.video.frame_rendering")
    frames = LazyModule("distal.video.frames")
    moving_picture = LazyModule("distal.video.moving_picture")
    overlap = LazyModule("distal.video.overlap")

_TABLE: Final = "sweep.csv"
_FIGURES: Final = ("seconds", "brightness", "samples", "noise")
_DIGITS: Final = 16  # of a hash in a table
_NOTHING: Final[Mapping[int, SweepRow]] = {}
# Values by parameter, all combinations of which are taken; a list of sets of values; a CSV file.
Values = Mapping[str, Any] | Iterable[Any] | str | PathLike[str]


@dataclass(frozen=True, slots=True)
class FinishedSweep:
    """A finished sweep.

    Attributes:
        path: The sheet, the folder of the pictures, or the table.
        table: The table, a CSV file.
        pictures: How many pictures there are.
        rendered: How many of them this call rendered.
        measured: How many solids this call measured.
        rows: The rows of the table, in the order of the inputs.
        seconds: How long it took.
    """

    path: Path
    table: Path
    pictures: int
    rendered: int
    measured: int
    rows: tuple[SweepRow, ...]
    seconds: float

    def __str__(self) -> str:
        if self.path == self.table:
            return f"{self.path}: {_counted(len(self.rows), 'row')}; {self.seconds:.1f} s"
        count = _counted(self.pictures, "picture")
        return f"{self.path}: {count}; {self.table}; {self.seconds:.1f} s"


def swept(
    obj: Presentable,
    values: Values,
    path: str | PathLike[str],
    options: RenderOptions,
    *,
    measure: bool = False,
    fresh: bool = False,
    progress: FrameProgress | None = None,
) -> FinishedSweep:
    """Render, or only measure, a scene for many sets of values.

    Each finished row is in the table at once, with all digits: if the process is killed, the same
    call goes on where it ended.

    Args:
        obj: A scene, a shape or an ``@image``.
        values: The values of each parameter by its name, all combinations of which are taken: a
            list, or a text such as "0:1:20" (twenty numbers from 0 to 1) or "1,2,3"; "time" for
            seconds. Or a list of sets of values, each a mapping or a named tuple, as
            ``distal.parameter_sets`` draws them. Or the path of a CSV file of such sets.
        path: A file that ends in .png, for a sheet of all pictures with their values; one that ends
            in .csv, for a table of measures without pictures; or a folder, for numbered pictures,
            each with all that is needed to render it again. The table is beside the sheet, or in
            the folder.
        options: How each picture is rendered.
        measure: Whether the table has the volume, area, box and thinnest wall of each solid too, as
            ``Shape.measure`` finds them; a table without pictures always has.
        fresh: Do all work again, also what an earlier sweep left, and replace a table of other
            inputs.
        progress: Called with the finished pictures, all pictures, and the kind of work.

    Raises:
        CompileError: The scene has mistakes.
        SaveError: A file cannot be written, or there is a table of other inputs.
        ValueError: There is no such parameter, view or mode, a value is out of range, or there are
            too many pictures.
    """
    begin = clock.perf_counter()
    stop, is_cancelled = threading.Event(), cancel_test(options.cancel)
    shown = viewable(obj, options.params, options.time)
    inputs = inputs_of(values, shown.parameters)
    # By the names of the parameters, also if a label was given: measuring reads names.
    options = replace(
        options,
        params=checked_values(shown.parameters, options.params),
        cancel=lambda: stop.is_set() or is_cancelled(),
    )
    both = {column.name for column in inputs.columns} & set(options.params)
    if both:
        label = next(column.label for column in inputs.columns if column.name in both)
        raise ValueError(f"'{label}' has values of the sweep, and another one")
    output = Path(path)
    kind = output.suffix.lower()
    solid = _measures(shown, options.cluster) if measure or kind == ".csv" else None
    job = _Sweep(obj, inputs, options, stop, progress or _silent, solid)
    if kind == ".csv":
        found = job.measures(output, fresh)
    elif kind == ".png":
        name = f"{_source(obj, shown.name)} · {_counted(len(inputs.sets), 'picture')}"
        found = job.sheet(output, name, fresh)
    elif kind:
        raise SaveError(f"a sweep is a .png, a .csv or a folder, not {path}")
    else:
        found = job.folder(output, fresh)
    return replace(found, seconds=clock.perf_counter() - begin)


@dataclass(slots=True)
class _Sweep:
    obj: Any
    inputs: Inputs
    options: RenderOptions
    stop: threading.Event
    progress: FrameProgress
    solid: SolidMeasures | None = None
    failed: dict[int, PartError] = field(default_factory=dict)
    measured: int = 0

    def measures(self, path: Path, fresh: bool) -> FinishedSweep:
        """Measure all solids, and render nothing."""
        check_destination(path)
        table = SweepTable(path, self.inputs, (), (KEY, *MEASURES), files=False)
        rows = self._current(table.earlier(fresh=fresh))
        rows = {number: row for number, row in rows.items() if row.measured}
        needs = [i for i in self._indices if i + 1 not in rows]
        with table.open(rows):
            for row, _ in self._found(needs, lambda index: (self._row(index), None)):
                table.add(row)
        self._check("the other rows are kept: the same command measures only what failed")
        return self._finished(path, table, 0)

    def sheet(self, path: Path, title: str, fresh: bool) -> FinishedSweep:
        """Render all pictures, and write them as a sheet."""
        check_destination(path)
        sheet = Sheet(self.inputs, self.options.size, title)
        table = self._table(path.with_suffix(".csv"), files=False)
        earlier = self._current(table.earlier(fresh=fresh))
        first, lock = self._moving(0), new_lock()

        def made(index: int) -> tuple[SweepRow, Picture | None]:
            with lock:
                moving = first if index == 0 else self._moving(index)
            return self._with_picture(moving, self._row(index, earlier))

        with table.open(earlier):
            for row, picture in self._found(self._indices, made, first.at_once):
                if picture is not None:
                    sheet.put(row.number - 1, picture.levels)
                table.add(row)
        texts = {"Software": f"distal {__version__}", "distal:sweep": json.dumps(self._recipe())}
        with replacement(path) as file:
            file.write(encode_levels(sheet.pixels(), texts))
        self._check("their places are empty")
        return self._finished(path, table, len(self._indices))

    def folder(self, path: Path, fresh: bool) -> FinishedSweep:
        """Render the pictures that are not there yet, and write each of them."""
        frames.make_folder(path)
        digits = max(3, len(str(len(self._indices))))
        files = [path / f"{i + 1:0{digits}d}.png" for i in self._indices]
        table = self._table(path / _TABLE, files=True)
        earlier = self._current(table.earlier(fresh=fresh))
        moving = [self._moving(index) for index in self._indices]
        kept = [
            frames.Frames([file], [m.options.time], m)
            for file, m in zip(files, moving, strict=True)
        ]

        def is_there(index: int) -> bool:
            row = earlier.get(index + 1)
            return (
                row is not None
                and row.picture.get(KEY) == kept[index].key(0)[:_DIGITS]
                and kept[index].is_there(0)
            )

        there = {i for i in self._indices if is_there(i)}
        rows = {i + 1: replace(earlier[i + 1], file=files[i].name) for i in there}

        def made(index: int) -> tuple[SweepRow, Picture | None]:
            if index in there:
                return rows[index + 1], None
            row = self._row(index, {} if self.solid is None else earlier)
            return self._with_picture(moving[index], replace(row, file=files[index].name))

        is_done = [i in there and self._is_measured(rows[i + 1]) for i in self._indices]
        needs = [i for i in self._indices if not is_done[i]]
        with table.open(rows):
            for row, picture in self._found(needs, made, moving[0].at_once):
                own = kept[row.number - 1]
                if picture is not None:
                    own.write(0, picture)
                    row = replace(row, picture={KEY: own.key(0)[:_DIGITS], **row.picture})
                table.add(row)
        self._check("the other pictures are kept: the same command renders only what failed")
        return self._finished(path, table, len(self._indices), len(self._indices) - len(there))

    @property
    def _indices(self) -> range:
        return range(len(self.inputs.sets))

    def _table(self, path: Path, *, files: bool) -> SweepTable:
        figures = (KEY, *_FIGURES) if files else _FIGURES
        measures = () if self.solid is None else (KEY, *MEASURES)
        return SweepTable(path, self.inputs, figures, measures, files=files)

    def _moving(self, index: int) -> moving_picture.MovingPicture:
        """Return the picture of a set of values."""
        options = replace(self.options, time=self._time(index), params=self._params(index))
        return moving_picture.moving_picture(self.obj, options)

    def _params(self, index: int) -> dict[str, Any]:
        return {**self.options.params, **self.inputs.params(index)}

    def _time(self, index: int) -> float:
        return self.inputs.time(index, self.options.time)

    def _row(self, index: int, earlier: Mapping[int, SweepRow] = _NOTHING) -> SweepRow:
        """Return the row of a set, with what an earlier run has measured."""
        known = earlier.get(index + 1)
        measured = {} if known is None else known.measured
        return SweepRow(index + 1, self.inputs.named(index), measured)

    def _current(self, rows: Mapping[int, SweepRow]) -> dict[int, SweepRow]:
        """Return rows of an earlier run without measures of what the solid was then."""
        if self.solid is None:
            return dict(rows)
        found = {}
        for number, row in rows.items():
            key = self.solid.key(self._params(number - 1), self._time(number - 1))
            is_current = row.measured.get(KEY) == key
            found[number] = row if is_current else replace(row, measured={})
        return found

    def _is_measured(self, row: SweepRow) -> bool:
        return self.solid is None or bool(row.measured)

    def _with_picture(
        self, moving: moving_picture.MovingPicture, row: SweepRow
    ) -> tuple[SweepRow, Picture]:
        """Return a row with the figures of its picture, and the picture."""
        begin = clock.perf_counter()
        picture = moving.picture(0, moving.options.time)
        figures = _figures(picture, clock.perf_counter() - begin)
        return replace(row, picture=figures), picture

    def _with_measures(self, index: int, row: SweepRow) -> SweepRow:
        """Return a row with the measures of its solid, if they are asked for."""
        if self.solid is None or row.measured:
            return row
        found = self.solid.of(self._params(index), self._time(index), self.options.cancel)
        self.measured += 1
        return replace(row, measured=found)

    def _found(
        self,
        indices: Sequence[int],
        make: Callable[[int], tuple[SweepRow, Picture | None]],
        at_once: int | None = None,
    ) -> Iterator[tuple[SweepRow, Picture | None]]:
        """Yield the row and the picture of each set, measured, as they are finished.

        What fails on the workers of a cluster is noted in ``failed``, and not yielded; if others
        may be the reason it is tried again alone.
        """

        def made(index: int) -> tuple[int, tuple[SweepRow, Picture | None] | None]:
            try:
                row, picture = make(index)
                row = self._with_measures(index, row)
            except PartError as error:
                self.failed[index] = error
                return index, None
            self.failed.pop(index, None)
            return index, (row, picture)

        count = len(self.inputs.sets)
        done = count - len(indices)
        if at_once is None:
            at_once = 1 if self.options.cluster is None else _slots(self.options.cluster)
        what = "rendering" if self.solid is None else "measuring"
        for several in (at_once, 1):
            with closing(overlap.made_at_once(made, indices, several, self.stop.set)) as results:
                for _, found in results:
                    if found is None:
                        continue
                    yield found
                    done += 1
                    self.progress(done, count, what)
            indices = sorted(i for i, error in self.failed.items() if error.shared)

    def _finished(
        self, path: Path, table: SweepTable, pictures: int, rendered: int | None = None
    ) -> FinishedSweep:
        rows = tuple(table.rows[number] for number in sorted(table.rows))
        rendered = pictures if rendered is None else rendered
        return FinishedSweep(path, table.path, pictures, rendered, self.measured, rows, 0.0)

    def _check(self, more: str) -> None:
        """Name the sets that failed.

        Raises:
            DeviceError: There are some.
        """
        if not self.failed:
            return
        names = [self.inputs.shown(index) for index in sorted(self.failed)]
        reason = self.failed[min(self.failed)].reason
        raise DeviceError(
            f"{len(names)} of {_counted(len(self.inputs.sets), 'picture')} failed: "
            f"{frame_rendering.listed(names, '; ')}; "
            f"{'it' if len(names) == 1 else 'the first'} {reason}; {more}"
        )

    def _recipe(self) -> dict[str, Any]:
        return {
            **self.inputs.recipe,
            "parameters": dict(self.options.params),
            "time": self.options.time,
            "view": self.options.view,
            "mode": self.options.mode,
            "samples": self.options.samples,
            "size": list(self.options.size),
        }


def _silent(done: int, total: int, what: str) -> None:
    """In place of a report of progress."""


def _counted(count: int, what: str) -> str:
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def _slots(cluster: Any) -> int:
    """Return how many tasks keep the workers of a client or a pool busy."""
    return 2 * cluster_pool.pool_of(cluster).slots


def _figures(picture: Picture, seconds: float) -> dict[str, Any]:
    """Return what a table says of a picture."""
    red, green, blue = (float(picture.array[..., i].mean(dtype=np.float64)) for i in range(3))
    stats = picture.stats
    return {
        "seconds": float(stats.get("render_s", seconds)),
        "brightness": 0.2126 * red + 0.7152 * green + 0.0722 * blue,
        "samples": stats.get("samples", picture.provenance.samples),
        "noise": stats.get("noise"),
    }


def _measures(shown: Viewable, cluster: Client | WorkerPool | None) -> SolidMeasures:
    """Return what measures the solid of a picture.

    Raises:
        ValueError: It has none.
    """
    solid = checked_solid(None if shown.scene is None else shown.scene.subject)
    return SolidMeasures(solid, None if cluster is None else cluster_pool.pool_of(cluster))


def _source(obj: Any, name: str) -> str:
    """Return where an object is from, as the author wrote it, or its name."""
    known = loaded_from(obj)
    return name if known is None else known.source
