"""A host that knows the files of an export alone: no scene, no loader of distal.

Input: the path of an exported text. Output: its picture. What the text reads comes from the .json
beside it, or from the pictures that its comment names.
"""

from __future__ import annotations

import base64
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from distal.backends.base import Artifact
from tests import gpu
from tests.glsl import run_glsl

FORMATS = {"rgba8": np.uint8, "float16": "<f2", "float32": "<f4", "int32": "<i4", "uint32": "<u4"}
CHANNEL = re.compile(r"^ \* (iChannel\d|u_tex\d): (\S+\.png), by ", re.MULTILINE)


def drawn(path: Path, size: tuple[int, int], time: float = 0.0) -> NDArray[np.float32]:
    """The picture of a text with an interface, float32, top row first."""
    interface = json.loads(path.with_suffix(".json").read_text("utf-8"))
    vertex = path.with_suffix(".vert")
    text = path.read_text("utf-8")
    artifact = Artifact(text, interface, vertex.read_text("utf-8") if vertex.exists() else None)
    textures = {entry["name"]: texels(entry) for entry in interface["textures"]}
    buffers = {entry["name"]: numbers(entry) for entry in interface["buffers"]}
    has_time = "time" in {u["name"] for u in interface["uniforms"] if u["origin"] == "frame"}
    values = {"time": time} if has_time else {}
    run = gpu.run_wgsl if interface["target"].startswith("wgsl") else run_glsl
    return run(artifact, size, values, textures=textures, buffers=buffers)


def numbers(entry: dict[str, Any]) -> NDArray[Any]:
    """The elements of a buffer: (count,) or (count, components)."""
    found = np.frombuffer(base64.b64decode(entry["data"]), FORMATS[entry["format"]])
    (count,), components = entry["size"], entry["components"]
    return found if components == 1 else found.reshape(count, components)


def texels(entry: dict[str, Any]) -> NDArray[np.float32]:
    """The texels of a texture: (height, width, 4), bottom row first; a depth before them."""
    found = np.frombuffer(base64.b64decode(entry["data"]), FORMATS[entry["format"]])
    shape = (*reversed(entry["size"]), entry["components"])
    if entry["type"] == "TextureCube":
        shape = (6, *shape)
    values = found.reshape(shape).astype(np.float32)
    values = values / 255.0 if entry["format"] == "rgba8" else values
    if entry["components"] == 1:
        values = np.repeat(values, 3, axis=-1)
    whole = np.ones((*values.shape[:-1], 4), np.float32)
    whole[..., : values.shape[-1]] = values
    return whole


def pictures(path: Path) -> dict[str, NDArray[np.uint8]]:
    """The pictures that the comment of a text names, (height, width, 4), bottom row first."""
    files = dict(CHANNEL.findall(path.read_text("utf-8")))
    opened = {name: Image.open(path.with_name(file)) for name, file in files.items()}
    return {
        name: np.ascontiguousarray(np.asarray(picture.convert("RGBA"))[::-1])
        for name, picture in opened.items()
    }
