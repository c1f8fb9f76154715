"""Scene code whose names are all given: each word as a struct, field, function, parameter, local.

In: a rule that gives the name of each thing. Out: the module, lowered from Python source. Called
with one word for everything of one number, a module is hostile: it has that word in each of its
scopes. Called with another name for everything, it is plain. The two have the same structure.
"""

from __future__ import annotations

import keyword
import linecache
import re
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, Final

from distal.backends import emit, get_target
from distal.backends.base import Artifact
from distal.compiler.driver import run_passes
from distal.frontend import lower
from distal.ir.nodes import Module

Name = Callable[[str, int], str]  # role and number -> name

THINGS: Final = 24  # structs, functions ... in one program
SLIDERS: Final = 12  # of one program: WebGL 2 has room for 200, and each costs a line
PLAIN: Final = "zq"  # begins every name of a plain program
# Targets whose passes are the same: the module is shaped once for all of them.
FAMILIES: Final = (
    ("glsl-es300",),
    ("glsl-330",),
    ("shadertoy",),
    ("glsl-es100", "glslcanvas", "isf"),
    ("wgsl", "wgsl-compute"),
)
BUFFERS: Final = frozenset({"glsl-es300", "glsl-330", "wgsl", "wgsl-compute"})
TEXTURES: Final = 4  # Shadertoy has no more


def plain(role: str, number: int) -> str:
    """The name of a thing in a plain program."""
    return f"{PLAIN}_{role}_{number}"


