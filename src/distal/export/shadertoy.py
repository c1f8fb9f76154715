"""Export a picture that reads earlier frames to Shadertoy: a text for each of its passes.

Input: a viewable image. Output: the text of the Image tab, those of the tabs Buffer A to D, and the
whole shader as Shadertoy's JSON. Shadertoy's Image tab cannot read its own last picture; a picture
that does is drawn by one more buffer, and the Image tab copies it.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any, Final

from distal.backends import TEXT_TARGETS
from distal.compiler.driver import text_of
from distal.diagnostics import CompileError
from distal.error_codes import ErrorCode
from distal.export import texts
from distal.export.exported import Exported
from distal.export.host_data import with_data
from distal.export.page_options import TextOptions
from distal.file_writer import replacement
from distal.frontend import lower
from distal.lang.chosen_values import checked_values
from distal.lang.functions import Image
from distal.lang.live_textures import LastFrame
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
        pictures: The files of its textures.
    """

    tab: str
    text: str
    channels: tuple[str, ...]
    wraps: tuple[str, ...]
    pictures: Mapping[str, bytes] = field(default_factory=dict)


def has_passes(seen: Viewable, options: TextOptions) -> bool:
    """Return whether the picture is drawn in several passes."""
    image = seen.image(options.view, encoded=True)
    return isinstance(image, Image) and bool(executor().parts(image).read.all)


def passes(seen: Viewable, options: TextOptions, stem: str) -> list[ShaderPass]:
    """Return the passes of a picture, the Image tab last.

    Args:
        seen: The picture.
        options: The parameters.
        stem: The name of the file of the Image tab, without its suffix.

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
    made = [_pass(seen, image, tabs[image], tabs, options, stem) for image in images]
    if picture in tabs:
        copied = _COPY.format(tab=tabs[picture])
        return [*made, ShaderPass("Image", copied, (tabs[picture],), ("clamp",))]
    return [*made, _pass(seen, picture, "Image", tabs, options, stem)]


def _pass(
    seen: Viewable, image: Image, tab: str, tabs: dict[Image, str], options: TextOptions, stem: str
) -> ShaderPass:
    target = TEXT_TARGETS[TARGET]
    values = checked_values(seen.parameters, options.params)
    module = texts.with_values(lower(image, table_from=None), values)
    artifact = with_data(text_of(module, target), module)
    stem = stem if tab == "Image" else f"{stem}.{tab.lower().replace(' ', '_')}"
    sources = {resource.name: resource.source for resource in module.resources}
    read = artifact.interface["textures"]
    channels = tuple(_channel(entry, sources[entry["name"]], tabs, stem) for entry in read)
    listed = "".join(f" * iChannel{i}: {c}.\n" for i, c in enumerate(channels))
    use = f"/*\n * The tab {tab} of a shader on shadertoy.com.\n{listed} */\n\n"
    wraps = tuple(entry["wrap"] for entry in read)
    pictures = texts.pictures_of(artifact, stem)
    return ShaderPass(tab, use + artifact.text.lstrip("\n"), channels, wraps, pictures)


def _channel(entry: Mapping[str, Any], source: Any, tabs: dict[Image, str], stem: str) -> str:
    if isinstance(source, LastFrame):
        return tabs[source.image]
    name = texts.picture_name(entry, stem)
    return str(entry["live"]) if name is None else f"texture {name}"


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
    files = {path.with_name(name): content for name, content in tabs_of(seen, path, options)}
    for place, content in files.items():
        with replacement(place) as file:
            file.write(content)
    return Exported(path, {}, tuple(f for f in files if f != path))


def tabs_of(seen: Viewable, path: PurePath, options: TextOptions) -> list[tuple[str, bytes]]:
    """Return the names and contents of a picture's files: its JSON, its tabs, its pictures.

    Args:
        seen: The picture.
        path: As for ``write``.
        options: The parameters.

    Raises:
        CompileError: Shadertoy cannot show the picture.
    """
    made = passes(seen, options, path.stem)
    files = {f"{path.stem}.json": texts.text_bytes(json.dumps(shader_json(made, seen), indent=2))}
    for each in made[:-1]:
        suffix = each.tab.lower().replace(" ", "_")
        files[f"{path.stem}.{suffix}.glsl"] = texts.text_bytes(each.text)
    image = path.name if path.suffix != ".json" else f"{path.stem}.glsl"
    files[image] = texts.text_bytes(made[-1].text)
    for each in made:
        files |= each.pictures
    return list(files.items())


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
