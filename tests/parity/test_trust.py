"""A host may have the driver's own sine and the like in a page's text, one by one.

The text is valid and means the same with each macro and without; what the driver makes of its own
functions is its affair: Mesa's arc sine is off by 4e-4.
"""

from __future__ import annotations

import numpy as np
import pytest

from distal.backends import get_target
from distal.backends.numpy import interpreter as reference
from distal.compiler.driver import compile, lower, run_passes
from distal.devices.driver_errors import MOST
from distal.lang import (
    Frame,
    acos,
    asin,
    cos,
    func,
    gradient,
    image,
    select,
    sin,
    struct,
    tan,
    vec2,
    vec3,
    vec4,
)
from tests.egl import EglUnavailableError, renderer
from tests.glsl import run_glsl
from tests.parity.trusting import trusting

NAMES = ("sin", "cos", "asin", "acos")
MACROS = {name: f"TRUST_{name.upper()}" for name in NAMES}
SIZE = (64, 24)


@struct
class Named:
    """By names that are macros of the text."""

    TRUST_SIN: float
    TRUST_TAN: float


@func
def sine(x: float) -> float:
    """An author's own, by the name that the careful one would have."""
    return 2.0 * sin(x)


@func
def field(p: vec2) -> float:
    return sin(p.x * 3.0) * cos(p.y) + tan(0.4 * p.x) + asin(0.5 * p.y) * acos(0.5 * p.x)


@image
def everything(frame: Frame) -> vec4:
    p = (2.0 * frame.coord - frame.resolution) / frame.resolution.y
    slope = gradient(field, 0.3 * p)
    turned = sin(vec3(p, 90.0 + p.x)) + cos(p).xyx
    bent = tan(0.4 * p) + asin(0.3 * p) + acos(vec2(p.x * 0.3, p.y * 0.9))
    value = select(p.x > 0.0, sine(p.y), field(p * 0.5))
    TRUST_COS = Named(TRUST_SIN=turned.x + turned.z, TRUST_TAN=turned.y + value)  # noqa: N806 (what is tried)
    return vec4(slope + bent, TRUST_COS.TRUST_SIN, TRUST_COS.TRUST_TAN)


@image
def moving(frame: Frame) -> vec3:
    return vec3(sin(frame.time), tan(frame.time), frame.coord.x)


@func
def wave(x: float) -> float:
    return sin(x)


@pytest.fixture(scope="module")
def program():
    return compile(everything, "glsl-es300")


@pytest.fixture(scope="module")
def wanted():
    module = run_passes(lower(everything), get_target("numpy"))
    return reference.render(module, *SIZE, {"resolution": SIZE}, {})


def picture(artifact):
    try:
        return run_glsl(artifact, SIZE, {})
    except EglUnavailableError as error:
        pytest.skip(str(error))


@pytest.mark.parametrize(
    "names", [(), *((name,) for name in NAMES), ("sin", "cos"), NAMES], ids="-".join
)
def test_the_text_means_the_same_with_each_macro_and_without(program, wanted, names):
    found = picture(trusting(program, names))
    off = np.max(np.abs(found - wanted))
    if names and "llvmpipe" not in renderer():  # hardware: what a page allows its own functions
        assert off < MOST
        return
    rough = {"asin", "acos"} & set(names)  # what Mesa's own are off by, here times up to 4
    assert off < (2e-3 if rough else 5e-6)
    if rough:  # else the macro changes nothing
        assert off > 2e-5


def test_the_interface_tells_the_macros_of_the_fragment_text(program):
    assert program.interface["trust"] == MACROS
    assert all(f"#ifdef {macro}\n" in program.text for macro in MACROS.values())
    assert "#if" not in program.vertex
    per_frame = compile(moving, "glsl-es300")
    assert per_frame.interface["trust"] == {} and "TRUST" not in per_frame.text
    assert "float sine(" in per_frame.vertex  # careful, whatever the driver
    assert compile(wave, "glsl-es300").interface["trust"] == {"sin": "TRUST_SIN"}


def test_every_line_of_the_text_has_its_place(program):
    rows = program.text.splitlines()
    assert len(program.lines) == len(rows)
    inside = False
    for row, place in zip(rows, program.lines, strict=True):
        inside = (inside or row.startswith("#ifdef TRUST")) and not row.startswith("#endif")
        if inside or row.startswith("#endif"):
            assert place is not None and "prelude" in place[0], row


@pytest.mark.parametrize("target", ["glsl-330", "shadertoy", "wgsl"])
def test_other_targets_have_the_drivers_functions(target):
    artifact = compile(everything, target)
    assert "#ifdef TRUST" not in artifact.text and "trust" not in artifact.interface
