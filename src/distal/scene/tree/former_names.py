"""Names that arguments had before the first release, with those of now.

Input: the name of a class or function, and that of an argument. Output: the hint of a refused call.
A former name is never accepted: an argument that changed its meaning would draw something else.
``tools/renames.py`` rewrites calls by the same table.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final, NamedTuple


class Renamed(NamedTuple):
    """The name of an argument now.

    Attributes:
        name: The name.
        factor: What the former value is multiplied by: 2 if it was half of an angle.
        note: Why it is called so, for the hint; or "".
    """

    name: str
    factor: int = 1
    note: str = ""

    @property
    def now(self) -> str:
        """The name of now, with the reason."""
        return f"'{self.name}'{self.note}"

    @property
    def hint(self) -> str:
        """What to write instead."""
        if self.factor == 1:
            return f"{self.name}=…{self.note}"
        return f"{self.name}={self.factor} * …{self.note}"


_OPENING: Final = Renamed("opening", 2, ", the whole angle")
_LENGTH: Final = Renamed("length", 1, ", between the centers")

# Classes, the former name of an argument, the name of now.
_ROWS: Final = (
    ("HalfSpace HalfPlane", "offset", Renamed("distance")),
    ("Moon", "offset", Renamed("shift")),
    ("Gyroid SchwarzP SchwarzD Neovius Lidinoid SplitP", "offset", Renamed("level")),
    ("IWP FischerKochS FRD", "offset", Renamed("level")),
    ("ImageField BrickField VolumeField", "scale", Renamed("value_scale")),
    ("Mandelbox", "scale", Renamed("fold_scale")),
    ("ChamferBox ChamferedRectangle KnurledCylinder Thread", "chamfer", Renamed("bevel")),
    ("TappedHole", "chamfer", Renamed("countersink")),
    ("TappedHole Nut MetricHole", "clearance", Renamed("gap")),
    ("Gear RingGear Rack RackProfile", "clearance", Renamed("tip_gap")),
    ("Rhombus", "size", Renamed("diagonals")),
    ("Triangle", "first", Renamed("a")),
    ("Triangle", "second", Renamed("b")),
    ("Triangle", "third", Renamed("c")),
    ("Gear", "bore", Renamed("bore_diameter")),
    ("Camera OrbitCamera OrthographicCamera FisheyeCamera", "mirror", Renamed("mirrored")),
    ("PanoramaCamera TurnedCamera", "mirror", Renamed("mirrored")),
    ("Text", "align", Renamed("justify")),
    ("Pie Arc Ring Horseshoe CircleWave", "angle", _OPENING),
    ("SolidAngle InfiniteCone CappedTorus", "angle", _OPENING),
    ("Wedge", "angle", Renamed("opening")),
    ("Capsule RoundCone Link UnevenCapsule Egg", "height", _LENGTH),
    ("TriPrism HexPrism OctagonPrism Prism", "apothem", Renamed("inradius")),
    ("SmoothOctahedron SmoothDodecahedron SmoothIcosahedron", "radius", Renamed("inradius")),
    ("SmoothTruncatedOctahedron SmoothTruncatedIcosahedron", "radius", Renamed("inradius")),
)


def _by_class() -> dict[str, dict[str, Renamed]]:
    found: dict[str, dict[str, Renamed]] = {}
    for classes, former, now in _ROWS:
        for name in classes.split():
            found.setdefault(name, {})[former] = now
    return found


# By the name of the class, the former names of its arguments.
FORMER_NAMES: Final[Mapping[str, Mapping[str, Renamed]]] = _by_class()

# Shapes whose first argument by position was another one: what was first is passed by name now, and
# without it, arguments by position are refused.
FORMERLY_FIRST: Final[Mapping[str, str]] = {
    "CappedTorus": "opening",
    "Link": "length",
    "Prism": "count",
    "SolidAngle": "opening",
    "VesicaSolid": "height",
}

# Of operators and methods, by the first word of their name: blends are "union circular".
FORMER_OF_OPERATORS: Final[Mapping[str, Mapping[str, Renamed]]] = {
    **{of: {"k": Renamed("smooth")} for of in ("union", "intersection", "difference", "xor")},
    **{of: {"normal": Renamed("across")} for of in ("mirror", "symmetry")},
    "pipe": {"k": Renamed("radius")},
    "engrave": {"k": Renamed("depth")},
}

# Public names, with those of now; ``gradient`` is the derivative alone.
FORMER_OBJECTS: Final[Mapping[str, Renamed]] = {
    "gradient": Renamed(
        "linear_gradient", note=", a blend of two colors; the derivative is that of distal.lang"
    ),
    "Diamond": Renamed("SchwarzD"),
    "Rhombus2": Renamed("Rhombus"),
    "Triangle2": Renamed("Triangle"),
}

# Solids whose name a flat shape has now.
_SOLIDS: Final[Mapping[str, str]] = {"Rhombus": "RhombusPrism", "Triangle": "TriangleSheet"}

# Former words for a choice.
FORMER_WORDS: Final[Mapping[str, str]] = {"centre": "center"}


def renamed(what: str, name: str) -> str | None:
    """Return what to write instead of an argument's former name; None if it is none.

    Args:
        what: The class, function or operator.
        name: The name of the argument.
    """
    rows = FORMER_NAMES.get(what) or FORMER_OF_OPERATORS.get(what.partition(" ")[0], {})
    found = rows.get(name)
    return None if found is None else found.hint


def hints_by_name(what: str, names: Iterable[str]) -> list[str]:
    """Return how arguments are passed by name, with what differs from the former ones.

    Args:
        what: The class or function.
        names: The names of the arguments.
    """
    changed = {now.name: now.hint for now in FORMER_NAMES.get(what, {}).values()}
    return [changed.get(name, f"{name}=…") for name in names]


def solid_of(what: str) -> str | None:
    """Return where the solid is that had the name of a flat shape; None if none had it."""
    return f"{what} is flat, its solid is {_SOLIDS[what]}" if what in _SOLIDS else None
