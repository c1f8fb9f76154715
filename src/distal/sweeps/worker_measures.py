"""Solids that the workers of a cluster measure.

Input: a solid's tree and a pool; on the other side programs as ``cluster.programs`` makes them.
Output: the numbers that ``Shape.measure`` finds, with the same bits. Workers never get the tree, of
which an author's objects are a part, but the functions of its field that measuring calls: they ask
for those that they lack. What they refuse is measured by the sender, who knows the author's lines.
"""

from __future__ import annotations

import importlib
import re
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

from distal.cluster import tasks
from distal.cluster.errors import ClusterError
from distal.cluster.pool import SUBMITTED, WorkerPool
from distal.cluster.programs import Plain, Sent, received, sent
from distal.devices.base import Cancel
from distal.devices.features import chosen_level
from distal.forking import new_lock
from distal.ir.types import BOOL, FLOAT, INT, VEC2, VEC3, Array, Type
from distal.lang.functions import Func
from distal.mesh.kernels import FIELD_FUNCTIONS, OfField
from distal.mesh.measuring import Measures, measures_of
from distal.mesh.meshing import MeshRequest
from distal.mesh.parallel import by_one_thread
from distal.mesh.parts import PARTS
from distal.mesh.requests import BOUNDS, DISTANCE
from distal.runtime.received import Received
from distal.scene.lowering.derived import BoundsOf, DistanceOf
from distal.scene.tree.errors import SceneValueError
from distal.scene.tree.node import Node
from distal.scene.tree.part_names import PlacedPart

if TYPE_CHECKING:
    from distal.mesh.solid import Floats

# Programs that are kept in a process: a solid has one for the box and about 15 of its field.
_MOST_KEPT: Final = 128
_kept: dict[str, Received] = {}
_lock: Final = new_lock()
_TYPES: Final = {str(type): type for type in (BOOL, INT, FLOAT, VEC2, VEC3)}
# The functions that measuring has called so far, with the types of their parameters.
_called: dict[Func, Sequence[tuple[str, Type]]] = {}


def figures(measures: Measures) -> dict[str, Any]:
    """Return what a table has of measures: numbers, and the warnings as a remark."""
    corners = zip(measures.low.value, measures.high.value, strict=True)
    width, height, depth = (high - low for low, high in corners)
    return {
        "volume": measures.volume.value,
        "volume_error": measures.volume.error,
        "area": measures.area.value,
        "area_error": measures.area.error,
        "width": width,
        "height": height,
        "depth": depth,
        "wall": None if measures.wall is None else measures.wall.value,
        "remark": "; ".join(measures.warnings) or None,
    }


class SolidOnWorkers:
    """A solid that workers measure; several threads may use it.

    Args:
        node: The solid's tree.
        pool: The workers.
    """

    def __init__(self, node: Node, pool: WorkerPool) -> None:
        self._node, self._pool = node, pool
        self._bounds = sent(node.derived(BOUNDS, lambda: BoundsOf(node)))
        self._distance = sent(node.derived(DISTANCE, lambda: DistanceOf(node)))
        self._functions: dict[Func, Sent] = {}
        self._lock = new_lock()
        self._is_known = False

    def figures(
        self, params: Mapping[str, Any], time: float, cancel: Cancel | None
    ) -> dict[str, Any] | None:
        """Return the numbers of a table; None if the solid has no mesh with these values.

        Args:
            params: Values of the solid's parameters by name.
            time: Seconds.
            cancel: Ends the work early.

        Raises:
            Cancelled: ``cancel`` stopped it.
            TaskError: No worker could do it.
        """
        self._pool.check()
        if self._is_known:
            return self._asked(params, time, cancel)
        with self._lock:  # the first one finds out which functions there are
            found = self._asked(params, time, cancel)
            self._is_known = True
            return found

    def _asked(
        self, params: Mapping[str, Any], time: float, cancel: Cancel | None
    ) -> dict[str, Any] | None:
        while True:
            self._add_functions()
            found = self._pool.result(lambda: self._submitted(params, time), cancel, "measuring")
            self._pool.saw_level(found["level"])
            if found["missing"] is None:
                numbers: dict[str, Any] | None = found["figures"]
                return numbers
            name, types = found["missing"]
            _called[_function_of(name)] = [(n, _type_of(of)) for n, of in types]

    def _add_functions(self) -> None:
        with self._lock:
            for function, types in list(_called.items()):
                if function not in self._functions:
                    self._functions[function] = sent(OfField(self._node, function, types))

    def _submitted(self, params: Mapping[str, Any], time: float) -> Any:
        pool, functions = self._pool, dict(self._functions)
        programs = [self._bounds, self._distance, *functions.values()]
        data: dict[str, Any] = {}
        for program in programs:
            data |= pool.data_of(program)
        return pool.client.submit(
            measured,
            [pool.constant(each.digest, each.program) for each in programs],
            data,
            pool.call(
                name=self._node.name,
                digests=[each.digest for each in programs],
                functions=list(map(_name_of, functions)),
                params=dict(params),
                time=time,
            ),
            **SUBMITTED,
        )


