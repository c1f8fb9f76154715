"""ISF, the Interactive Shader Format of video tools: a shader after a comment that describes it.

Input: a module after the passes for the target. Output: the comment's JSON with an input for each
parameter, the text of each parameter in the shader, and the functions that read imported pictures.
The host declares everything that the JSON names (https://docs.isf.video, "ISF JSON Reference" and
"Automatically Generated Variables"). ISF has no inputs with three coordinates and no inputs without
a range: such a point becomes three numbers, with a range around its default.
"""

# ruff: noqa: D102  (documented where they are declared)
from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any, Final

from distal.backends.clike.code import Code
from distal.backends.clike.keywords import isf_picture_names
from distal.backends.clike.module_names import ModuleNames
from distal.backends.clike.names import Namer, Reserved
from distal.backends.glsl.targets import ISF_MOUSE
from distal.backends.glsl.writer import Glsl100Writer
from distal.diagnostics import readable
from distal.ir.nodes import Module, Origin, Resource, ResourceDeclaration, UniformDeclaration
from distal.version import __version__

MOST_LISTED: Final = 64  # the longest menu of whole numbers; more values get no menu
_AXES: Final = "xyz"


@dataclass(frozen=True, slots=True)
class IsfHeader:
    """The comment before the shader.

    Attributes:
        lines: The comment with the JSON.
        texts: Parameter -> its text in the shader.
        resources: Texture -> its name in the JSON.
        names: The names that the host declares.
    """

    lines: tuple[str, ...]
    texts: dict[str, str]
    resources: dict[str, str]
    names: frozenset[str]

    @classmethod
    def of(cls, module: Module, reserved: Reserved) -> IsfHeader:
        """Return the header of a module, whose textures are pictures in files."""
        namer = Namer(reserved)
        inputs: list[dict[str, Any]] = []
        texts: dict[str, str] = {}
        for uniform in module.uniforms:
            if uniform.origin is Origin.PARAMETER:
                parts = tuple(map(namer.name, _names(uniform)))
                texts[uniform.name] = _text(parts, uniform)
                inputs += _inputs(parts, uniform)
            elif uniform.origin is Origin.FRAME and uniform.name == "mouse":
                inputs.append(_point(ISF_MOUSE, "Mouse", (0.0, 0.0), (0.0, 1.0)))
        span = module.function(module.entry).span
        file = readable(PurePath(span.file).name) if span is not None else ""
        described: dict[str, Any] = {
            "DESCRIPTION": f"The picture of {file or 'a scene'}, written by distal {__version__}",
            "CREDIT": file,
            "ISFVSN": "2",
            "CATEGORIES": ["Generator"],
            "INPUTS": inputs,
        }
        resources = {r.name: namer.name(r.name) for r in module.resources}
        if resources:
            paths = {name: {"PATH": f"{name}.png"} for name in resources.values()}
            described["IMPORTED"] = paths
        names = frozenset(i["NAME"] for i in inputs).union(
            resources.values(), *map(isf_picture_names, resources.values())
        )
        return cls(_comment(described), texts, resources, names)


def _comment(described: dict[str, Any]) -> tuple[str, ...]:
    """Return the JSON as a comment, with one input per line."""
    lines = ["/*{"]
    for key, value in described.items():
        comma = "," if key != next(reversed(described)) else ""
        if key == "INPUTS" and value:
            rows = [f"        {json.dumps(row)}," for row in value]
            lines += [f'    "{key}": [', *rows[:-1], rows[-1].rstrip(","), f"    ]{comma}"]
        else:
            lines.append(f'    "{key}": {json.dumps(value)}{comma}')
    # "*/" in a label would end the comment; JSON allows an escaped slash.
    return (*(line.replace("*/", "*\\/") for line in lines), "}*/", "")


def _names(uniform: UniformDeclaration) -> tuple[str, ...]:
    """Return the preferred names of a parameter's inputs; only a 3D point has more than one."""
    is_place = dict(uniform.interface)["kind"] == "point" and len(uniform.default) == 3
    return tuple(f"{uniform.name}_{axis}" for axis in _AXES) if is_place else (uniform.name,)


