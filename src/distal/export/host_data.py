"""Complete the interface of a text: the data of each texture and buffer that it reads.

Input: a compiled text, and the module before the passes, whose resources have the author's data.
Output: the text with an interface that a host can draw from, without distal. Numbers are base64,
little-endian, as in pages. Needs NumPy only for files, arrays and pictures.
"""

from __future__ import annotations

import base64
import sys
from array import array
from collections.abc import Mapping
from dataclasses import replace
from math import isfinite
from typing import TYPE_CHECKING, Any, Final

from distal.backends import TEXT_TARGETS
from distal.backends.base import Artifact
from distal.backends.targets import TextTarget
from distal.compiler.carried import PAGE
from distal.diagnostics import CompileError, LoadError
from distal.error_codes import ErrorCode
from distal.export.tables import plain_resource, table
from distal.ir.nodes import Module, ResourceDeclaration
from distal.ir.types import TEXTURE_2D, Buffer, Texture
from distal.lang.lazy_module import LazyModule
from distal.lang.live_textures import LastFrame, LiveTexture
from distal.passes.author_places import place_of_resource

if TYPE_CHECKING:
    from distal.export import resources
else:
    resources = LazyModule("distal.export.resources")  # needs NumPy

# What a consumer needs of an entry of a page's data; the type is in the interface.
_KEYS: Final = ("size", "components", "format", "data")
_DATA: Final = "data"
_LIVE: Final = "live"
_FLOAT: Final = "float32"
_BYTES: Final = "rgba8"


def with_data(artifact: Artifact, module: Module) -> Artifact:
    """Return a text whose interface has the data of the textures and buffers that it reads.

    Args:
        artifact: The text.
        module: The module before the passes.

    Raises:
        CompileError: Data cannot be read, or a number is none that a shader can hold.
    """
    sources = {resource.name: resource for resource in module.resources}
    interface = dict(artifact.interface)
    for key in ("textures", "buffers"):
        entries = interface.get(key, ())
        interface[key] = [_complete(entry, sources.get(entry["name"]), module) for entry in entries]
    target = TEXT_TARGETS[interface["target"]]
    if not target.is_described:
        for entry in interface["textures"]:
            _check_picture(entry, module, target)
    return replace(artifact, interface=interface)


def _check_picture(entry: Mapping[str, Any], module: Module, target: TextTarget) -> None:
    """Check that a texture can be a picture in a file beside a text.

    Raises:
        CompileError: It is no flat picture of 8 bits, for a host that reads no other.
    """
    if _LIVE in entry or (entry["type"] == str(TEXTURE_2D) and entry["format"] == _BYTES):
        return
    is_flat = entry["type"] == str(TEXTURE_2D)
    has = "numbers that 8 bits cannot hold" if is_flat else f"the type {entry['type']}"
    able = [t.name for t in TEXT_TARGETS.values() if t.is_described and t.texel_fetch]
    raise CompileError.at(
        ErrorCode.TARGET,
        f"{target.host} reads pictures of 8 bits from files, and '{entry['name']}' has {has}",
        place_of_resource(module, entry["name"]),
        f"targets that have it: {', '.join((*able, PAGE))}",
    )


def refuse_passes(module: Module) -> None:
    """Check that a picture is drawn in one pass: a single text holds no other.

    Raises:
        CompileError: It reads an earlier frame.
    """
    for resource in module.resources:
        if isinstance(resource.source, LastFrame):
            raise CompileError.at(
                ErrorCode.TARGET,
                f"one text is one pass, and '{resource.name}' is drawn by a pass before it",
                place_of_resource(module, resource.name),
                "distal export writes all passes for Shadertoy, and pages",
            )


def _complete(
    entry: Mapping[str, Any], resource: ResourceDeclaration | None, module: Module
) -> dict[str, Any]:
    if "values" in entry:
        found = table(entry)
    else:
        assert resource is not None, entry["name"]
        if isinstance(resource.source, LiveTexture):
            return {**entry, _LIVE: resource.source.kind}
        found = _data_of(resource, module)
    if "grey" in found:
        found = {**found, "components": 1}  # of three equal numbers, one is stored
    plain = {key: value for key, value in entry.items() if key != "values"}
    return plain | {key: found[key] for key in _KEYS}


def _data_of(resource: ResourceDeclaration, module: Module) -> dict[str, Any]:
    assert isinstance(resource.type, Texture | Buffer)
    try:
        found = plain_resource(resource.source, resource.type)
        found = found or resources.resource(resource.source, resource.type)
    except LoadError as error:
        span = place_of_resource(module, resource.name)
        message = f"the data of '{resource.name}' cannot be exported: {error.message}"
        raise CompileError.at(ErrorCode.TARGET, message, span, error.hint) from None
    _check(found, resource, module)
    return found


def _check(found: Mapping[str, Any], resource: ResourceDeclaration, module: Module) -> None:
    """Check that every number is one that a shader can hold.

    Raises:
        CompileError: One is too large for 32 bits, infinite or not a number.
    """
    if found["format"] != _FLOAT:
        return
    numbers = array("f", base64.b64decode(found[_DATA]))
    if sys.byteorder == "big":
        numbers.byteswap()
    if isfinite(sum(map(abs, numbers))):  # in 64 bits, so that finite numbers have a finite sum
        return
    first = next(i for i, number in enumerate(numbers) if not isfinite(number))
    raise CompileError.at(
        ErrorCode.NUMBER,
        f"number {first} of '{resource.name}' is {numbers[first]} as a 32-bit float, which a "
        "shader cannot hold",
        place_of_resource(module, resource.name),
        "replace it in the data by a finite number of at most 3.4e38",
    )
