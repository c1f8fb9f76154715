"""The memory layout of a kernel's uniforms, per-frame values, resources, arguments and results.

Input: a module after the passes. Output: slot numbers as JSON data, so that a stored kernel can be
called without compiling its module again. A slot holds one scalar: a float of the precision, or an
int in its low four bytes (bools are 0 or 1).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Final

from distal.backends.llvm.lanes import leaf_kinds
from distal.ir.nodes import EntryKind, Module
from distal.ir.types import Array, Buffer, Kind, Matrix, Scalar, Struct, Texture, Type, Vector

# Names of the exported functions; each takes a job.
RENDER: Final = "distal_render"
FRAME: Final = "distal_frame"
BATCH: Final = "distal_batch"
PIXELS: Final = "distal_pixels"

# The fields of a job, the argument of a kernel: eight bytes each, in this order.
JOB_FIELDS: Final = (
    "counter",  # pointer: the next tile
    "stop",  # pointer: 0, STOP or LEAVE
    "uniforms",  # pointer
    "frame",  # pointer
    "resources",  # pointer: four eight-byte numbers each: data, width or count, height, depth
    "output",  # pointer: pixels, or result leaves
    "input",  # pointer: argument leaves, or pixels
    "width",  # pixels across, or total number of points
    "height",  # pixels down
    "tiles_across",
    "tiles",  # total number
    "stride",  # points from one leaf of arguments or results to the next
)
JOB_OFFSET: Final = {name: 8 * i for i, name in enumerate(JOB_FIELDS)}
RESOURCE_BYTES: Final = 32

STOP: Final = 1  # ends the work at once; tiles remain incomplete
LEAVE: Final = 2  # ends it after the tiles that are being computed

TILE_WIDTH, TILE_HEIGHT = 64, 16  # pixels; multiples of every block's sides
TILE_BLOCKS = 64  # blocks of points in a tile of a batch


def shape_of(type: Type) -> Any:
    """Return a type as plain data, for calling a kernel: kind and size, fields, length."""
    match type:
        case Scalar(kind):
            return {"kind": kind.value}
        case Vector(kind, size):
            return {"kind": kind.value, "size": size}
        case Matrix(size):
            return {"kind": Kind.FLOAT.value, "columns": size}
        case Struct(name, fields, is_tuple):
            parts = [[field_name, shape_of(t)] for field_name, t in fields]
            return {"struct": name, "tuple": is_tuple, "fields": parts}
        case Array(element, length):
            return {"element": shape_of(element), "length": length}
        case _:
            raise AssertionError(f"{type} is not a value")


def kinds_in(shape: Any) -> list[str]:
    """Return the kinds of the leaves of a shape."""
    if "struct" in shape:
        return [k for _, part in shape["fields"] for k in kinds_in(part)]
    if "element" in shape:
        return kinds_in(shape["element"]) * int(shape["length"])
    return [shape["kind"]] * (shape.get("size", 1) * shape.get("columns", 1) ** 2)


@dataclass(slots=True)
class KernelLayout:
    """The slots of a kernel's inputs.

    Attributes:
        uniforms: The first slot of each uniform.
        uniform_slots: The number of slots of all uniforms.
        frame: The first slot of each per-frame value.
        frame_slots: The number of slots of all per-frame values.
        resources: The number of each resource.
    """

    uniforms: dict[str, int] = field(default_factory=dict)
    uniform_slots: int = 0
    frame: dict[str, int] = field(default_factory=dict)
    frame_slots: int = 0
    resources: dict[str, int] = field(default_factory=dict)

    @staticmethod
    def of(module: Module) -> KernelLayout:
        """Return the layout of a module."""
        layout = KernelLayout()
        for uniform in module.uniforms:
            layout.uniforms[uniform.name] = layout.uniform_slots
            layout.uniform_slots += len(leaf_kinds(uniform.type))
        for name, value in module.frame:
            layout.frame[name] = layout.frame_slots
            layout.frame_slots += len(leaf_kinds(value.type))
        layout.resources = {r.name: i for i, r in enumerate(module.resources)}
        return layout


def description(module: Module) -> dict[str, Any]:
    """Return the data that a host needs to call the kernels of a module, as plain data."""
    layout = KernelLayout.of(module)
    entry = module.function(module.entry)
    image = module.kind is EntryKind.IMAGE
    return {
        "kind": module.kind.value,
        "entry": module.entry,
        "uniforms": [
            [u.name, layout.uniforms[u.name], shape_of(u.type), _plain(u.default)]
            for u in module.uniforms
        ],
        "uniform_slots": layout.uniform_slots,
        "frame_slots": layout.frame_slots,
        "resources": [_resource(r.name, r.type) for r in module.resources],
        "params": [] if image else [[p.name, shape_of(p.type)] for p in entry.params],
        "result": shape_of(entry.result),
    }


def _resource(name: str, type: Type) -> list[Any]:
    match type:
        case Buffer(element):
            return [name, "buffer", shape_of(element)]
        case Texture(texture):
            return [name, texture.value, {"kind": Kind.FLOAT.value, "size": 4}]
        case _:
            raise AssertionError(f"{type} is not a resource")


def _plain(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value
