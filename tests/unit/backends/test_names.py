"""Author's names made safe: kept where they can be, unique always."""

from __future__ import annotations

import pytest

from distal.backends.clike.functions import place
from distal.backends.clike.keywords import (
    GLSL_FUNCTIONS,
    GLSL_KEYWORDS,
    GLSL_PREFIXES,
    ISF_PARTS,
    WGSL_KEYWORDS,
    WGSL_PREDECLARED,
)
from distal.backends.clike.names import Namer, Reserved, safe_name
from distal.diagnostics import Span

GLSL = Reserved(GLSL_KEYWORDS | GLSL_FUNCTIONS, GLSL_PREFIXES)
ISF = Reserved(GLSL.words, GLSL_PREFIXES, ISF_PARTS)
WGSL = Reserved(WGSL_KEYWORDS | WGSL_PREDECLARED)


@pytest.mark.parametrize(
    ("name", "safe"),
    [
        ("smooth_union", "smooth_union"),
        ("filter", "filter_"),
        ("texture", "texture_"),
        ("main", "main_"),
        ("a__b", "a_b"),
        ("__wrapped__", "_wrapped_"),
        ("_", "unused"),
        ("gl_depth", "own_gl_depth"),
        ("gl__depth", "own_gl_depth"),
        ("GL_ES", "own_GL_ES"),
        ("webgl_x", "own_webgl_x"),
        ("_webgl_x", "own_webgl_x"),
        ("_gl_x", "_gl_x"),
        ("größer", "groudfer"),
        ("α", "alpha"),  # noqa: RUF001
        ("Δt", "deltat"),
        ("变", "u53d8"),
    ],
)
def test_safe(name: str, safe: str) -> None:
    assert safe_name(name, GLSL) == safe


def test_every_safe_name_is_an_identifier() -> None:
    for reserved in (GLSL, WGSL):
        for word in sorted(reserved.words):
            name = safe_name(word, reserved)
            assert name.isidentifier() and name.isascii()
            assert name not in reserved and "__" not in name


def test_namer_never_repeats() -> None:
    namer = Namer(Reserved(frozenset({"mix"})), {"d"})
    assert [namer.name(n) for n in ("d", "d", "mix", "mix", "mix_", "d_2")] == [
        *("d_2", "d_3", "mix_", "mix_2", "mix_3", "d_2_2"),
    ]


@pytest.mark.parametrize("word", ["gl", "GL", "webgl", "_webgl"])
def test_a_number_makes_no_reserved_name(word: str) -> None:
    namer = Namer(GLSL)
    names = [namer.name(word) for _ in range(3)]
    assert len(set(names)) == 3
    assert not any(name in GLSL for name in names)


def test_a_part_that_a_host_replaces_stands_in_no_name() -> None:
    assert safe_name("IMG_SIZE", ISF) == "IMGSIZE"
    assert safe_name("my_IMG_NORM_PIXELS", ISF) == "my_IMGNORMPIXELS"
    assert safe_name("IMG_SIZE", GLSL) == "IMG_SIZE"


def test_long_names_are_cut_and_stay_different() -> None:
    namer = Namer(GLSL)
    names = [namer.name(f"{'x' * 1000}{i}") for i in range(3)]
    assert len(set(names)) == 3
    assert all(len(name) <= 256 for name in names)  # what WebGL 1 takes


def test_languages_keep_different_words() -> None:
    assert safe_name("fn", GLSL) == "fn"
    assert safe_name("fn", WGSL) == "fn_"
    assert safe_name("half", WGSL) == "half"
    assert safe_name("half", GLSL) == "half_"


def test_a_files_name_stands_in_comments_as_every_compiler_takes_it() -> None:
    assert place(Span("/scenes/größe.py", 3, 0, 1, "")) == "groe.py:3"
