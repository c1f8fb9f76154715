"""Author's names made safe: kept where they can be, unique always."""

from __future__ import annotations

import pytest

from distal.backends.keywords import GLSL_FUNCTIONS, GLSL_KEYWORDS, WGSL_KEYWORDS, WGSL_PREDECLARED
from distal.backends.names import Namer, safe_name

GLSL = GLSL_KEYWORDS | GLSL_FUNCTIONS
WGSL = WGSL_KEYWORDS | WGSL_PREDECLARED


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
        for word in sorted(reserved):
            name = safe_name(word, reserved)
            assert name.isidentifier() and name.isascii()
            assert name not in reserved and "__" not in name


def test_namer_never_repeats() -> None:
    namer = Namer(frozenset({"mix"}), frozenset({"d"}))
    assert [namer.name(n) for n in ("d", "d", "mix", "mix", "mix_", "d_2")] == [
        *("d_2", "d_3", "mix_", "mix_2", "mix_3", "d_2_2"),
    ]


def test_languages_keep_different_words() -> None:
    assert safe_name("fn", GLSL) == "fn"
    assert safe_name("fn", WGSL) == "fn_"
    assert safe_name("half", WGSL) == "half"
    assert safe_name("half", GLSL) == "half_"
