"""Access from ``lang`` to the parts of distal that compile and run scene code.

``lang`` only records functions. The modules named here are in higher layers: each is imported when
first used, so that importing scene code imports none of them. For type checkers the names are the
real modules.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from distal.lang.lazy_module import LazyModule
from distal.packages import explained, is_installed
from distal.session import SESSION

if TYPE_CHECKING:
    from distal.cluster import kernels as cluster_kernels
    from distal.compiler import constant_evaluation
    from distal.export import registry as exports
    from distal.frontend import python_expressions
    from distal.lang import shown_buffers
    from distal.mesh import measuring, meshing, scene_parts
    from distal.mesh.outlines import outlining
    from distal.notebook import mesh_cell, widget
    from distal.notebook.widget import LiveView
    from distal.render import filters
    from distal.runtime import executor as runtime_executor
    from distal.runtime import heights as ray_views
    from distal.runtime import standard_executor
    from distal.runtime.executor import PythonExecutor
    from distal.scene.lowering import layers as layers_of_scenes
    from distal.scene.objects import alternatives
    from distal.scene.tree import function_travel
    from distal.scene.viewing import viewable as viewing
    from distal.sweeps import sweeping
    from distal.video import recording
else:
    cluster_kernels = LazyModule("distal.cluster.kernels")
    alternatives = LazyModule("distal.scene.objects.alternatives")
    constant_evaluation = LazyModule("distal.compiler.constant_evaluation")
    exports = LazyModule("distal.export.registry")
    function_travel = LazyModule("distal.scene.tree.function_travel")
    filters = LazyModule("distal.render.filters")
    layers_of_scenes = LazyModule("distal.scene.lowering.layers")
    measuring = LazyModule("distal.mesh.measuring")
    mesh_cell = LazyModule("distal.notebook.mesh_cell")
    meshing = LazyModule("distal.mesh.meshing")
    outlining = LazyModule("distal.mesh.outlines.outlining")
    python_expressions = LazyModule("distal.frontend.python_expressions")
    ray_views = LazyModule("distal.runtime.heights")
    recording = LazyModule("distal.video.recording")
    runtime_executor = LazyModule("distal.runtime.executor")
    scene_parts = LazyModule("distal.mesh.scene_parts")
    shown_buffers = LazyModule("distal.lang.shown_buffers")
    standard_executor = LazyModule("distal.runtime.standard_executor")
    sweeping = LazyModule("distal.sweeps.sweeping")
    viewing = LazyModule("distal.scene.viewing.viewable")
    widget = LazyModule("distal.notebook.widget")


def executor() -> PythonExecutor:
    """Return the executor of this process, created on the first call.

    Without NumPy it is that of the standard library, which refuses whatever needs arrays.
    """
    return _EXECUTOR.get("") or _EXECUTOR.setdefault("", _new_executor())


_EXECUTOR: dict[str, PythonExecutor] = SESSION.keep("executor", {})


def live_view() -> type[LiveView]:
    """Return the class of live pictures in notebooks.

    Raises:
        MissingPackageError: The extra ``notebook`` is not installed, or broken.
    """
    try:
        return widget.LiveView
    except Exception as error:
        raise explained(error) or error from None


def _new_executor() -> PythonExecutor:
    if not is_installed("numpy"):
        return cast("PythonExecutor", standard_executor.StandardExecutor())
    return runtime_executor.PythonExecutor()


__all__ = [
    "alternatives",
    "cluster_kernels",
    "constant_evaluation",
    "executor",
    "exports",
    "filters",
    "function_travel",
    "layers_of_scenes",
    "live_view",
    "measuring",
    "mesh_cell",
    "meshing",
    "outlining",
    "python_expressions",
    "ray_views",
    "recording",
    "scene_parts",
    "shown_buffers",
    "sweeping",
    "viewing",
    "widget",
]
