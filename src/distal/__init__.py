"""distal: 3D scenes written as ordinary Python, compiled to every target.

Each name is imported when it is first used, so that ``import distal`` is fast and compiling needs
only the standard library. A name that needs a missing package reports it when it is used.
"""

from __future__ import annotations

import importlib

from distal.public_names import DECLARED_NAMES
from distal.version import __version__

# As ``typing`` has it, which takes longer to import than all of this.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

# The hand-written public names by module; ``tools/gen_stubs.py`` reads them, too.
_HAND_WRITTEN = {
    "distal.backends.base": ("Artifact",),
    "distal.diagnostics": ("CompileError", "LoadError"),
    "distal.images.height_map": ("HeightMap",),
    "distal.images.picture": ("Picture",),
    "distal.lang.expressions": ("time",),
    "distal.lang.places": ("cell", "place", "random_by_cell"),
    "distal.lang.units": ("cm", "deg", "foot", "inch", "meter", "mm"),
    "distal.example_files": ("gallery",),
    "distal.export.compiling": ("compile",),
    "distal.loading": ("load",),
    "distal.render.material": ("Surface",),
    "distal.scene.checks.furnace": ("furnace",),
    "distal.scene.groups": ("Group", "group"),
    "distal.scene.looks.look": ("Look",),
    "distal.scene.objects.alternatives": ("choose",),
    "distal.scene.objects.backgrounds": ("Background", "Environment"),
    "distal.scene.objects.copies": ("copies",),
    "distal.scene.objects.fasteners": ("Bolt", "MetricHole", "MetricThread", "Nut"),
    "distal.scene.objects.gears": ("Gear", "Rack", "RingGear", "mesh_gears"),
    "distal.scene.objects.joined": ("difference", "intersection", "union", "xor"),
    "distal.scene.objects.letters": ("SvgPath", "Text"),
    "distal.scene.objects.materials": ("Material", "glass"),
    "distal.scene.objects.patterns": ("cube_map", "image_pattern", "pattern"),
    "distal.scene.objects.shape": ("Shape", "Shape2D"),
    "distal.scene.points.curves": ("circle_path", "helix_path", "points_along"),
    "distal.scene.points.formula_curve": ("Curve",),
    "distal.scene.points.scatter": ("points_in", "points_on"),
    "distal.scene.scene": ("Scene",),
    "distal.scene.steering": ("Steering",),
    "distal.sweeps.drawing": ("parameter_sets",),
    "distal.lang.option_methods": ("sweep",),
}
_MODULE_OF = {
    **{name: module for module, names in _HAND_WRITTEN.items() for name in names},
    **{name: module for module, names in DECLARED_NAMES.items() for name in names.split()},
}

# Left out, so that ``from distal import *`` hides neither Python's ``compile`` nor its module
# ``time``.
_NOT_STARRED = ("compile", "time")
__all__ = ["__version__", *(name for name in _MODULE_OF if name not in _NOT_STARRED)]


def _unknown(name: str) -> str:
    message = f"module 'distal' has no attribute '{name}'"
    former = importlib.import_module("distal.scene.tree.former_names").FORMER_OBJECTS
    if name in former:
        return f"{message}; it is {former[name].now}"
    if name in importlib.import_module("distal.lang").__all__:
        return f"{message}; from distal.lang import {name}"
    near = importlib.import_module("difflib").get_close_matches(name, _MODULE_OF, 1)
    return f"{message}; did you mean '{near[0]}'?" if near and name[0] != "_" else message


def __getattr__(name: str) -> Any:
    if name not in _MODULE_OF:
        raise AttributeError(_unknown(name))
    try:
        # Of what modules define, nothing is ever garbage.
        with importlib.import_module("distal.ir.collection").paused_collection():
            value = getattr(importlib.import_module(_MODULE_OF[name]), name)
    except ModuleNotFoundError as error:
        # So that ``from distal import *`` works wherever scenes compile.
        return importlib.import_module("distal.packages").stand_in(name, error)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*__all__, *_NOT_STARRED})