def _text(names: tuple[str, ...], uniform: UniformDeclaration) -> str:
    if dict(uniform.interface)["kind"] == "color":
        return f"{names[0]}.rgb"
    return names[0] if len(names) == 1 else f"vec3({', '.join(names)})"


def _inputs(names: tuple[str, ...], uniform: UniformDeclaration) -> Iterable[dict[str, Any]]:
    """Yield the inputs of a parameter."""
    about = dict(uniform.interface)
    name, label, default = names[0], str(about["label"]), uniform.default
    named = {"NAME": name, "LABEL": label}
    match about["kind"]:
        case "slider":
            yield named | {"TYPE": "float", "DEFAULT": default} | _range(about)
        case "integer":
            numbers = list(range(about["low"], about["high"] + 1, about["step"]))
            listed = {"VALUES": numbers, "LABELS": [str(n) for n in numbers]}
            yield (
                named
                | {"TYPE": "long", "DEFAULT": default}
                | _range(about)
                | (listed if len(numbers) <= MOST_LISTED else {})
            )
        case "toggle":
            yield named | {"TYPE": "bool", "DEFAULT": default}
        case "choice":
            options = [str(option) for option in about["options"]]
            listed = {"VALUES": list(range(len(options))), "LABELS": options}
            yield named | {"TYPE": "long", "DEFAULT": default} | listed
        case "color":
            # The host passes its picker's values unchanged, and the scene reads linear light.
            labelled = {"NAME": name, "LABEL": f"{label} (linear)"}
            yield labelled | {"TYPE": "color", "DEFAULT": [*default, 1.0]}
        case "point" if len(default) == 2:
            yield _point(name, label, default, _reach(default))
        case "point":
            low, high = _reach(default)
            for part, axis, value in zip(names, _AXES, default, strict=True):
                yield {
                    "NAME": part,
                    "LABEL": f"{label} {axis}",
                    "TYPE": "float",
                    "DEFAULT": value,
                    "MIN": low,
                    "MAX": high,
                }
        case kind:
            raise AssertionError(f"no parameter is of kind {kind}")


def _range(about: dict[str, Any]) -> dict[str, Any]:
    return {"MIN": about["low"], "MAX": about["high"]}


def _reach(default: tuple[float, ...]) -> tuple[float, float]:
    """Return a range around the origin, twice as large as the point's largest coordinate."""
    reach = max(1.0, 2.0 * max(map(abs, default)))
    return -reach, reach


def _point(
    name: str, label: str, default: tuple[float, ...], span: tuple[float, float]
) -> dict[str, Any]:
    low, high = span
    return {
        "NAME": name,
        "LABEL": label,
        "TYPE": "point2D",
        "DEFAULT": list(default),
        "MIN": [low, low],
        "MAX": [high, high],
    }


def imported(name: str, file: str) -> str:
    """Return the entry of a picture in the JSON: its name in the shader, and its file beside it."""
    return json.dumps({name: {"PATH": file}})[1:-1]


class IsfWriter(Glsl100Writer):
    """Writes GLSL ES 1.00 in which functions of the host read pictures."""

    def sample(self, resource: Resource, coord: Code) -> Code:
        return self.call(self.names.accessors[resource.name], [coord])


def sampler_lines(resource: ResourceDeclaration, names: ModuleNames) -> list[str]:
    """Return the function that samples a picture.

    Hosts replace IMG_NORM_PIXEL textually up to the next closing bracket, so its second argument
    must be a plain name. Values outside a picture are undefined, so the coordinate is wrapped.
    """
    name, function = names.resources[resource.name], names.accessors[resource.name]
    coord, inside = map(names.local_namer().name, ("coord", "inside"))
    repeats = resource.wrap == "repeat"
    value = f"fract({coord})" if repeats else f"clamp({coord}, 0.0, 1.0)"
    return [
        f"vec4 {function}(vec2 {coord}) {{",
        f"    vec2 {inside} = {value};",
        f"    return IMG_NORM_PIXEL({name}, {inside});",
        "}",
    ]
