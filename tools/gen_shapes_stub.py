"""Write what editors and type checkers know of the shapes' classes.

The classes are made from the field library's rows when they are imported. This writes
``src/distal/scene/objects/shapes.pyi`` with their signatures and first sentences, and
``src/distal/shape_names.py`` with their names alone, for ``import distal`` to know them
without loading them. Run it after any change of the library; a test fails when it was forgotten.
"""

from __future__ import annotations

import inspect
from pathlib import Path

from distal.lang.functions import Func
from distal.scene.objects import shapes
from distal.scene.tree.arguments import slots_of

ROOM = Path(__file__).parents[1] / "src" / "distal" / "scene"

STUB_HEAD = '''"""Signatures of the shapes' classes. Made by tools/gen_shapes_stub.py."""

from collections.abc import Sequence
from os import PathLike
from typing import Any, TypeAlias

from distal.lang.expressions import Expression
from distal.lang.parameters import Parameter
from distal.lang.resources import Buffer, TextureValue
from distal.scene.objects.shape import Shape, Shape2D

Number: TypeAlias = float | Parameter | Expression
Vector: TypeAlias = Sequence[Number] | Parameter | Expression | Any
Points: TypeAlias = Sequence[Sequence[float]] | Buffer | Any
Image: TypeAlias = TextureValue | str | PathLike[str]
'''

NAMES_HEAD = '''"""The names of the shapes' classes. Made by tools/gen_shapes_stub.py."""

from __future__ import annotations

from typing import Final

'''


def stub() -> str:
    """The text of ``shapes.pyi``."""
    parts = [STUB_HEAD]
    for name, cls in shapes.CLASSES.items():
        base = "Shape2D" if cls.flat else "Shape"
        row = cls.row
        first = (inspect.getdoc(row.distance) or "").split("\n\n")[0].replace("\n", " ")
        params = ", ".join(["self", *_parameters(row.distance)])
        line = f"    def __init__({params}) -> None: ..."
        if len(line) > 100:
            inner = "".join(f"        {p},\n" for p in params.split(", "))
            line = f"    def __init__(\n{inner}    ) -> None: ..."
        parts.append(f'class {name}({base}):\n    """{first}"""\n\n{line}\n')
    ordered = sorted(shapes.CLASSES, key=lambda name: (not name.isupper(), name))
    listed = "".join(f'    "{name}",\n' for name in ordered)
    parts.append(f"CLASSES: dict[str, type[Shape] | type[Shape2D]]\n\n__all__ = [\n{listed}]\n")
    return "\n".join(parts)


def _parameters(func: Func) -> list[str]:
    made = []
    for slot in slots_of(func):
        if slot.name in ("p", "cell"):
            continue
        kind = _annotation(str(slot.type))
        default = "" if slot.default is inspect.Parameter.empty else " = ..."
        if isinstance(slot.default, bool | int | float):
            default = f" = {slot.default}"
        made.append(f"{slot.name}: {kind}{default}")
    return made


def _annotation(type: str) -> str:
    if type.startswith("Buffer"):
        return "Points"
    if type.startswith("Texture"):
        return "Image"
    return {"float": "Number", "int": "int", "bool": "bool"}.get(type, "Vector")


def names() -> str:
    """The text of ``shape_names.py``."""
    listed = "".join(f'    "{name}",\n' for name in sorted(shapes.CLASSES))
    return f"{NAMES_HEAD}SHAPE_NAMES: Final = (\n{listed})\n"


FILES = {ROOM / "objects" / "shapes.pyi": stub, ROOM.parent / "shape_names.py": names}

if __name__ == "__main__":
    for path, text in FILES.items():
        path.write_text(text(), encoding="utf-8")
        print(path.relative_to(ROOM.parents[2]))
