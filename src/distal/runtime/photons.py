"""Photons of a picture by paths: traced before each pass, sorted into tables for its kernel.

Input: the programs of a scene's photons, the options of the picture. Output: for each pass the
numbers and buffers that its kernel reads. Everything follows from the number of the pass's first
sample and the seed. Does not depend on how photons fly.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from itertools import repeat
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.devices.base import Kernel
from distal.devices.threads import usable_threads
from distal.lang.render_options import RenderOptions
from distal.lang.resources import Buffer
from distal.lang.runtime_access import executor
from distal.render import film, photons
from distal.render.paths import MOST_SEGMENTS
from distal.runtime.device_names import REFERENCE
from distal.runtime.lowered import Lowered
from distal.runtime.moving import moved_resources
from distal.runtime.uniform_values import DeclaredUniforms, frame_values

# Photons are followed in stages of so many segments: most meet nothing that bundles light and end
# at once, a few are caught in glass for long. What goes on is computed together, from its start.
_STAGES: Final = (1, 4, MOST_SEGMENTS)


@dataclass(frozen=True, slots=True)
class PhotonTables:
    """What the kernel of a pass reads of its photons.

    Attributes:
        numbers: Values of the kernel's numbers, by name.
        buffers: Its buffers, by their declaration in ``render.photons``.
    """

    numbers: Mapping[str, Any]
    buffers: Mapping[Buffer, NDArray[Any]]


@dataclass(frozen=True, slots=True)
class PhotonProgram:
    """A program of a scene's photons, ready to run.

    Attributes:
        kernel: Its kernel.
        lowered: What the kernel was compiled from.
        options: The options of the picture.
    """

    kernel: Kernel
    lowered: Lowered
    options: RenderOptions

    def run(self, rows: NDArray[Any], numbers: Mapping[str, Any], time: float) -> Any:
        """Return its results.

        Args:
            rows: The values of its parameter, or of the frame's place.
            numbers: Values of its numbers by name; those that it does not have are ignored.
            time: The time of the pass, in seconds.
        """
        declared = DeclaredUniforms([self.lowered.module])
        settings = {**self.options.settings, **numbers}
        known = {n: v for n, v in settings.items() if n in declared.numbers}
        read = {p.name: p for p in declared.parameters}
        given = {n: v for n, v in self.options.params.items() if n in read}
        given |= {
            p.name: self.options.params[p.label]
            for p in read.values()
            if p.label in self.options.params
        }
        params = declared.parameter_values(given)
        values = {**declared.number_values(known), **frame_values(replace(self.options, time=time))}
        return self.kernel.evaluate(
            [rows],
            declared.for_kernel(0, params, values),
            moved_resources(self.lowered.resources, params, time),
            threads=self.options.threads,
            cancel=self.options.cancel,
        )


@dataclass(frozen=True, slots=True)
class MapTable:
    """The photons of one map, in the order of their slots.

    Attributes:
        places: Place and brightness of each, (n, 4).
        arrivals: Two rows for each: the direction to where it came from; its color; (n, 2, 4).
        starts: The first photon of each slot, and of one slot more, which repeats the first slot,
            so that a run of two slots never wraps.
    """

    places: NDArray[np.float32]
    arrivals: NDArray[np.float32]
    starts: NDArray[np.int32]


@dataclass(frozen=True, slots=True)
class PhotonPasses:
    """The photons of a picture.

    Attributes:
        plan: The program that returns what the first pass depends on.
        deposits: The program that follows a photon.
        plans: The plans of the times so far.
    """

    plan: PhotonProgram
    deposits: PhotonProgram
    plans: dict[float, tuple[Any, ...]] = field(default_factory=dict)

    def tables(self, first: int, count: int, pixels: int, time: float) -> PhotonTables:
        """Return the photons of a pass.

        Args:
            first: The number of the pass's first sample.
            count: How many samples it has; each reads a map of its own.
            pixels: How many pixels it has.
            time: Its time in seconds.
        """
        options = self.deposits.options
        if time not in self.plans:
            self.plans[time] = self.plan.run(np.zeros((1, 2), np.float32), {}, time)
        low, high, widest = (np.asarray(part, np.float64)[0].tolist() for part in self.plans[time])
        given = (np.float32(widest), first)  # a picture's numbers have 32 bits
        radius = executor().call(photons.shrunk, given, {}, device=REFERENCE)
        of_sample = photons.OF_A_SAMPLE * pixels
        of_map = int(min(max(of_sample, photons.FEWEST / count), photons.MOST / count))
        slots = 1 << max(of_map.bit_length() - 1, 4)
        numbers: dict[str, Any] = {
            photons.LOW: tuple(low),
            photons.HIGH: tuple(high),
            photons.RADIUS: float(radius),
            photons.SLOTS: slots,
            photons.MAPS: count,
            photons.SHARE: 1.0 / of_map,
        }
        if not all(a < b for a, b in zip(low, high, strict=True)):
            return PhotonTables(numbers, _joined([_no_photons(slots)] * count))
        asked = {
            **numbers,
            film.FIRST_SAMPLE: first,
            film.PICTURE_SIZE: tuple(map(float, options.size)),
            photons.SEED: _signed(options.seed),
            photons.FRAME_INDEX: _signed(options.index or 0),
        }
        place, arrival, power, slot = (
            part.reshape(count, of_map, *part.shape[1:])
            for part in self._deposited(of_map * count, asked, time)
        )
        with ThreadPoolExecutor(options.threads or usable_threads()) as pool:
            tables = pool.map(_sorted, place, arrival, power, slot, repeat(slots))
            return PhotonTables(numbers, _joined(list(tables)))

    def _deposited(
        self, count: int, numbers: Mapping[str, Any], time: float
    ) -> tuple[NDArray[Any], ...]:
        """Return where the photons of a pass end, as arrays by field of ``photons.Deposit``.

        Args:
            count: How many there are.
            numbers: Values of the program's numbers.
            time: The time of the pass, in seconds.
        """
        followed = np.arange(count, dtype=np.int32)
        found: tuple[NDArray[Any], ...] = ()
        for most in _STAGES:
            part = self.deposits.run(followed, {**numbers, photons.MOST_FOLLOWED: most}, time)
            if not found:
                found = tuple(np.array(values) for values in part)
            else:
                for whole, values in zip(found, part, strict=True):
                    whole[followed] = values
            followed = np.flatnonzero(found[-1] == photons.UNFINISHED).astype(np.int32)
            if not len(followed):
                break
        return found


def _signed(value: int) -> int:
    """Return a whole number wrapped at 32 bits."""
    return (value + 2**31) % 2**32 - 2**31


def _no_photons(slots: int) -> MapTable:
    """Return a map without photons."""
    nothing = np.zeros((0, 4), np.float32)
    return MapTable(nothing, nothing.reshape(0, 2, 4), np.zeros(slots + 1, np.int32))


def _sorted(
    place: NDArray[np.float32],
    arrival: NDArray[np.float32],
    power: NDArray[np.float32],
    slot: NDArray[np.int32],
    slots: int,
) -> MapTable:
    """Return the photons of a map, in the order of their slots.

    Args:
        place: The place of each.
        arrival: The direction to where it came from.
        power: Its power.
        slot: Its slot; negative if it met nothing.
        slots: How many slots there are.
    """
    red, green, blue = np.abs(power).T
    bright = np.maximum(np.maximum(red, green), blue)
    kept = np.flatnonzero((slot >= 0) & np.isfinite(bright) & (bright > 0.0))
    # Keys of 16 bits are sorted in linear time.
    of_slot = slot[kept].astype(np.uint16 if slots <= 2**16 else np.int32)
    counts = np.bincount(of_slot, minlength=slots)
    order = kept[np.argsort(of_slot, kind="stable")]
    order = np.concatenate([order, order[: counts[0]]])
    starts = np.zeros(slots + 1, np.int32)
    np.cumsum(counts, out=starts[1:])
    places = np.empty((len(order), 4), np.float32)
    places[:, :3], places[:, 3] = place[order], bright[order]
    arrivals = np.zeros((len(order), 2, 4), np.float32)
    arrivals[:, 0, :3] = arrival[order]
    arrivals[:, 1, :3] = power[order] / places[:, 3:]
    return MapTable(places, arrivals, starts)


def _joined(maps: Sequence[MapTable]) -> dict[Buffer, NDArray[Any]]:
    """Return the tables of all maps as one; at least one photon stands in them, if of no slot."""
    ends = np.cumsum([len(table.places) for table in maps])
    begins = [0, *ends[:-1].tolist()]
    starts = [table.starts + np.int32(b) for table, b in zip(maps, begins, strict=True)]
    last = np.full(1, ends[-1], np.int32)
    places = np.concatenate([table.places for table in maps])
    arrivals = np.concatenate([table.arrivals for table in maps])
    if not len(places):
        places, arrivals = np.zeros((1, 4), np.float32), np.zeros((1, 2, 4), np.float32)
    # Stubs describe a buffer by the type of its elements.
    declared: list[Any] = [photons.PLACES, photons.ARRIVALS, photons.STARTS]
    values = (places, arrivals.reshape(-1, 4), np.concatenate([*starts, last]))
    return dict(zip(declared, values, strict=True))
