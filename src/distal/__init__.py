"""distal: 3D scenes written as ordinary Python, compiled to every target.

The names here are loaded when first used, so that ``import distal`` is quick and the compile path
needs the standard library only.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from distal.lang.runtime_hook import (
    set_calculator_loader,
    set_combiner_loader,
    set_executor_loader,
    set_presenter_loader,
)
from distal.shape_names import SHAPE_NAMES
from distal.version import __version__

if TYPE_CHECKING:
    from distal.backends.base import Artifact as Artifact
    from distal.compiler.driver import compile as compile
    from distal.diagnostics import CompileError as CompileError
    from distal.diagnostics import LoadError as LoadError
    from distal.images.picture import Picture as Picture
    from distal.lang.expressions import time as time
    from distal.loading import gallery as gallery
    from distal.loading import load as load
    from distal.scene.objects.backgrounds import Background as Background
    from distal.scene.objects.backgrounds import Environment as Environment
    from distal.scene.objects.backgrounds import GradientBackground as GradientBackground
    from distal.scene.objects.backgrounds import Sky as Sky
    from distal.scene.objects.cameras import Camera as Camera
    from distal.scene.objects.cameras import FisheyeCamera as FisheyeCamera
    from distal.scene.objects.cameras import OrbitCamera as OrbitCamera
    from distal.scene.objects.cameras import OrthographicCamera as OrthographicCamera
    from distal.scene.objects.cameras import PanoramaCamera as PanoramaCamera
    from distal.scene.objects.letters import SvgPath as SvgPath
    from distal.scene.objects.letters import Text as Text
    from distal.scene.objects.lights import AmbientLight as AmbientLight
    from distal.scene.objects.lights import DistantLight as DistantLight
    from distal.scene.objects.lights import HemisphereLight as HemisphereLight
    from distal.scene.objects.lights import PointLight as PointLight
    from distal.scene.objects.lights import SpotLight as SpotLight
    from distal.scene.objects.materials import Material as Material
    from distal.scene.objects.materials import emissive as emissive
    from distal.scene.objects.materials import glass as glass
    from distal.scene.objects.materials import glossy as glossy
    from distal.scene.objects.materials import matte as matte
    from distal.scene.objects.materials import metal as metal
    from distal.scene.objects.materials import mirror as mirror
    from distal.scene.objects.materials import plastic as plastic
    from distal.scene.objects.patterns import by_cell as by_cell
    from distal.scene.objects.patterns import checker as checker
    from distal.scene.objects.patterns import cube_map as cube_map
    from distal.scene.objects.patterns import gradient as gradient
    from distal.scene.objects.patterns import image_pattern as image_pattern
    from distal.scene.objects.patterns import noise as noise
    from distal.scene.objects.patterns import palette as palette
    from distal.scene.objects.patterns import pattern as pattern
    from distal.scene.objects.patterns import radial_gradient as radial_gradient
    from distal.scene.objects.patterns import stripes as stripes
    from distal.scene.objects.patterns import waves as waves
    from distal.scene.objects.shape import Shape as Shape
    from distal.scene.objects.shape import Shape2D as Shape2D
    from distal.scene.objects.shapes import *  # noqa: F403 (a stub lists them)
    from distal.scene.scene import Scene as Scene
    from distal.scene.steering import Steering as Steering

_ROOMS = {
    "distal.backends.base": ("Artifact",),
    "distal.compiler.driver": ("compile",),
    "distal.diagnostics": ("CompileError", "LoadError"),
    "distal.images.picture": ("Picture",),
    "distal.lang.expressions": ("time",),
    "distal.loading": ("gallery", "load"),
    "distal.scene.objects.backgrounds": ("Background", "Environment", "GradientBackground", "Sky"),
    "distal.scene.objects.cameras": (
        *("Camera", "FisheyeCamera", "OrbitCamera", "OrthographicCamera", "PanoramaCamera"),
    ),
    "distal.scene.objects.letters": ("SvgPath", "Text"),
    "distal.scene.objects.lights": (
        *("AmbientLight", "DistantLight", "HemisphereLight", "PointLight", "SpotLight"),
    ),
    "distal.scene.objects.materials": (
        *("Material", "emissive", "glass", "glossy", "matte", "metal", "mirror", "plastic"),
    ),
    "distal.scene.objects.patterns": (
        *("by_cell", "checker", "cube_map", "gradient", "image_pattern", "noise", "palette"),
        *("pattern", "radial_gradient", "stripes", "waves"),
    ),
    "distal.scene.scene": ("Scene",),
    "distal.scene.objects.shape": ("Shape", "Shape2D"),
    "distal.scene.objects.shapes": SHAPE_NAMES,
    "distal.scene.steering": ("Steering",),
}
_HOMES = {name: room for room, names in _ROOMS.items() for name in names}

# ``from distal import *`` leaves Python's own ``compile`` alone.
__all__ = ["__version__", *(name for name in _HOMES if name != "compile")]


def _executor() -> Any:
    return importlib.import_module("distal.runtime.executor").PythonExecutor()


def _calculator() -> Any:
    return importlib.import_module("distal.compiler.constant_evaluation").compute


def _combiner() -> Any:
    return importlib.import_module("distal.frontend.python_expressions").combine


def _presenter() -> Any:
    return importlib.import_module("distal.presenter").Presenter()


set_executor_loader(_executor)
set_calculator_loader(_calculator)
set_combiner_loader(_combiner)
set_presenter_loader(_presenter)


def _unknown(name: str) -> str:
    message = f"module 'distal' has no attribute '{name}'"
    near = importlib.import_module("difflib").get_close_matches(name, _HOMES, 1)
    return f"{message}; did you mean '{near[0]}'?" if near and name[0] != "_" else message


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(_unknown(name))
    value = getattr(importlib.import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOMES})
