"""Declare the GLSL targets: WebGL 2, desktop 3.30, WebGL 1, and three hosts.

Imports no writer, because the declarations are read whenever ``distal`` starts.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import ClassVar, Final, TypeAlias

from distal.backends.clike.keywords import (
    GLSL_CANVAS_MACROS,
    GLSL_CANVAS_NAMES,
    ISF_NAMES,
    ISF_PARTS,
    ISF_PREFIXES,
    SHADERTOY_MACROS,
    SHADERTOY_NAMES,
)
from distal.backends.targets import Declares, TextTarget
from distal.ir.intrinsics import INTRINSICS
from distal.ir.nodes import ResourceDeclaration
from distal.ir.target import LARGEST_TABLE, FramePlace
from distal.ir.types import TextureShape

ISF_MOUSE: Final = "mouse"
SHADERTOY_CHANNELS: Final = 4

Resources: TypeAlias = tuple[ResourceDeclaration, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class GlslTarget(TextTarget):
    """One version of GLSL for one host.

    Attributes:
        version: The version of the language, without "#version".
        head: The first lines of the text.
        output: The variable to which the entry function assigns the color.
        coord: The text of the pixel's coordinate.
        main: The first line of the entry function.
        frame_uniforms: Who declares the frame's values: time, resolution ...
        numbers: Who declares a scene's numbers.
        initialised: Whether a uniform's declaration may give its default.
        texts: The texts of the frame's values that the host provides under other names.
        host_names: Names that the host declares before the text.
        host_macros: Words that the host replaces.
        host_prefixes: No name may begin with these.
        host_parts: Texts that the host replaces even inside longer names.
        resource_names: Returns the host's names for textures; None: the author's names.
        declares_textures: Whether the text declares its textures.
        sampler_precision: The precision qualifier of a sampler's type.
        described: Whether the text begins with ISF's description of its inputs as JSON, and
            reads pictures with ISF's functions (``glsl.isf``).
    """

    backend: ClassVar[str] = "distal.backends.glsl.backend"
    version: str
    head: tuple[str, ...]
    output: str
    coord: str = "gl_FragCoord.xy"
    main: str = "void main()"
    frame_uniforms: Declares = Declares.TEXT
    numbers: Declares = Declares.TEXT
    initialised: bool = False
    texts: Mapping[str, str] = field(default_factory=dict)
    host_names: frozenset[str] = frozenset()
    host_macros: frozenset[str] = frozenset()
    host_prefixes: tuple[str, ...] = ()
    host_parts: tuple[str, ...] = ()
    resource_names: Callable[[Resources], dict[str, str]] | None = None
    declares_textures: bool = True
    sampler_precision: str = ""
    described: bool = False

    @property
    def entry(self) -> str:
        """The name of the entry function."""
        return self.main.partition("(")[0].removeprefix("void ")

    @property
    def written_names(self) -> frozenset[str]:
        """The names that its texts contain; the author's names must be different."""
        several = (target_name(i) for i in range(self.targets) if self.targets > 1)
        texts = " ".join((self.output, *several, self.coord, self.main, *self.texts.values()))
        return frozenset(re.findall(r"(?<![.\w])[A-Za-z_]\w*", texts))


def target_name(number: int) -> str:
    """Return the variable of one of several pictures that are drawn at once."""
    return f"fragment_target_{number}"


def shadertoy_channels(resources: Resources) -> dict[str, str]:
    """Return the Shadertoy channel of each resource."""
    return {resource.name: f"iChannel{i}" for i, resource in enumerate(resources)}


def canvas_textures(resources: Resources) -> dict[str, str]:
    """Return glslCanvas's name for each resource: the textures of ``data-textures``, in order."""
    return {resource.name: f"u_tex{i}" for i, resource in enumerate(resources)}


_FLAT: Final = frozenset({TextureShape.FLAT})
_PRECISION = ("precision highp float;", "precision highp int;")
_VERTEX_BESIDE = (
    "The fragment stage; the file .vert beside it is its vertex stage. Draw 3 vertices as "
    "triangles, without buffers."
)

