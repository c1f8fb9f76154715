"""``distal.compile``: the text of a target, with all that a host needs to draw from it.

Input: a scene, an ``@image`` or a ``@func``. Output: an ``Artifact``. The compiler makes the text
(``distal.compiler.driver``); this module adds the data of textures and buffers.
"""

from __future__ import annotations

from distal.backends import TEXT_TARGETS
from distal.backends.base import Artifact
from distal.compiler.driver import compiled
from distal.export.host_data import refuse_passes, with_data
from distal.lang.composed import Composed
from distal.lang.functions import Func


def compile(obj: Func | Composed, target: str = "glsl-es300", after: str | None = None) -> Artifact:
    """Compile a scene, an ``@image`` or a ``@func`` to the text of a target.

    The interface of a shader text is complete: it has the types, places and defaults of uniforms,
    and the data of textures and buffers (``size``, ``components``, ``format``, and ``data`` in
    base64, little-endian).

    Args:
        obj: What to compile. For a ``@func``, the text contains the functions and no entry point
            (``wgsl-compute``: one that calls it for many points).
        target: One of ``COMPILE_TARGETS``: "ir", "llvm", or a text: "glsl-es300", "wgsl" ...
        after: For ``ir``: the pass after which to stop; ``"lower"`` runs no pass.

    Raises:
        CompileError: The scene code has mistakes, uses something the target does not support, or
            has a number that a shader cannot hold.
        ValueError: There is no such target or pass.
        TypeError: ``obj`` is not a scene, an ``@image`` or a ``@func``.
    """
    artifact, module = compiled(obj, target, after)
    if target not in TEXT_TARGETS:
        return artifact
    refuse_passes(module)
    return with_data(artifact, module)
