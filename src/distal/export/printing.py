"""What a page needs to save a part for printing: programs, tables, and the frames of files.

Input: an object to show. Output: the part of the payload that ``web/src/print`` reads, and the
script that reads it.
"""

from __future__ import annotations

import base64
import math
from pathlib import Path
from typing import Any, Final

from distal.diagnostics import LoadError
from distal.export.page_options import PageOptions, check_buttons
from distal.export.page_programs import PagePrograms
from distal.lang.units import MILLIMETER, meters_of
from distal.mesh.files import stl, three_mf
from distal.mesh.meshing import MeshRequest, extent_of
from distal.mesh.printable import BUFFERS, packed_tables, print_passes
from distal.mesh.scene_parts import united, with_end
from distal.scene.objects.shape import Shape2D
from distal.scene.tree.node import Node
from distal.scene.viewing.viewable import Viewable

SCRIPT: Final = Path(__file__).with_name("print.js")


def check_solid(obj: object) -> None:
    """Check that an object is not flat, before it becomes a scene in which it is a plate.

    Raises:
        LoadError: It is.
    """
    if isinstance(obj, Shape2D):
        raise LoadError(f"'{obj.name}' is a flat shape: .extrude(height) makes a solid")


def printed_node(seen: Viewable, options: PageOptions) -> tuple[Node, list[str]]:
    """Return the tree of the part that a page saves, and in words what has no end and is left out.

    Args:
        seen: The object to show.
        options: The options of the page.

    Raises:
        LoadError: It is an image.
        SaveError: The unit is unknown.
        SceneValueError: Nothing of it has an end.
        ValueError: The page has no panel, or the tolerance is no length.
    """
    if options.tolerance is not None and not 0.0 < options.tolerance < math.inf:
        raise ValueError(f"a tolerance is a length above 0, not {options.tolerance!r:.40}")
    check_buttons(options, "a printable page")
    if seen.scene is None:
        raise LoadError(f"'{seen.name}' is an image: only solids are printable")
    node = seen.scene.subject.node
    request = MeshRequest(params=options.params or {}, time=options.time)
    finite, endless = with_end(node, request)
    made = united(finite) if endless else node
    extent_of(made, request)
    return made, endless


def printing(node: Node, name: str, programs: PagePrograms, options: PageOptions) -> dict[str, Any]:
    """Add the passes of a part's mesh to a page's programs, and return its part of the payload.

    Args:
        node: The tree.
        name: The name of the part in files.
        programs: The programs of the page.
        options: The options of the page.

    Raises:
        CompileError: WebGL 2 cannot run them.
    """
    passes = print_passes(node, options.tolerance)
    numbers = {name: programs.add_image(image) for name, image in passes.images.items()}
    lengths, tables = packed_tables()
    return {
        "programs": numbers,
        "buffers": {programs.name_of(buffer): name for name, buffer in BUFFERS.items()},
        "lengths": lengths,
        "tables": base64.b64encode(tables).decode("ascii"),
        "scale": meters_of(options.unit) / MILLIMETER,
        "frame": {**three_mf.frame_of(name), "stl": stl.HEADER.decode("ascii")},
        "isSharp": passes.is_sharp,
    }
