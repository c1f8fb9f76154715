"""Write textures and buffers in GLSL: samplers, and functions that read single elements.

Input: a resource's declaration. Output: lines of GLSL. A buffer is a texture with one texel per
element, row by row, whose width the host chooses, and a uniform with the count: WebGL 2 has no
storage buffers.
"""

from __future__ import annotations

from distal.backends.clike.module_names import ModuleNames
from distal.backends.clike.module_text import comment_text
from distal.backends.glsl.targets import GlslTarget
from distal.ir.nodes import ResourceDeclaration
from distal.ir.types import Buffer, Kind, Texture, TextureShape, component_count, kind_of

_SAMPLERS = {
    TextureShape.FLAT: "sampler2D",
    TextureShape.CUBE: "samplerCube",
    TextureShape.VOLUME: "sampler3D",
}
_BUFFER_SAMPLERS = {
    Kind.FLOAT: "highp sampler2D",
    Kind.INT: "highp isampler2D",
    Kind.UINT: "highp usampler2D",
    Kind.BOOL: "highp isampler2D",
}


def resource_lines(
    resource: ResourceDeclaration, names: ModuleNames, target: GlslTarget
) -> list[str]:
    """Return the declaration of a resource.

    Args:
        resource: The resource.
        names: The names in the text.
        target: The target.
    """
    name = names.resources[resource.name]
    if isinstance(resource.type, Texture):
        if not target.declares_textures:
            return [f"// {name}: {comment_text(resource.name)} ({resource.type}, {resource.wrap})"]
        return [f"uniform {target.sampler_precision}{_SAMPLERS[resource.type.shape]} {name};"]
    assert isinstance(resource.type, Buffer)
    kind = kind_of(resource.type.element)
    assert kind is not None
    return [
        f"uniform {_BUFFER_SAMPLERS[kind]} {name};",
        f"uniform int {names.counts[resource.name]};",
    ]


def accessor_lines(resource: ResourceDeclaration, names: ModuleNames) -> list[str]:
    """Return the function that reads one texel or element; it clamps the index."""
    name, function = names.resources[resource.name], names.accessors[resource.name]
    local = names.local_namer().name
    index = local("index")
    if isinstance(resource.type, Buffer):
        at, width = map(local, ("at", "width"))
        element = resource.type.element
        lanes = "" if component_count(element) == 4 else "." + "xyzw"[: component_count(element)]
        count = names.counts[resource.name]
        texel = f"texelFetch({name}, ivec2({at} % {width}, {at} / {width}), 0){lanes}"
        return [
            f"{element} {function}(int {index}) {{",
            f"    int {at} = max(min({index}, {count} - 1), 0);",
            f"    int {width} = textureSize({name}, 0).x;",
            f"    return {texel if kind_of(element) is not Kind.BOOL else f'{element}({texel})'};",
            "}",
        ]
    assert isinstance(resource.type, Texture)
    if resource.type.shape is TextureShape.CUBE:
        return _cube_accessor(resource, names)
    rank = "ivec2" if resource.type.shape is TextureShape.FLAT else "ivec3"
    inside = f"clamp({index}, {rank}(0), textureSize({name}, 0) - 1)"
    return [
        f"vec4 {function}({rank} {index}) {{",
        f"    return texelFetch({name}, {inside}, 0);",
        "}",
    ]


def _cube_accessor(resource: ResourceDeclaration, names: ModuleNames) -> list[str]:
    """Return the function that reads a cube's texel by sampling at its centre.

    GLSL has no ``texelFetch`` for cubes. Directions of the faces: OpenGL ES 3.0.6, table 3.21.
    """
    name, function = names.resources[resource.name], names.accessors[resource.name]
    local = names.local_namer().name
    index, size, at, s, direction = map(local, ("index", "size", "at", "s", "direction"))
    return [
        f"vec4 {function}(ivec3 {index}) {{",
        f"    int {size} = textureSize({name}, 0).x;",
        f"    vec2 {at} = vec2(clamp({index}.xy, 0, {size} - 1));",
        f"    vec2 {s} = (2.0 * {at} + 1.0) / float({size}) - 1.0;",
        f"    vec3 {direction} = vec3(-{s}.x, -{s}.y, -1.0);",
        f"    if ({index}.z <= 0) {{",
        f"        {direction} = vec3(1.0, -{s}.y, -{s}.x);",
        f"    }} else if ({index}.z == 1) {{",
        f"        {direction} = vec3(-1.0, -{s}.y, {s}.x);",
        f"    }} else if ({index}.z == 2) {{",
        f"        {direction} = vec3({s}.x, 1.0, {s}.y);",
        f"    }} else if ({index}.z == 3) {{",
        f"        {direction} = vec3({s}.x, -1.0, -{s}.y);",
        f"    }} else if ({index}.z == 4) {{",
        f"        {direction} = vec3({s}.x, -{s}.y, 1.0);",
        "    }",
        f"    return textureLod({name}, {direction}, 0.0);",
        "}",
    ]
