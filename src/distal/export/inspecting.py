"""What a page needs to cut its scene open and to measure it: programs, the unit.

Input: an object to show. Output: the part of the payload that ``web/src/inspect`` reads. Needs the
standard library alone.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

from distal.diagnostics import CompileError, LoadError
from distal.export.page_options import PageOptions, check_buttons
from distal.export.page_programs import PagePrograms
from distal.scene.lowering.ruler import CutImage, PlaceImage, RulerImage
from distal.scene.viewing.viewable import Viewable

SCRIPT: Final = Path(__file__).with_name("inspect_player.js")


def check_inspected(seen: Viewable, options: PageOptions) -> None:
    """Check that a page can cut its object open or measure it.

    Raises:
        LoadError: It is an image.
        SaveError: The unit is unknown.
        ValueError: The page has no panel.
    """
    check_buttons(options, "a page to inspect")
    if seen.scene is None:
        raise LoadError(f"'{seen.name}' is an image: only scenes and shapes can be inspected")


def inspecting(
    seen: Viewable,
    views: list[str],
    programs: PagePrograms,
    options: PageOptions,
    omit: Callable[[str, CompileError], None],
) -> dict[str, Any]:
    """Add the programs of an inspection to a page's, and return its part of the payload.

    Args:
        seen: The object, in its mode.
        views: The views of the page.
        programs: The programs of the page.
        options: The options of the page.
        omit: Called with what WebGL 2 cannot show cut open, and its error.

    Raises:
        CompileError: WebGL 2 cannot measure it.
    """
    assert seen.scene is not None
    cut = seen.sectioned
    cuts: dict[str, int] = {}
    for view in views if cut is not None else ():
        assert cut is not None
        sampled = cut.is_sampled(view)
        image = cut.image(view, steered=True, encoded=True, sampled=sampled)
        try:
            cuts[view] = programs.add_image(image)
        except CompileError as error:
            omit(f"{view}, cut open", error)
    scenes = [seen.scene] if cut is None or cut.scene is None else [seen.scene, cut.scene]
    return {
        "cuts": cuts,
        "why": seen.uncut_reason,
        "places": [programs.add_image(PlaceImage(scene)) for scene in scenes],
        "ruler": programs.add_image(RulerImage(seen.scene)),
        "planes": programs.add_image(CutImage(seen.scene)),
        "unit": options.unit,
    }
