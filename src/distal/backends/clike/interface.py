"""Describe what a host must provide to run a text, as JSON data.

Input: the module, and the names in the text. Output: uniforms, textures and buffers with all data
that a host or a control panel needs. Each backend adds ``stages`` and ``frame``.
"""

from __future__ import annotations

from typing import Any

from distal.backends.clike.module_names import ModuleNames
from distal.ir.nodes import Module, ResourceDeclaration, UniformDeclaration
from distal.ir.target import Target
from distal.ir.types import Buffer, Texture
from distal.version import __version__


def plain(value: Any) -> Any:
    """Return the value with tuples converted to lists, as JSON reads them."""
    return [plain(v) for v in value] if isinstance(value, tuple | list) else value


def uniform_entry(uniform: UniformDeclaration, spelled: str) -> dict[str, Any]:
    """Return the entry of a uniform: ``name`` is the author's name, ``uniform`` the text's."""
    return {
        "name": uniform.name,
        "uniform": spelled,
        "type": str(uniform.type),
        "origin": uniform.origin.value,
        "default": plain(uniform.default),
        **{key: plain(value) for key, value in uniform.interface},
    }


def texture_entry(texture: ResourceDeclaration, spelled: str) -> dict[str, Any]:
    """Return the entry of a texture; rows are uploaded bottom first: (0, 0) is the lower left."""
    return {
        "name": texture.name,
        "uniform": spelled,
        "type": str(texture.type),
        "wrap": texture.wrap,
        "filter": "linear",
        "rows": "bottom first",
    }


def buffer_entry(buffer: ResourceDeclaration, spelled: str) -> dict[str, Any]:
    """Return the entry of a read-only buffer; with its ``values`` if it holds a constant table."""
    assert isinstance(buffer.type, Buffer)
    entry = {"name": buffer.name, "uniform": spelled, "element": str(buffer.type.element)}
    return entry if buffer.values is None else entry | {"values": plain(buffer.values)}


def interface(module: Module, target: Target, names: ModuleNames) -> dict[str, Any]:
    """Return the part of the interface that all targets share.

    Args:
        module: The module after the passes.
        target: The target.
        names: The names in the text.
    """
    return {
        "distal": __version__,
        "target": target.name,
        "kind": module.kind.value,
        "uniforms": [uniform_entry(u, names.uniforms[u.name]) for u in module.uniforms],
        "textures": [
            texture_entry(r, names.resources[r.name])
            for r in module.resources
            if isinstance(r.type, Texture)
        ],
        "buffers": [
            buffer_entry(r, names.resources[r.name])
            for r in module.resources
            if isinstance(r.type, Buffer)
        ],
    }
