"""What is measured of the solid of each picture of a sweep: volume, area, box, walls.

Input: a shape, values of its parameters. Output: plain numbers by name, as ``Shape.measure`` gives
them, and a hash of what they depend on. Does not depend on pictures.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from functools import cached_property
from typing import Any, Final

from distal.devices.base import Cancel
from distal.forking import new_lock
from distal.ir.nodes import Origin
from distal.lang.runtime_access import executor
from distal.runtime.fingerprints import fingerprint
from distal.scene.lowering.derived import DistanceOf
from distal.scene.objects.field import BaseShape
from distal.scene.objects.meshable import Meshable
from distal.scene.tree.errors import SceneValueError
from distal.sweeps.table import KEY
from distal.sweeps.worker_measures import SolidOnWorkers, figures

MEASURES: Final = (
    *("volume", "volume_error", "area", "area_error"),
    *("width", "height", "depth", "wall", "remark"),
)


def checked_solid(shape: BaseShape | None) -> Meshable:
    """Return the shape of a scene, if it can be measured.

    Raises:
        ValueError: It cannot.
    """
    if not isinstance(shape, Meshable):
        raise ValueError("measures are of solids: an @image and flat shapes have none")
    return shape


class SolidMeasures:
    """Measures a solid for values of its parameters; several threads may use it.

    Args:
        shape: The solid.
        pool: The workers that measure it; None for this process, one after the other.
    """

    def __init__(self, shape: Meshable, pool: Any | None) -> None:
        self._shape = shape
        self._own = {parameter.name for parameter in shape.parameters()}
        self._workers = None if pool is None else SolidOnWorkers(shape.node, pool)
        self._lock = new_lock()
        self._found: dict[str, dict[str, Any]] = {}

    def key(self, params: Mapping[str, Any], time: float) -> str:
        """Return a hash of all that the measures depend on."""
        own = sorted(self._values(params).items())
        return hashlib.sha256(f"{self._program} {own} {time!r}".encode()).hexdigest()[:16]

    @cached_property
    def _program(self) -> str:
        lowered = executor().lowered(DistanceOf(self._shape.node))
        uniforms = lowered.module.uniforms
        numbers = {u.name: u.default for u in uniforms if u.origin is Origin.NUMBER}
        return fingerprint([lowered.digest, numbers], lowered.resources)

    def _values(self, params: Mapping[str, Any]) -> dict[str, Any]:
        """Return the values that the solid reads: not those of camera, light and paint."""
        return {name: value for name, value in params.items() if name in self._own}

    def of(self, params: Mapping[str, Any], time: float, cancel: Cancel | None) -> dict[str, Any]:
        """Return the measures, in scene units, by name; None for what there is not.

        A solid that has no mesh with these values, for example because nothing is left of it, has a
        remark; so has one of which the meshes miss parts.

        Args:
            params: Values of parameters by name.
            time: Time in seconds.
            cancel: Ends the work early.

        Raises:
            Cancelled: ``cancel`` stopped it.
            PartError: No worker could do it.
        """
        key, values = self.key(params, time), self._values(params)
        # Sets that differ in camera, light and paint have the same solid.
        if key not in self._found:
            self._found[key] = {KEY: key, **self._measured(values, time, cancel)}
        return self._found[key]

    def _measured(
        self, values: Mapping[str, Any], time: float, cancel: Cancel | None
    ) -> dict[str, Any]:
        row: dict[str, Any] = dict.fromkeys(MEASURES)
        if self._workers is not None:
            numbers = self._workers.figures(values, time, cancel)
            if numbers is not None:
                return row | numbers
        try:
            with self._lock:
                measures = self._shape.measure(params=values, time=time, cancel=cancel)
        except SceneValueError as error:
            return row | {"remark": str(error).splitlines()[0]}
        return row | figures(measures)
