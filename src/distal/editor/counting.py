"""How often each of the author's lines runs: the answer of ``count``.

Input: a view of a scene. Output: a program that draws the counts. It is compiled without the passes
that move, merge or drop statements, so that a line counts as often as the source says. Needs the
standard library alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePath
from typing import Final

from distal.backends import get_target
from distal.backends.glsl.backend import emit_counting
from distal.backends.glsl.counting import COUNTED, Counts
from distal.compiler.driver import run_passes
from distal.editor.messages import Counting
from distal.export.payload import TARGET, PagePrograms, lowered
from distal.scene.viewing.viewable import Viewable

# They only make a text shorter, or its work less.
OPTIMISING: Final = frozenset(
    ("fold", "frequency", "inline", "fold-inlined", "share", "predicate", "outline")
)


def counting(seen: Viewable, view: str, files: Sequence[str]) -> Counting:
    """Return the program that counts the statements of a view.

    Args:
        seen: The scene; the light of random paths is counted as direct light.
        view: The view.
        files: The author's files.

    Raises:
        CompileError: WebGL 2 cannot express it.
    """
    target = get_target(TARGET)
    module = lowered(seen.image(view, steered=seen.steers, encoded=True))
    module = run_passes(module, target, skipped=OPTIMISING)
    counts = Counts(lambda file: PurePath(file).name in files)
    artifact = emit_counting(module, target, counts)
    return Counting(
        program=PagePrograms(seen).program(artifact, module),
        which=COUNTED,
        files=tuple(files),
        places=tuple((files.index(PurePath(file).name), line) for file, line in counts.places),
    )
