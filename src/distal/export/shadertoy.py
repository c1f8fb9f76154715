"""Export a picture that reads earlier frames to Shadertoy: a text for each of its passes.

Input: a viewable image. Output: the text of the Image tab, those of the tabs Buffer A to D, and the
whole shader as Shadertoy's JSON. Shadertoy's Image tab cannot read its own last picture; a picture
that does is drawn by one more buffer, and the Image tab copies it.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from distal.backends import TEXT_TARGETS
from distal.compiler.driver import text_of
from distal.diagnostics import CompileError
from distal.error_codes import ErrorCode
from distal.export import texts
from distal.export.exported import Exported
from distal.export.page_options import TextOptions
from distal.file_writer import replacement
from distal.frontend import lower
from distal.ir.nodes import ResourceDeclaration
from distal.lang.chosen_values import checked_values
from distal.lang.functions import Image
from distal.lang.live_textures import LastFrame, LiveTexture
from distal.lang.runtime_access import executor
from distal.runtime.images_read import MOST_BUFFERS

if TYPE_CHECKING:
    from distal.scene.viewing.viewable import Viewable

TARGET: Final = "shadertoy"
_TABS: Final = ("Buffer A", "Buffer B", "Buffer C", "Buffer D")
_COPY: Final = """// The picture is drawn by {tab}, because it reads its own last frame.
void mainImage(out vec4 fragColor, in vec2 fragCoord) {{
    fragColor = texelFetch(iChannel0, ivec2(fragCoord), 0);
}}
"""


@dataclass(frozen=True, slots=True)
class ShaderPass:
    """A pass of a shader on Shadertoy.

    Attributes:
        tab: The name of its tab.
        text: Its text.
        channels: What is set for iChannel0, iChannel1 ...: a tab, or what a texture is.
        wraps: How each is sampled outside.
    """

    tab: str
    text: str
    channels: tuple[str, ...]
    wraps: tuple[str, ...]


def has_passes(seen: Viewable, options: TextOptions) -> bool:
    """Return whether the picture is drawn in several passes."""
    image = seen.image(options.view, encoded=True)
    return isinstance(image, Image) and bool(executor().parts(image).read.all)


def passes(seen: Viewable, options: TextOptions) -> list[ShaderPass]:
    """Return the passes of a picture, the Image tab last.

    Args:
        seen: The picture.
        options: The parameters.

    Raises:
        CompileError: Shadertoy cannot show the picture.
    """
    picture = seen.image(options.view, encoded=True)
    assert isinstance(picture, Image)
    images = executor().parts(picture).read.all
    if len(images) > MOST_BUFFERS:
        names = ", ".join(i.name for i in images)
        message = f"Shadertoy has {MOST_BUFFERS} buffers, and the picture needs {len(images)}"
        raise CompileError.at(
            ErrorCode.TARGET, f"{message}: {names}", None, "read a buffer instead of the picture"
        )
    tabs = dict(zip(images, _TABS, strict=False))
    made = [_pass(seen, image, tabs[image], tabs, options) for image in images]
    if picture in tabs:
        copied = _COPY.format(tab=tabs[picture])
        return [*made, ShaderPass("Image", copied, (tabs[picture],), ("clamp",))]
    return [*made, _pass(seen, picture, "Image", tabs, options)]


def _pass(
    seen: Viewable, image: Image, tab: str, tabs: dict[Image, str], options: TextOptions
) -> ShaderPass:
    target = TEXT_TARGETS[TARGET]
    values = checked_values(seen.parameters, options.params)
    module = texts.with_values(lower(image, table_from=None), values)
    artifact = text_of(module, target)
    sources = {resource.name: resource for resource in module.resources}
    read = [sources[entry["name"]] for entry in artifact.interface["textures"]]
    channels = tuple(_channel(r, tabs) for r in read)
    listed = "".join(f" * iChannel{i}: {c}.\n" for i, c in enumerate(channels))
    use = f"/*\n * The tab {tab} of a shader on shadertoy.com.\n{listed} */\n\n"
    wraps = tuple(r.wrap for r in read)
    return ShaderPass(tab, use + artifact.text.lstrip("\n"), channels, wraps)


def _channel(resource: ResourceDeclaration, tabs: dict[Image, str]) -> str:
    source: Any = resource.source
    if isinstance(source, LastFrame):
        return tabs[source.image]
    if isinstance(source, LiveTexture):
        return source.kind
    return f"texture {resource.name}"


def write(seen: Viewable, path: Path, options: TextOptions) -> Exported:
    """Write the Image tab, the buffers' tabs beside it, and the JSON of the whole shader.

    Args:
        seen: The picture.
        path: The file of the Image tab; the JSON for a path with the suffix .json.
        options: The parameters.

    Raises:
        CompileError: Shadertoy cannot show the picture.
        SaveError: The file system reports an error.
    """
    made = passes(seen, options)
    files = {path.with_suffix(".json"): json.dumps(shader_json(made, seen), indent=2)}
    image_file = path if path.suffix != ".json" else path.with_suffix(".glsl")
    for each in made[:-1]:
        suffix = each.tab.lower().replace(" ", "_")
        files[image_file.with_name(f"{image_file.stem}.{suffix}.glsl")] = each.text
    files[image_file] = made[-1].text
    for place, content in files.items():
        with replacement(place) as file:
            file.write(content.rstrip("\n").encode() + b"\n")
    return Exported(path, {}, tuple(f for f in files if f != path))


def shader_json(made: list[ShaderPass], seen: Viewable) -> dict[str, Any]:
    """Return a shader as Shadertoy's JSON, for programs that read it."""
    outputs = {each.tab: f"pass{i}" for i, each in enumerate(made)}
    return {
        "ver": "0.1",
        "info": {
            "name": seen.name,
            "description": "written by distal",
            "tags": ["distal"],
            "usePreview": 0,
            "flags": 32 if any("keyboard" in each.channels for each in made) else 0,
        },
        "renderpass": [_pass_json(each, outputs) for each in made],
    }


def _pass_json(each: ShaderPass, outputs: dict[str, str]) -> dict[str, Any]:
    inputs = [
        {
            "channel": i,
            "id": outputs.get(channel, channel),
            "type": "buffer" if channel in outputs else channel.partition(" ")[0],
            "sampler": {
                "filter": "linear",
                "wrap": wrap,
                "vflip": "true",
                "srgb": "false",
                "internal": "byte",
            },
        }
        for i, (channel, wrap) in enumerate(zip(each.channels, each.wraps, strict=True))
    ]
    return {
        "name": each.tab,
        "type": "image" if each.tab == "Image" else "buffer",
        "description": "",
        "inputs": inputs,
        "outputs": [{"channel": 0, "id": outputs[each.tab]}],
        "code": each.text,
    }
