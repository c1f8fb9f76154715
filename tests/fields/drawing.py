"""Numbers for shapes: their defaults, and random ones within what the row declares.

Input: rows. Output: ``Sample``s whose numbers keep every limit and requirement.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any, Final

import numpy as np

from distal.fields.guarantees import Limit, Operator, Primitive
from distal.ir.types import BOOL, FLOAT, INT, TEXTURE_2D, VEC2, VEC3, VEC4, Texture, Vector
from distal.ir.types import Buffer as BufferType
from distal.lang.resources import Buffer, Texture2D, Texture3D, TextureValue
from tests.fields.rows import Sample, Slot, default_of, slots_of

TRIES: Final = 2000
FRAME: Final = {"right", "up", "back"}  # axes that stand square on each other
NUMBERS: Final = BufferType(FLOAT)
# A polygon without crossings and a line in space, for shapes that take points.
OUTLINE: Final = [
    (0.6, 0.0), (0.3, 0.25), (0.35, 0.7), (-0.1, 0.3),
    (-0.6, 0.45), (-0.3, -0.1), (-0.4, -0.6), (0.2, -0.35),
]  # fmt: skip
LINE: Final = [(-0.6, -0.2, 0.1), (-0.1, 0.4, -0.3), (0.3, -0.1, 0.4), (0.7, 0.3, 0.0)]
# Half spaces around the origin: normal and offset.
PLANES: Final = [
    (1.0, 0.0, 0.0, 0.5), (-0.6, 0.8, 0.0, 0.4), (-0.6, -0.8, 0.0, 0.45), (0.0, 0.0, 1.0, 0.6),
    (0.0, 0.6, -0.8, 0.5), (0.48, -0.6, -0.64, 0.55),
]  # fmt: skip


def default_sample(row: Primitive) -> Sample:
    """The shape as it is when nothing is said; points where it needs some."""
    rng = np.random.default_rng(1)
    values = {s.name: _default(s, rng) for s in slots_of(row.distance)}
    return _sample(row, values)


def sample_with(row: Primitive, given: Mapping[str, Any]) -> Sample:
    """The shape with these numbers and points, the others as they are by default."""
    values: dict[str, Any] = {}
    for slot in slots_of(row.distance):
        value = given.get(slot.name, None)
        if value is None:
            values[slot.name] = _default(slot, np.random.default_rng(1))
        elif isinstance(slot.type, Texture):
            kind = Texture2D if slot.type is TEXTURE_2D else Texture3D
            values[slot.name] = kind(value, wrap="clamp")
        elif isinstance(slot.type, BufferType):
            values[slot.name] = Buffer([float(v) if np.ndim(v) == 0 else tuple(v) for v in value])
        elif isinstance(slot.type, Vector):
            values[slot.name] = tuple(map(float, value))
        else:
            values[slot.name] = float(value) if slot.type is FLOAT else value
    assert not set(given) - set(values), f"{row.name} has no {set(given) - set(values)}"
    return _sample(row, values)


def random_sample(row: Primitive, rng: np.random.Generator) -> Sample | None:
    """A shape with random numbers, or None where none were found that go together.

    What a texture or a buffer of numbers holds is made for the default numbers, and so these stay.
    """
    if any(isinstance(s.type, Texture) or s.type is NUMBERS for s in slots_of(row.distance)):
        return default_sample(row)
    for _ in range(TRIES):
        values = drawn(slots_of(row.distance), row.limits, rng)
        if fits(row, values):
            return _sample(row, values)
    return None


def drawn(
    slots: Iterable[Slot], limits: Mapping[str, Limit], rng: np.random.Generator
) -> dict[str, Any]:
    """Random values by name; whether they go together is not asked."""
    values = {s.name: _draw(s, limits.get(s.name), rng) for s in slots}
    if set(values) >= FRAME:
        axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        axes *= np.linalg.det(axes)
        values |= dict(zip(("right", "up", "back"), map(tuple, axes.tolist()), strict=True))
    return values


def fits(row: Primitive | Operator, values: dict[str, Any]) -> bool:
    """Whether numbers keep the limits and the requirement of a row."""
    for name, limit in row.limits.items():
        if not all(keeps(limit, float(v)) for v in np.ravel(_plain(values[name]))):
            return False
    return row.requires is None or row.requires(**_asked(row, values)) is None


def keeps(limit: Limit, value: float) -> bool:
    """Whether one number keeps a limit; lengths of axes are the drawing's own matter."""
    match limit:
        case Limit.POSITIVE:
            return value > 0.0
        case Limit.NOT_NEGATIVE:
            return value >= 0.0
        case Limit.NOT_ZERO:
            return value != 0.0
        case Limit.FRACTION:
            return 0.0 <= value <= 1.0
        case _:
            return True


