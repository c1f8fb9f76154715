"""Photons of a picture by paths: traced before each pass, sorted into tables for its kernel.

Input: the programs of a scene's photons, the options of the picture. Output: for each pass the
numbers and buffers that its kernel reads. Everything follows from the number of the pass's first
sample and the seed. Does not depend on how photons fly.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.devices.base import Kernel
from distal.lang.render_options import RenderOptions
from distal.lang.resources import Buffer
from distal.render import film, photons
from distal.runtime.lowered import Lowered
from distal.runtime.moving import moved_resources
from distal.runtime.uniform_values import DeclaredUniforms, frame_values

# Photons for each pixel and sample, and the least and most of them in a pass.
_OF_A_SAMPLE: Final = 0.5
_FEWEST: Final = 2**14
_MOST: Final = 2**21


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
class PhotonPasses:
    """The photons of a picture.

    Attributes:
        plan: The program that returns what a pass depends on.
        deposits: The program that follows a photon.
    """

    plan: PhotonProgram
    deposits: PhotonProgram

    def tables(self, first: int, count: int, pixels: int, time: float) -> PhotonTables:
        """Return the photons of a pass.

        Args:
            first: The number of the pass's first sample.
            count: How many samples it has; each reads a map of its own.
            pixels: How many pixels it has.
            time: Its time in seconds.
        """
        options = self.deposits.options
        begun = {film.FIRST_SAMPLE: first}
        found = self.plan.run(np.zeros((1, 2), np.float32), begun, time)
        low, high, radius = (np.asarray(part, np.float64)[0].tolist() for part in found)
        of_sample = _OF_A_SAMPLE * pixels
        of_map = int(min(max(of_sample, _FEWEST / count), _MOST / count))
        slots = 1 << max(of_map.bit_length() - 1, 4)
        numbers: dict[str, Any] = {
            photons.LOW: tuple(low),
            photons.HIGH: tuple(high),
            photons.RADIUS: radius,
            photons.SLOTS: slots,
            photons.MAPS: count,
            photons.SHARE: 1.0 / of_map,
        }
        total = count * (slots + 1)
        if not all(a < b for a, b in zip(low, high, strict=True)):
            return PhotonTables(numbers, _sorted(np.zeros(0, np.int64), None, total))
        size = tuple(map(float, options.size))
        of_pass = {photons.SEED: _signed(options.seed), photons.FRAME_INDEX: _signed(options.index)}
        asked = {**numbers, **begun, **of_pass, film.PICTURE_SIZE: size}
        place, arrival, power, slot = self.deposits.run(
            np.arange(of_map * count, dtype=np.int32), asked, time
        )
        whole = np.isfinite(power).all(axis=1) & (np.abs(power).max(axis=1) > 0.0)
        kept = np.flatnonzero((slot >= 0) & whole)
        # Each map has one slot more, which repeats the first: a run of two slots never wraps.
        kept = np.concatenate([kept, kept[slot[kept] == 0]])
        of_slot = kept // of_map * (slots + 1) + slot[kept]
        of_slot[len(kept) - np.count_nonzero(slot[kept] == 0) // 2 :] += slots
        return PhotonTables(
            numbers, _sorted(of_slot, (place[kept], arrival[kept], power[kept]), total)
        )


def _signed(value: int) -> int:
    """Return a whole number wrapped at 32 bits."""
    return (value + 2**31) % 2**32 - 2**31


def _sorted(
    of_slot: NDArray[np.int64],
    columns: tuple[NDArray[np.float32], ...] | None,
    total: int,
) -> dict[Buffer, NDArray[Any]]:
    """Return the tables of photons, in the order of their slots.

    Args:
        of_slot: The slot of each photon, counted through all maps.
        columns: Place, direction and power of each; None if there is none.
        total: How many slots there are.
    """
    starts = np.zeros(total + 1, np.int32)
    places, arrivals = np.zeros((1, 4), np.float32), np.zeros((2, 4), np.float32)
    if columns is not None and len(of_slot):
        order = np.argsort(of_slot, kind="stable")
        np.cumsum(np.bincount(of_slot, minlength=total), out=starts[1:])
        place, arrival, power = (column[order] for column in columns)
        bright = np.abs(power).max(axis=1, keepdims=True)
        places = np.hstack([place, bright])
        arrivals = np.zeros((len(order), 2, 4), np.float32)
        arrivals[:, 0, :3], arrivals[:, 1, :3] = arrival, power / bright
    # Stubs describe a buffer by the type of its elements.
    declared: list[Any] = [photons.PLACES, photons.ARRIVALS, photons.STARTS]
    return dict(zip(declared, (places, arrivals.reshape(-1, 4), starts), strict=True))
