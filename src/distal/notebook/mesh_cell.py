"""A mesh in a notebook cell: a frame with its triangles, which turn.

Input: a mesh. Output: HTML that needs no network and no kernel, so that it also works in a saved
notebook. The frame is sealed: its script reaches neither the notebook nor a network. Does not
depend on how the triangles were found.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Final

from distal.compiler.driver import compile
from distal.export.page import NO_SCRIPT, escaped, json_text, player_script, policy
from distal.file_writer import SaveError
from distal.mesh import preview_arithmetic
from distal.mesh.preview import MOST_TRIANGLES, preview_of

if TYPE_CHECKING:
    from distal.lang.functions import Func
    from distal.mesh.preview import Preview
    from distal.mesh.solid import Mesh

VIEWER: Final = Path(__file__).with_name("mesh_viewer.js")
TARGET: Final = "glsl-es300"
# Width and height in CSS pixels; the frame becomes narrower where the cell is.
SIZE: Final = (640, 420)
_STYLE: Final = (
    ":root{color-scheme:dark light}"
    "html,body{height:100%;margin:0}"
    "body{display:flex;flex-direction:column;background:light-dark(#f4f4f2,#151517);"
    "color:light-dark(#333,#ddd);font:13px/1.4 system-ui,sans-serif}"
    "[data-distal]{flex:1;min-height:0;display:flex}"
    "canvas{flex:1;min-width:0;height:100%;touch-action:pan-y;cursor:grab;outline-offset:-3px}"
    "canvas.held{cursor:grabbing}"
    "[data-distal] p{margin:auto;padding:1em}"
    "body>p{margin:0;padding:.5em .9em}"
)


def html_of(mesh: Mesh, most: int = MOST_TRIANGLES) -> str | None:
    """Return the HTML of a mesh; None if there is nothing to show.

    Args:
        mesh: The mesh.
        most: How many triangles are shown at most.
    """
    try:
        found = preview_of(mesh, most)
    except SaveError:  # no triangle, or a number that is not finite
        return None
    if found is None:
        return None
    width, height = SIZE
    return (
        f'<iframe title="{escaped(mesh.name)}" sandbox="allow-scripts" '
        f'style="width:100%;max-width:{width}px;height:{height}px;border:0;border-radius:6px" '
        f'srcdoc="{escaped(_document(mesh, found))}"></iframe>'
    )


def _document(mesh: Mesh, found: Preview) -> str:
    """Return the page in the frame."""
    viewer = player_script(VIEWER)
    caption = _caption(mesh, found)
    description = f"The mesh '{mesh.name}', which can be turned: {caption}"
    content = {**found.content, "texts": _texts(), "description": description}
    return (
        '<!doctype html><html lang="en"><meta charset="utf-8">'
        f'<meta http-equiv="Content-Security-Policy" content="{policy(viewer)}">'
        f"<style>{_STYLE}</style>"
        f"<div data-distal><noscript><p>{NO_SCRIPT}</p></noscript></div>"
        f'<script type="application/distal+json">{json_text(content)}</script>'
        f'<p>{escaped(caption)}</p><script type="module">{viewer.text}</script>'
    )


def _caption(mesh: Mesh, found: Preview) -> str:
    """Return the mesh's name, triangles and size, and what is not shown."""
    lengths = " x ".join(f"{length:.4g}" for length in found.size)
    text = f"{mesh.name}: {found.triangles:,} triangles, {lengths}"
    if found.shown < found.triangles:
        text += f". Shown with {found.shown:,} triangles, since it is large"
    return text


@cache
def _texts() -> dict[str, str]:
    """Return the functions of scene code that place and light the triangles, as GLSL."""
    corner, color = preview_arithmetic.seen_corner, preview_arithmetic.seen_color
    return {"corner": _text(corner), "color": _text(color)}


def _text(function: Func) -> str:
    """Return a function as GLSL, without comments."""
    text = compile(function, TARGET).text
    return "\n".join(line for line in text.splitlines() if line and not line.startswith("//"))