def _asked(row: Primitive | Operator, values: dict[str, Any]) -> dict[str, Any]:
    assert row.requires is not None
    code = row.requires.__code__
    names = code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]
    return {n: _plain(values[n]) for n in names}


def _plain(value: Any) -> Any:
    return value.data if isinstance(value, Buffer) else value


def _sample(row: Primitive, values: dict[str, Any]) -> Sample:
    slots = slots_of(row.distance)
    numbers = {s.name: values[s.name] for s in slots if not s.is_choice}
    return Sample(row, numbers, {s.name: values[s.name] for s in slots if s.is_choice})


def _default(slot: Slot, rng: np.random.Generator) -> Any:
    found = default_of(slot)
    if found is not None and not isinstance(slot.type, BufferType):
        return found
    if isinstance(slot.type, Texture):
        return _texture(slot.type)
    return _points(slot, rng, 0.0)


def _points(slot: Slot, rng: np.random.Generator, jitter: float) -> Buffer:
    assert isinstance(slot.type, BufferType), f"{slot.name} needs a default"
    if slot.type is NUMBERS:
        return _brick()
    kinds = {VEC2: OUTLINE, VEC3: LINE, VEC4: PLANES}
    points = np.array(kinds[slot.type.element])
    if slot.type.element is VEC4:
        points[:, 3] *= rng.uniform(1.0 - jitter, 1.0 + jitter, len(points))
        return Buffer(points)
    return Buffer(points + rng.uniform(-jitter, jitter, points.shape))


def _brick() -> Buffer:
    """Distances to a ball of radius 0.3 in a cube of size 1: one brick, stored."""
    axes = np.meshgrid(*[(np.arange(9) + 0.5) / 9 - 0.5] * 3, indexing="ij")
    values = np.sqrt(sum(a * a for a in axes)) - 0.3
    return Buffer(np.concatenate([[1.0], np.zeros(8), values.reshape(-1)]).astype(np.float32))


def _texture(type: Texture) -> TextureValue:
    """Distances to a ball of radius 0.3 in a square or cube of size 1."""
    flat = type is TEXTURE_2D
    axes = np.meshgrid(*[(np.arange(24) + 0.5) / 24 - 0.5] * (2 if flat else 3), indexing="ij")
    values = np.sqrt(sum(a * a for a in axes)) - 0.3
    texels = np.repeat(values[..., None], 4, axis=-1).astype(np.float32)
    return (Texture2D if flat else Texture3D)(texels, wrap="clamp")


def _draw(slot: Slot, limit: Limit | None, rng: np.random.Generator) -> Any:
    default = default_of(slot) if not isinstance(slot.type, BufferType) else None
    if slot.type is FLOAT:
        return _number(default, limit, rng)
    if isinstance(slot.type, Vector):
        if limit is Limit.UNIT:
            axis = rng.normal(size=slot.type.size)
            return tuple((axis / np.linalg.norm(axis)).tolist())
        start = default or (None,) * slot.type.size
        return tuple(_number(d, limit, rng) for d in start)
    if slot.type is BOOL:
        return bool(rng.integers(2))
    if slot.type is INT:
        low = 1 if limit is Limit.POSITIVE else 0
        return int(max(low, (default or 3) + rng.integers(-2, 4)))
    return _texture(slot.type) if isinstance(slot.type, Texture) else _points(slot, rng, 0.12)


def _number(default: float | None, limit: Limit | None, rng: np.random.Generator) -> float:
    """A number of the default's size; now and then one from the edge of what is allowed."""
    size = abs(default) if default else 0.5
    edge = rng.random() < 0.1
    match limit:
        case Limit.POSITIVE:
            return 0.01 * size if edge else size * math.exp(rng.uniform(-0.8, 0.8))
        case Limit.NOT_NEGATIVE:
            return 0.0 if edge else size * math.exp(rng.uniform(-0.8, 0.8))
        case Limit.FRACTION:
            return float(rng.integers(2)) if edge else rng.random()
        case Limit.NOT_ZERO:
            return float(rng.choice([-1.0, 1.0])) * size * math.exp(rng.uniform(-0.8, 0.8))
        case _:
            return (default or 0.0) + size * rng.uniform(-0.9, 0.9)