def _name_of(function: Func) -> str:
    return f"{function.__module__}:{function.name}"


def _function_of(name: str) -> Func:
    """Return a function of the library.

    Raises:
        ClusterError: There is none.
    """
    module, _, attribute = name.partition(":")
    found = None
    if module.startswith("distal.mesh."):
        found = getattr(importlib.import_module(module), attribute, None)
    if not isinstance(found, Func):
        raise ClusterError(f"a worker asks for {name!r:.80}, which is no function of distal")
    return found


def _type_of(text: str) -> Type:
    """Return the type of a text: a number, a vector, or an array of these."""
    array = re.fullmatch(r"array\[(.+), ([0-9]{1,6})\]", text)
    return _TYPES[text] if array is None else Array(_type_of(array[1]), int(array[2]))


# On a worker


class _MissingError(Exception):
    """A function that was not sent; its arguments are the function and its types."""


class _Functions(dict[str, Received]):
    """The functions of a field that were sent; another one ends the task."""

    def need(self, function: Func, types: Sequence[tuple[str, Type]]) -> Received:
        """Return a function of the field.

        Raises:
            _MissingError: It was not sent.
        """
        name = _name_of(function)
        if name not in self:
            raise _MissingError(name, [(n, str(of)) for n, of in types])
        return self[name]


class _UnknownParts:
    """In place of ``mesh.parts.PartAt``: the parts of a solid have no names here."""

    def __init__(self, node: Any) -> None:
        self._node = node

    def at(self, places: Floats, params: Mapping[str, Any], time: float) -> list[PlacedPart]:
        """Return what is at each place: the whole solid."""
        return [PlacedPart(self._node, "")] * len(places)


class _ReceivedSolid:
    """In place of a tree: what measuring asks of it, as programs that were sent."""

    flat, place, children, label = False, None, (), ""

    def __init__(
        self, name: str, bounds: Received, distance: Received, functions: _Functions
    ) -> None:
        self.name = name
        self.rule = self
        self._derived = {
            BOUNDS: bounds,
            DISTANCE: distance,
            FIELD_FUNCTIONS: functions,
            PARTS: _UnknownParts(self),
        }

    @property
    def node(self) -> Any:
        """As that of a shape."""
        return self

    def derived(self, name: str, make: Callable[[], Any]) -> Any:
        """Return what was sent under a name; see ``Node.derived``."""
        return self._derived[name]


def measured(programs: Sequence[Plain], data: Mapping[str, Any], call: Plain) -> Plain:
    """Measure a solid: what a worker does.

    Args:
        programs: The programs of its bounds and of its distance, and those of its field.
        data: Their data by name.
        call: ``digests``, the hashes of the programs; ``functions``, the names of those of the
            field; the solid's ``name``; ``params`` and ``time``; what ``tasks.run`` reads.

    Returns:
        ``figures``, None if the solid has no mesh; ``missing``, a function that was not sent and
        its types, or None; ``level`` of this processor.
    """

    def body(stop: Callable[[], bool]) -> Plain:
        pairs = zip(call["digests"], programs, strict=True)
        bounds, distance, *functions = (
            _received(digest, program, data) for digest, program in pairs
        )
        known = _Functions(zip(call["functions"], functions, strict=True))
        solid: Any = _ReceivedSolid(call["name"], bounds, distance, known)
        request = MeshRequest(params=call["params"], time=call["time"], cancel=stop, colors=False)
        made: Plain = {"figures": None, "missing": None, "level": chosen_level(None).name}
        try:
            made["figures"] = figures(by_one_thread(lambda: measures_of(solid, 1.0, request)))
        except _MissingError as error:
            made["missing"] = error.args
        except SceneValueError:
            pass  # the sender says why, with the author's line
        return made

    return tasks.run(call, body)


def _received(digest: str, program: Plain, data: Mapping[str, Any]) -> Received:
    with _lock:
        found = _kept.pop(digest, None) or received(program, data)
        _kept[digest] = found
        while len(_kept) > _MOST_KEPT:
            _kept.pop(next(iter(_kept)))
        return found
