"""Pages that hold the player and a payload made for one test.

Input: GLSL, parameters, whatever a test changes of a payload. Output: an HTML file
that opens from disk. It asks nothing of the exporter, so that a fault of one is not the other's.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

PLAYER = Path(__file__).parents[2] / "src" / "distal" / "export" / "player.js"

VERTEX = """#version 300 es
void main() {
    vec2 corner = vec2(float(gl_VertexID % 2), float(gl_VertexID / 2));
    gl_Position = vec4(4.0 * corner - 1.0, 0.0, 1.0);
}
"""
HEAD = """#version 300 es
precision highp float;
precision highp int;
out vec4 fragment_color;
"""

# What a page draws is what it was told: every input is a color somewhere.
FLAT = "uniform vec3 tint;\nvoid main() { fragment_color = vec4(tint, 1.0); }\n"


def uniform(name: str, type: str, origin: str, default: Any, spelled: str = "") -> dict[str, Any]:
    return {
        "name": name,
        "uniform": spelled or name,
        "type": type,
        "origin": origin,
        "default": default,
    }


TINT = uniform("tint", "vec3", "parameter", [0.0, 0.0, 0.0])
RESOLUTION = uniform("resolution", "vec2", "frame", [1.0, 1.0])
TIME = uniform("time", "float", "frame", 0.0)
MOUSE = uniform("mouse", "vec4", "frame", [0.0, 0.0, 0.0, 0.0])
STEERING = [
    uniform("View_yaw", "float", "number", 0.0),
    uniform("View_pitch", "float", "number", 0.0),
    uniform("View_zoom", "float", "number", 1.0),
    uniform("View_pan", "vec2", "number", [0.0, 0.0]),
]


def program(body: str, *uniforms: dict[str, Any], **changes: Any) -> dict[str, Any]:
    return {
        "vertex": VERTEX,
        "fragment": HEAD + body,
        "uniforms": list(uniforms),
        "textures": [],
        "buffers": [],
        "trust": {},
        "lines": [],
        "vertex_lines": [],
        **changes,
    }


def parameter(name: str, kind: str, default: Any, **changes: Any) -> dict[str, Any]:
    return {
        "name": name,
        "label": name.replace("_", " ").capitalize(),
        "kind": kind,
        "default": default,
        "low": None,
        "high": None,
        "step": None,
        "log": False,
        "group": "",
        "help": "",
        "options": [],
        **changes,
    }


def payload(*programs: dict[str, Any], **changes: Any) -> dict[str, Any]:
    names = ["color", "normal", "depth"][: len(programs)]
    return {
        "format": 1,
        "distal": "0.1.0",
        "name": "trial",
        "description": "A trial.",
        "size": [160, 200],
        "embed": False,
        "panel": True,
        "steering": None,
        "time": {"start": 0.0, "duration": None, "animated": False},
        "parameters": [],
        "values": {},
        "views": [
            {"name": name, "label": name.capitalize(), "program": i} for i, name in enumerate(names)
        ],
        "view": names[0],
        "poster": None,
        "files": ["scene.py"],
        "programs": {"encoding": "plain", "data": list(programs)},
        "resources": {},
        **changes,
    }


def write(
    path: Path, *payloads: dict[str, Any], style: str = "height:100vh", tail: str = ""
) -> Path:
    """A page that shows the payloads, one below the other."""
    scenes = "".join(
        f'<div data-distal style="{style}"><img alt="A trial." width="4" height="3"></div>'
        f'<script type="application/distal+json">{json.dumps(p).replace("<", chr(92) + "u003c")}'
        "</script>\n"
        for p in payloads
    )
    path.write_text(
        "<!doctype html><html lang=en><meta charset=utf-8><title>Trial</title>"
        '<meta name=viewport content="width=device-width">'
        '<link rel=icon href="data:,"><style>body{margin:0}</style>\n'
        f'<body>{scenes}{tail}<script type="module">{PLAYER.read_text()}</script></body></html>'
    )
    return path