_SHADERTOY = GlslTarget(
    "shadertoy",
    "glsl",
    FramePlace.PIXEL,
    place="Shadertoy",
    use="Paste all of this into the Image tab of a new shader on shadertoy.com.",
    suffix=".glsl",
    version="300 es",
    head=(),
    output="fragColor",
    coord="fragCoord",
    main="void mainImage(out vec4 fragColor, in vec2 fragCoord)",
    frame_uniforms=Declares.PLACE,
    parameters=Declares.NOBODY,
    numbers=Declares.NOBODY,
    texts={
        "resolution": "iResolution.xy",
        "time": "iTime",
        "mouse": "iMouse",
        "index": "iFrame",
        "delta": "iTimeDelta",
        "date": "iDate",
        "buttons": "(iMouse.z > 0.0 ? 1 : 0)",
    },
    host_names=SHADERTOY_NAMES,
    host_macros=SHADERTOY_MACROS,
    resource_names=shadertoy_channels,
    textures_by="the channels of the tab",
    most_textures=SHADERTOY_CHANNELS,
    live=True,
    declares_textures=False,
    buffers=False,
)

_WEBGL_1 = GlslTarget(
    "glsl-es100",
    "glsl100",
    FramePlace.PIXEL,
    unsigned=False,
    dynamic_loops=False,
    dynamic_index=False,
    texel_fetch=False,
    buffers=False,
    textures=frozenset({TextureShape.FLAT, TextureShape.CUBE}),
    place="WebGL 1",
    use="The fragment stage; draw anything that covers the picture. Set every uniform.",
    version="100",
    head=("#ifdef GL_ES", *_PRECISION, "#endif"),
    output="gl_FragColor",
    texts={
        "resolution": "u_resolution",
        "time": "u_time",
        # The host provides the mouse's position, but not its buttons.
        "mouse": "vec4(u_mouse, 0.0, 0.0)",
        "index": "u_frame",
        "delta": "u_delta",
        "date": "u_date",
        "buttons": "u_buttons",
    },
    host_names=GLSL_CANVAS_NAMES,
)

_GLSL_CANVAS = replace(
    _WEBGL_1,
    name="glslcanvas",
    place="glslCanvas",
    use="Paste all of this into editor.thebookofshaders.com, or give the file to a canvas of class "
    '"glslCanvas" as data-fragment-url.',
    parameters=Declares.NOBODY,
    numbers=Declares.NOBODY,
    textures=_FLAT,
    textures_by="data-textures",
    host_macros=GLSL_CANVAS_MACROS,
    resource_names=canvas_textures,
)

_ISF = replace(
    _WEBGL_1,
    name="isf",
    place="ISF 2, the Interactive Shader Format",
    use="Put this file into your host's folder for ISF generators; its controls appear there.",
    suffix=".fs",
    # Not gl_FragCoord, because a host may draw into a part of its target.
    coord="isf_FragNormCoord * RENDERSIZE",
    frame_uniforms=Declares.PLACE,
    parameters=Declares.PLACE,
    numbers=Declares.NOBODY,
    texts={
        "resolution": "RENDERSIZE",
        "time": "TIME",
        # The host has no mouse: an additional input is its position, as a fraction of the picture.
        "mouse": f"vec4({ISF_MOUSE} * RENDERSIZE, 0.0, 0.0)",
        "index": "FRAMEINDEX",
        "delta": "TIMEDELTA",
        "date": "DATE",
        "buttons": "0",
    },
    host_names=ISF_NAMES,
    host_prefixes=ISF_PREFIXES,
    host_parts=ISF_PARTS,
    textures=_FLAT,
    textures_by="IMPORTED",
    declares_textures=False,
    described=True,
)

_WEBGL_2 = GlslTarget(
    "glsl-es300",
    "glsl",
    FramePlace.VERTEX,
    rough=frozenset(i.name for i in INTRINSICS.values() if i.careful),
    one_way=True,
    largest_table=LARGEST_TABLE,
    place="WebGL 2",
    use=_VERTEX_BESIDE,
    suffix=".frag",
    version="300 es",
    head=("#version 300 es", *_PRECISION),
    output="fragment_color",
    targets=4,  # as many as each driver has
    sampler_precision="highp ",
)

_OPENGL = GlslTarget(
    "glsl-330",
    "glsl",
    FramePlace.VERTEX,
    largest_table=LARGEST_TABLE,
    place="OpenGL 3.3",
    use=_VERTEX_BESIDE,
    version="330",
    head=("#version 330",),
    output="fragment_color",
    initialised=True,
)

TARGETS: Final = (_SHADERTOY, _GLSL_CANVAS, _ISF, _WEBGL_2, _OPENGL, _WEBGL_1)
