"""Write textures and buffers in WGSL: bindings, and functions that read single elements.

Input: a resource's declaration, and its number. Output: lines of WGSL.
"""

from __future__ import annotations

from collections.abc import Iterable

from distal.backends.clike.module_names import ModuleNames
from distal.ir.nodes import Expr, Index, Resource, ResourceDeclaration, Texel
from distal.ir.types import Buffer, Kind, Scalar, Texture, TextureShape, Type, kind_of

_TEXTURES = {
    TextureShape.FLAT: "texture_2d<f32>",
    TextureShape.CUBE: "texture_cube<f32>",
    TextureShape.VOLUME: "texture_3d<f32>",
}
_SCALARS = {Kind.FLOAT: "f32", Kind.INT: "i32", Kind.UINT: "u32", Kind.BOOL: "bool"}
_SHARED = {**_SCALARS, Kind.BOOL: "u32"}
_LETTERS = {Kind.FLOAT: "f", Kind.INT: "i", Kind.UINT: "u"}


def texture_binding(number: int) -> int:
    """Return the binding of a texture or buffer; a texture's sampler has the next binding."""
    return 2 * number


def fetched_resources(nodes: Iterable[Expr]) -> set[str]:
    """Return the names of the resources whose single texels or elements are read."""
    found = set()
    for e in nodes:
        if isinstance(e, Texel) and isinstance(e.texture, Resource):
            found.add(e.texture.name)
        elif isinstance(e, Index) and isinstance(e.base, Resource):
            found.add(e.base.name)
    return found


def _element_name(type: Type, *, shared: bool) -> str:
    kind = kind_of(type)
    assert kind is not None
    if isinstance(type, Scalar):
        return (_SHARED if shared else _SCALARS)[kind]
    return f"{str(type).lstrip('iu')}{_LETTERS[kind]}"


def binding_lines(resource: ResourceDeclaration, names: ModuleNames, number: int) -> list[str]:
    """Return the declarations of a resource.

    Args:
        resource: The resource.
        names: The names in the text.
        number: The resource's number in the module.
    """
    name = names.resources[resource.name]
    here = f"@group(1) @binding({texture_binding(number)})"
    if isinstance(resource.type, Buffer):
        element = _element_name(resource.type.element, shared=True)
        return [f"{here} var<storage, read> {name}: array<{element}>;"]
    assert isinstance(resource.type, Texture)
    beside = f"@group(1) @binding({texture_binding(number) + 1})"
    return [
        f"{here} var {name}: {_TEXTURES[resource.type.shape]};",
        f"{beside} var {names.samplers[resource.name]}: sampler;",
    ]


def accessor_lines(resource: ResourceDeclaration, names: ModuleNames) -> list[str]:
    """Return the function that reads one texel or element; it clamps the index."""
    name, function = names.resources[resource.name], names.accessors[resource.name]
    local = names.local_namer().name
    index = local("index")
    if isinstance(resource.type, Buffer):
        element = _element_name(resource.type.element, shared=False)
        read = f"{name}[max(min({index}, i32(arrayLength(&{name})) - 1), 0)]"
        read = f"{read} != 0u" if element == "bool" else read
        return [f"fn {function}({index}: i32) -> {element} {{", f"    return {read};", "}"]
    assert isinstance(resource.type, Texture)
    if resource.type.shape is TextureShape.CUBE:
        return _cube_accessor(resource, names)
    rank = "vec2i" if resource.type.shape is TextureShape.FLAT else "vec3i"
    last = local("last")
    return [
        f"fn {function}({index}: {rank}) -> vec4f {{",
        f"    let {last} = {rank}(textureDimensions({name})) - 1;",
        f"    return textureLoad({name}, clamp({index}, {rank}(0), {last}), 0);",
        "}",
    ]


def _cube_accessor(resource: ResourceDeclaration, names: ModuleNames) -> list[str]:
    """Return the function that reads a cube's texel by sampling at its centre.

    WGSL has no ``textureLoad`` for cubes. The directions of the faces are the same as in OpenGL and
    Vulkan.
    """
    name, function = names.resources[resource.name], names.accessors[resource.name]
    sampler = names.samplers[resource.name]
    local = names.local_namer().name
    index, size, at, s, direction = map(local, ("index", "size", "at", "s", "direction"))
    faces = (
        (f"{index}.z <= 0", f"1.0, -{s}.y, -{s}.x"),
        (f"{index}.z == 1", f"-1.0, -{s}.y, {s}.x"),
        (f"{index}.z == 2", f"{s}.x, 1.0, {s}.y"),
        (f"{index}.z == 3", f"{s}.x, -1.0, -{s}.y"),
        (f"{index}.z == 4", f"{s}.x, -{s}.y, 1.0"),
    )
    chain = []
    for i, (test, axis) in enumerate(faces):
        chain.append(f"    {'} else if' if i else 'if'} ({test}) {{")
        chain.append(f"        {direction} = vec3f({axis});")
    return [
        f"fn {function}({index}: vec3i) -> vec4f {{",
        f"    let {size} = i32(textureDimensions({name}).x);",
        f"    let {at} = vec2f(clamp({index}.xy, vec2i(0), vec2i({size} - 1)));",
        f"    let {s} = (2.0 * {at} + 1.0) / f32({size}) - 1.0;",
        f"    var {direction} = vec3f(-{s}.x, -{s}.y, -1.0);",
        *chain,
        "    }",
        f"    return textureSampleLevel({name}, {sampler}, {direction}, 0.0);",
        "}",
    ]