def hostile(words: Sequence[str]) -> Name:
    """One word for all things of a number; sliders, which have small letters, take what is left."""
    labels = [word for word in words if re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", word)]

    def name(role: str, number: int) -> str:
        if role != "slider":
            return words[number % len(words)]
        return labels[number] if number < len(labels) else plain(role, number)

    return name


_ODD: Final = frozenset({"struct", "other_field", "third_field", "other_parameter", "once", "turn"})


def in_pairs(words: Sequence[str]) -> Name:
    """Two words for all things of a number: half of the roles have the one, half the other."""
    first, second = hostile(words[::2]), hostile(words[1::2])
    return lambda role, number: (second if role in _ODD else first)(role, number)


def can_be_named(word: str) -> bool:
    """Whether Python takes it as a name."""
    return word.isidentifier() and not keyword.iskeyword(word) and not word.startswith("__")


def picture_source(name: Name, count: int, *, buffers: bool) -> str:
    """An image of ``count`` structs, functions, sliders ..., each of all kinds."""
    lines = ["import distal.lang as zq_lang", "class R:"]
    for i in range(count):
        if buffers:
            lines.append(f"    {name('buffer', i)} = zq_lang.Buffer([0.5, 0.25, 0.125])")
        elif i < TEXTURES:
            lines.append(f"    {name('texture', i)} = zq_lang.Texture2D('{i}.png')")
    for i in range(SLIDERS):
        lines.append(f"P{i} = zq_lang.slider({name('slider', i)!r}, 0.5)")
    for i in range(count):
        lines += _function(name, i, count, buffers=buffers)
    lines += ["@zq_lang.image", "def picture(f: zq_lang.Frame) -> zq_lang.vec4:", "    s = 0.0"]
    for i in range(count):
        lines.append(f"    s += F{i}(f.coord.x, T{i}(f.coord.y, 0.5, [1.0, 2.0]))")
    # Also with nothing but values of the frame: such a function stands in the per-frame part.
    lines.append("    s += F0(P0, T0(P1, P0 + P1, [1.0, 2.0]))")
    lines.append("    return zq_lang.vec4(s, s * 0.5, f.coord)")
    return "\n".join(lines) + "\n"


def _function(name: Name, i: int, count: int, *, buffers: bool) -> list[str]:
    """A struct and a function that takes it; what is imported under a word is not lost."""
    following = [(i + k) % count for k in range(1, 5)]
    first, second = name("field", i), name("other_field", following[0])
    third = name("third_field", following[1])
    x, s = name("parameter", i), name("other_parameter", following[0])
    once, value, turn = (
        name(role, n) for role, n in zip(("once", "local", "turn"), following[1:], strict=True)
    )
    if buffers:
        element = f"R.{name('buffer', i)}[{value_index(i)}]"
    else:
        texture = f"R.{name('texture', i % TEXTURES)}"
        element = f"zq_lang.sample({texture}, zq_lang.vec2({x}, 0.5)).x * 0.0"
    struct, function = name("struct", i), name("function", i)
    return [
        *("@zq_lang.struct", f"class {struct}:", f"    {first}: float", f"    {second}: float"),
        f"    {third}: zq_lang.array[float, 2]",
        *(f"T{i} = {struct}", f"del {struct}"),
        *("@zq_lang.func", f"def {function}({x}: float, {s}: T{i}) -> float:"),
        f"    {once} = zq_lang.sqrt(P{i % SLIDERS} + 0.5) + {i % 8}.5",
        f"    {value} = {x} * 0.5 + {once}",
        f"    for {turn} in range(2):",
        f"        {value} += {element} + {s}.{third}[{turn}]",
        f"    return {value} + {s}.{first} if {x} < 64.0 else {s}.{second}",
        *(f"F{i} = {function}", f"del {function}"),
    ]


def value_index(i: int) -> int:
    """Which element of its buffer a function reads."""
    return i % 3


def textures_source(name: Name, *, texels: bool) -> str:
    """An image that is itself called so, and reads single texels of each kind of texture."""
    kinds = ("Texture2D", "TextureCube", "Texture3D") if texels else ("Texture2D",)
    lines = ["import distal.lang as zq_lang", "class R:"]
    lines += [f"    {name('texture', i)} = zq_lang.{k}('a.png')" for i, k in enumerate(kinds)]
    lines += [f"P = zq_lang.slider({name('slider', 0)!r}, 0.5)", "@zq_lang.image"]
    image, frame, value = name("image", 0), name("parameter", 1), name("local", 2)
    lines += [f"def {image}({frame}: zq_lang.Frame) -> zq_lang.vec4:"]
    lines += [f"    {value} = zq_lang.vec4({frame}.coord, zq_lang.sqrt(P), {frame}.time)"]
    for i, dimensions in enumerate((2, 3, 3) if texels else ()):
        index = f"zq_lang.ivec{dimensions}({', '.join('123'[:dimensions])})"
        lines.append(f"    {value} += zq_lang.texel(R.{name('texture', i)}, {index})")
    if not texels:
        lines.append(f"    {value} += zq_lang.sample(R.{name('texture', 0)}, {frame}.coord)")
    return "\n".join([*lines, f"    return {value}", f"picture = {image}"]) + "\n"


def function_source(name: Name) -> str:
    """A ``@func`` of a struct, called for many points by what runs it."""
    struct, function = name("struct", 0), name("function", 0)
    x, s, y = name("parameter", 0), name("other_parameter", 1), name("local", 2)
    first, second = name("field", 0), name("other_field", 1)
    lines = [
        *("import distal.lang as zq_lang", "@zq_lang.struct", f"class {struct}:"),
        *(f"    {first}: float", f"    {second}: zq_lang.vec2", f"T = {struct}", f"del {struct}"),
        *("@zq_lang.func", f"def {function}({x}: float, {s}: T) -> T:"),
        *(f"    {y} = {x} + {s}.{first}", f"    return T({y}, {s}.{second} * {y})"),
        f"picture = {function}",
    ]
    return "\n".join(lines) + "\n"


def lowered(source: str) -> Module:
    """The module of a source, through the front end like a file of an author's."""
    file = "names.py"
    linecache.cache[file] = (len(source), None, source.splitlines(keepends=True), file)
    scope: dict[str, Any] = {"__name__": "names"}
    exec(compile(source, file, "exec"), scope)
    return lower(scope["picture"])


def artifacts(module: Module, family: Sequence[str]) -> dict[str, Artifact]:
    """The module's text for each target of a family."""
    shaped = run_passes(module, get_target(family[0]))
    return {name: emit(shaped, get_target(name)) for name in family}


@cache
def plain_picture(family: tuple[str, ...], count: int) -> dict[str, Artifact]:
    """The texts of a plain image."""
    source = picture_source(plain, count, buffers=family[0] in BUFFERS)
    return artifacts(lowered(source), family)
