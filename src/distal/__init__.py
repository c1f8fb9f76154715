"""distal: 3D scenes written as ordinary Python, compiled to every target.

The names here are loaded when first used, so that ``import distal`` is quick and the compile path
needs the standard library only.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from distal.executor_hook import (
    set_calculator_loader,
    set_combiner_loader,
    set_executor_loader,
)
from distal.scene.shape_names import SHAPE_NAMES
from distal.version import __version__

if TYPE_CHECKING:
    from distal.backends.base import Artifact
    from distal.compiler import compile
    from distal.diagnostics import CompileError, LoadError
    from distal.film.picture import Picture
    from distal.lang.expressions import time
    from distal.loading import gallery, load
    from distal.scene.backgrounds import Background, Environment, Sky
    from distal.scene.cameras import (
        Camera,
        FisheyeCamera,
        OrbitCamera,
        OrthographicCamera,
        PanoramaCamera,
    )
    from distal.scene.lights import (
        AmbientLight,
        DistantLight,
        HemisphereLight,
        PointLight,
        SpotLight,
    )
    from distal.scene.materials import (
        Material,
        emissive,
        glass,
        glossy,
        matte,
        metal,
        mirror,
        plastic,
    )
    from distal.scene.patterns import (
        by_cell,
        checker,
        cube_map,
        gradient,
        image_pattern,
        noise,
        palette,
        pattern,
        stripes,
    )
    from distal.scene.scene import Scene
    from distal.scene.shape import Shape, Shape2D
    from distal.scene.shapes import *

_ROOMS = {
    "distal.backends.base": ("Artifact",),
    "distal.compiler": ("compile",),
    "distal.diagnostics": ("CompileError", "LoadError"),
    "distal.film.picture": ("Picture",),
    "distal.lang.expressions": ("time",),
    "distal.loading": ("gallery", "load"),
    "distal.scene.backgrounds": ("Background", "Environment", "Sky"),
    "distal.scene.cameras": (
        *("Camera", "FisheyeCamera", "OrbitCamera", "OrthographicCamera", "PanoramaCamera"),
    ),
    "distal.scene.lights": (
        *("AmbientLight", "DistantLight", "HemisphereLight", "PointLight", "SpotLight"),
    ),
    "distal.scene.materials": (
        *("Material", "emissive", "glass", "glossy", "matte", "metal", "mirror", "plastic"),
    ),
    "distal.scene.patterns": (
        *("by_cell", "checker", "cube_map", "gradient", "image_pattern", "noise", "palette"),
        *("pattern", "stripes"),
    ),
    "distal.scene.scene": ("Scene",),
    "distal.scene.shape": ("Shape", "Shape2D"),
    "distal.scene.shapes": SHAPE_NAMES,
}
_HOMES = {name: room for room, names in _ROOMS.items() for name in names}

__all__ = ["__version__", *_HOMES]  # noqa: PLE0604 (texts, though gathered)


def _executor() -> Any:
    return importlib.import_module("distal.executor").PythonExecutor()


def _calculator() -> Any:
    return importlib.import_module("distal.constant_values").compute


def _combiner() -> Any:
    return importlib.import_module("distal.frontend.python_expressions").combine


set_executor_loader(_executor)
set_calculator_loader(_calculator)
set_combiner_loader(_combiner)


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'distal' has no attribute '{name}'")
    value = getattr(importlib.import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOMES})
