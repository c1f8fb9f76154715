"""Programs as plain data, and programs from plain data.

Input: a picture or a lowered function. Output: dictionaries of bytes, numbers and arrays that have
nothing of the author's but names, and on the other side objects that the executor renders. Data of
textures and buffers are apart from the programs, by the hash of their content, so each is sent
once. Does not depend on Dask.
"""

from __future__ import annotations

import functools
import hashlib
import importlib
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final, TypeAlias

import numpy as np

from distal.devices.resources import LoadedData, load
from distal.ir.encoding import EncodingError, decoded, encoded
from distal.ir.types import Buffer as BufferType
from distal.ir.types import Texture
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.lang.parameters import Parameter, ParameterKind
from distal.lang.resources import Buffer, TextureValue
from distal.lang.runtime_access import executor
from distal.runtime.lowered import Lowered
from distal.runtime.received import Received
from distal.scene.lowering.parts.box_tree import BoxTree
from distal.scene.lowering.parts.moving_boxes import MovingBoxes

_LIBRARY: Final = "library:"
_CLASSES: Final = (Parameter, ParameterKind)
# Plain data: what JSON has, bytes, and arrays.
Plain: TypeAlias = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Sent:
    """What is sent of a program.

    Attributes:
        program: The program.
        digest: A hash of it and of the names of its data.
        data: Arrays and other plain data by the hash of their content.
    """

    program: Plain
    digest: str
    data: Mapping[str, Any]


@dataclass(slots=True)
class _Data:
    """Collects the data of a program."""

    found: dict[str, Any] = field(default_factory=dict)

    def name_of(self, source: Any, type: Texture | BufferType) -> str:
        """Return the name by which the other side finds the data of a texture or buffer."""
        known = _library_names().get(id(source))
        if known is not None:
            return known
        if isinstance(source, MovingBoxes):
            return self._kept(_packed_boxes(source, self))
        if not isinstance(source, Buffer | TextureValue):
            raise EncodingError(f"data of {source!r:.60} cannot be sent")
        return self._kept({"kind": "array", "array": load(source, type)})

    def _kept(self, content: Plain) -> str:
        name = digest_of(content)
        self.found[name] = content
        return name

    def module(self, lowered: Lowered) -> Plain:
        """Return a lowered function as plain data."""
        types: dict[int, Any] = {id(r.source): r.type for r in lowered.module.resources}
        name_of = lambda source: self.name_of(source, types[id(source)])  # noqa: E731
        return {
            "module": encoded(lowered.module, name_of, _CLASSES),
            "digest": lowered.digest,
            "source_hash": lowered.source_hash,
        }


def sent(image: Func | Composed) -> Sent:
    """Return a picture, or a function of its own parameters, as plain data.

    Raises:
        CompileError: It has mistakes.
        LoadError: A texture cannot be read.
    """
    data = _Data()
    program = _program(image, data)
    return Sent(program, digest_of(program), data.found)


def lowered_as_sent(lowered: Lowered) -> Sent:
    """Return a lowered picture as plain data."""
    data = _Data()
    program: Plain = {"name": "", "parts": [data.module(lowered)]}
    return Sent(program, digest_of(program), data.found)


def _program(image: Func | Composed, data: _Data) -> Plain:
    parts = executor().parts(image).parts
    made: Plain = {"name": image.name, "parts": [data.module(part) for part in parts]}
    if isinstance(image, Composed):
        photons = image.photons and [_program(each, data) for each in image.photons]
        made |= {"adaptive": image.adaptive, "refined": image.refined, "glow": image.glow}
        made |= {"photons": photons}
    return made


def received(program: Plain, data: Mapping[str, Any]) -> Received:
    """Return a program that was sent.

    Args:
        program: The program.
        data: Its data.

    Raises:
        EncodingError: The bytes are not those of a program.
    """
    kept: dict[str, Any] = {}

    def named(name: str) -> Any:
        if name not in kept:
            kept[name] = _resource(name, data)
        return kept[name]

    def lowered(part: Plain) -> Lowered:
        module = decoded(part["module"], named, _CLASSES)
        return Lowered.elsewhere(module, part["digest"], part["source_hash"])

    name = program["name"]
    first, *rest = map(lowered, program["parts"])
    photons = program.get("photons")
    return Received(
        name,
        first,
        Received(name, rest[0]) if rest else None,
        adaptive=program.get("adaptive", False),
        refined=program.get("refined", False),
        photons=[received(each, data) for each in photons] if photons else None,
        glow=program.get("glow", 0.0),
    )


def _resource(name: str, data: Mapping[str, Any]) -> Any:
    if name.startswith(_LIBRARY):
        module, _, attribute = name.removeprefix(_LIBRARY).rpartition(":")
        found = None
        if module.startswith("distal."):
            found = getattr(importlib.import_module(module), attribute, None)
        if not isinstance(found, Buffer | TextureValue):
            raise EncodingError(f"there is no data named {name!r:.80}")
        return found
    content = data[name]
    if content["kind"] == "boxes":
        return _boxes(content, data)
    return LoadedData(content["array"])


# Boxes that move


def _packed_boxes(boxes: MovingBoxes, data: _Data) -> Plain:
    tree = boxes.order
    parents = [
        ([p.start, p.stop, p.step] if isinstance(p, slice) else p, begin)
        for p, begin in tree.parents
    ]
    moving = [
        {
            "rows": [rows.start, rows.stop],
            "function": _program(function, data),
            "columns": list(columns),
        }
        for rows, function, columns in boxes.moving
    ]
    return {
        "kind": "boxes",
        "swept": np.asarray(boxes.data),
        "tree": [tree.leaves, parents, tree.order, tree.links],
        "still": list(boxes.still),
        "moving": moving,
    }


def _boxes(content: Plain, data: Mapping[str, Any]) -> MovingBoxes:
    leaves, parents, order, links = content["tree"]
    found = [(slice(*p) if isinstance(p, list) else p, begin) for p, begin in parents]
    moving = [
        (slice(*each["rows"]), received(each["function"], data), each["columns"])
        for each in content["moving"]
    ]
    tree = BoxTree(leaves, found, order, links)
    return MovingBoxes(content["swept"], tree, content["still"], moving)


# Names


def digest_of(content: Any) -> str:
    """Return a hash of plain data: dictionaries, lists, bytes, texts, numbers and arrays."""
    found = hashlib.sha256()
    _feed(content, found)
    return found.hexdigest()


def _feed(content: Any, found: Any) -> None:
    match content:
        case dict():
            found.update(b"{")
            for key, value in sorted(content.items()):
                found.update(f"{key}:".encode())
                _feed(value, found)
        case list() | tuple():
            found.update(b"[")
            for value in content:
                _feed(value, found)
        case bytes():
            found.update(content)
        case np.ndarray():
            found.update(f"{content.dtype}{content.shape}".encode())
            found.update(np.ascontiguousarray(content).tobytes())
        case _:
            found.update(repr(content).encode())
    found.update(b";")


@functools.cache
def _names_in(modules: int) -> dict[int, str]:
    """Return the names of the library's own buffers; ``modules``: how many modules there are."""
    found: dict[int, str] = {}
    for name, module in list(sys.modules.items()):
        if not name.startswith("distal."):
            continue
        for attribute, value in list(vars(module).items()):
            if isinstance(value, Buffer | TextureValue):
                found.setdefault(id(value), f"{_LIBRARY}{name}:{attribute}")
    return found


def _library_names() -> dict[int, str]:
    return _names_in(len(sys.modules))
