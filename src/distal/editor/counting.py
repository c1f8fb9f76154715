"""What each of the author's lines costs: the answers of ``count`` and ``time``.

Input: a view of a scene. Output: a program that draws the counts of runs or of operations, or one
that repeats a line. They are compiled without the passes that move or merge statements, so that a
line counts as often as the source says. Needs the standard library alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePath
from typing import Final

from distal.backends import get_target
from distal.backends.glsl.backend import emit_counting, emit_timing
from distal.backends.glsl.counting import COUNTED, MOST, Counts
from distal.backends.glsl.instruments import Instrument
from distal.backends.glsl.timing import CHOICE, REPEATS, Repetitions
from distal.backends.glsl.work import WorkCounts
from distal.compiler.driver import run_passes
from distal.editor.messages import Counting, LineTiming
from distal.export.page_programs import TARGET, PagePrograms, lowered
from distal.ir.nodes import Module
from distal.passes.cost import own_cost
from distal.scene.viewing.viewable import Viewable

# They move, merge or drop statements.
MOVING: Final = frozenset(("inline", "fold-inlined", "share", "predicate", "outline"))
# They replace what is the same for all pixels, or known before, by its value.
KNOWING: Final = frozenset(("fold", "frequency"))


def counting(seen: Viewable, view: str, files: Sequence[str], *, work: bool = False) -> Counting:
    """Return the program that counts the runs of the lines of a view, or their work.

    Args:
        seen: The scene; the light of random paths is counted as direct light.
        view: The view.
        files: The author's files.
        work: Whether estimated operations are counted, without those of values that are the same
            for all pixels: the compiler computes them once a frame.

    Raises:
        CompileError: WebGL 2 cannot express it.
    """
    counts = (WorkCounts if work else Counts)(lambda file: PurePath(file).name in files, own_cost)
    module = _unmoved(seen, view, MOVING if work else MOVING | KNOWING)
    artifact = emit_counting(module, get_target(TARGET), counts)
    return Counting(
        program=PagePrograms(seen).program(artifact, module),
        which=COUNTED,
        most=MOST,
        files=tuple(files),
        places=_places(counts, files),
    )


def timing(seen: Viewable, view: str, files: Sequence[str]) -> LineTiming:
    """Return the program that repeats what a line of a view computes.

    Args:
        seen: The scene; the light of random paths is measured as direct light.
        view: The view.
        files: The author's files.

    Raises:
        CompileError: WebGL 2 cannot express it.
    """
    measured = Repetitions(lambda file: PurePath(file).name in files, own_cost)
    module = _unmoved(seen, view, MOVING)
    artifact = emit_timing(module, get_target(TARGET), measured)
    return LineTiming(
        program=PagePrograms(seen).program(artifact, module),
        choice=CHOICE,
        repeats=REPEATS,
        files=tuple(files),
        places=_places(measured, files),
        evaluations=tuple(map(measured.evaluations, range(len(measured.places)))),
    )


def _unmoved(seen: Viewable, view: str, skipped: frozenset[str]) -> Module:
    """Return the module of a view in which statements are where the author wrote them."""
    module = lowered(seen.image(view, steered=seen.steers, encoded=True))
    return run_passes(module, get_target(TARGET), skipped=skipped)


def _places(measured: Instrument, files: Sequence[str]) -> tuple[tuple[int, int], ...]:
    return tuple((files.index(PurePath(file).name), line) for file, line in measured.places)
