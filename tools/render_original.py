"""Render one GLSL fragment text to a PNG file: makes the pictures in tests/originals.

Input: a shader text, a size, a time and further uniform values. Output: an 8-bit RGB picture, top
row first, of exactly what the shader wrote (no color conversion); with ``--record`` also an entry
in the ``index.json`` next to it. Does not use distal: distal is compared with its pictures.

    python tools/render_original.py shader.frag out.png --time 1.7 --set u_blend=0.3
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from PIL import Image

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from tests.egl import EglShader, EglUnavailableError, ShaderRejectedError, to_bytes

Number = float | list[float]


def parse_size(text: str) -> tuple[int, int]:
    """``320x240`` as (320, 240)."""
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal() and int(width) and int(height)):
        raise argparse.ArgumentTypeError(f"{text!r} is not a size such as 320x240")
    return int(width), int(height)


def parse_setting(text: str) -> tuple[str, Number]:
    """``name=1.5`` or ``name=1,0,0`` as a name and its value."""
    name, equals, value = text.partition("=")
    try:
        numbers = [float(part) for part in value.split(",")]
    except ValueError:
        numbers = []
    if not (name and equals and numbers):
        raise argparse.ArgumentTypeError(f"{text!r} is not name=number or name=number,number,...")
    return name, numbers[0] if len(numbers) == 1 else numbers


def record(
    path: Path, example: str, size: tuple[int, int], time: float, set_: dict[str, Number]
) -> None:
    """Enter the picture in the ``index.json`` of its folder, replacing an older entry of it."""
    index = path.parent / "index.json"
    entries = json.loads(index.read_text("utf-8")) if index.exists() else []
    entries = [entry for entry in entries if entry["file"] != path.name]
    entries.append(
        {
            "file": path.name,
            "example": example,
            "size": list(size),
            "time": time,
            "parameters": set_,
        }
    )
    entries.sort(key=lambda entry: entry["file"])
    lines = ",\n".join("  " + json.dumps(entry) for entry in entries)
    index.write_text(f"[\n{lines}\n]\n", "utf-8")


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("fragment", type=Path, metavar="FRAG", help="text of the fragment stage")
    parser.add_argument("output", type=Path, metavar="OUT.png")
    parser.add_argument("--vertex", type=Path, help="text of the vertex stage that feeds it")
    parser.add_argument("--version", default="100", help="for texts without a #version line")
    parser.add_argument("--size", type=parse_size, default=(320, 240), metavar="WxH")
    parser.add_argument("--time", type=float, default=0.0, help="value of u_time, in seconds")
    parser.add_argument("--set", type=parse_setting, action="append", default=[], metavar="NAME=V")
    parser.add_argument("--record", metavar="EXAMPLE", help="also enter it in OUT's index.json")
    return parser.parse_args()


def main() -> int:
    """Render as the command line says; 1 with the reason on stderr if that cannot be done."""
    options = arguments()
    width, height = options.size
    settings = dict(options.set)
    # What every page that hosts such shaders provides; a shader takes those that it names.
    provided = {"u_time": options.time, "u_resolution": [width, height], "u_aspect": width / height}
    try:
        vertex_text = options.vertex.read_text("utf-8") if options.vertex else None
        shader = EglShader(options.fragment.read_text("utf-8"), options.version, vertex_text)
        taken = {name: value for name, value in provided.items() if name in shader.uniforms}
        picture = shader.render((width, height), taken | settings)
        Image.fromarray(to_bytes(picture), "RGB").save(options.output)
        if options.record:
            record(options.output, options.record, options.size, options.time, settings)
    except (OSError, ValueError, EglUnavailableError, ShaderRejectedError) as error:
        print(f"render_original: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
