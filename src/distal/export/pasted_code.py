"""The Python line that "Copy as code" copies: what stands around the arguments of ``render``.

Input: an object, and the variable that holds it where there is one. Output: texts for the player,
which adds the arguments. A line names no folder of the machine it was made on.
"""

from __future__ import annotations

import json
from pathlib import PurePath
from typing import Final

from distal.example_files import EXAMPLE_PREFIX
from distal.lang.functions import Image
from distal.lang.render_options import RenderOptions
from distal.loading import loaded_from, split_source
from distal.scene.viewing.viewable import Viewable

_DEFAULT_SIZE: Final = RenderOptions().size


def code_around(seen: Viewable, size: tuple[int, int], variable: str | None) -> tuple[str, str]:
    """Return the texts before the arguments that the player writes, and after them.

    An object from a file is loaded from a file of this name; any other one is a variable.

    Args:
        seen: The object.
        size: Width and height of the picture in pixels.
        variable: The variable that holds it in a notebook; None if that is not known.
    """
    render = "render(" if size == _DEFAULT_SIZE else f"render(({size[0]}, {size[1]}), "
    origin = loaded_from(seen.source)
    if origin is None or variable is not None:
        name = variable or (seen.name if isinstance(seen.source, Image) else "scene")
        return f"import distal; {name}.{render}", ")"
    path, name_in_file = split_source(origin.source)
    file = path if path.startswith(EXAMPLE_PREFIX) else PurePath(path).name
    named = file if name_in_file is None else f"{file}:{name_in_file}"
    picture = f"{PurePath(file.removeprefix(EXAMPLE_PREFIX)).stem}.png"
    load = f"distal.load({json.dumps(named)})"
    return f"import distal; {load}.{render}", f").save({json.dumps(picture)})"
