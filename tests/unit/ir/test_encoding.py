"""Modules as bytes: equal when read again; wrong bytes are refused and run nothing."""

from __future__ import annotations

import json
import zlib

import pytest

import distal
from distal.cluster.programs import received, sent
from distal.ir.encoding import EncodingError, decoded, encoded
from distal.ir.printer import print_identity, print_module
from distal.lang import Frame, func, image, slider, vec3
from distal.lang.parameters import Parameter, ParameterKind
from distal.lang.runtime_access import executor
from distal.scene.viewing.viewable import viewable

CLASSES = (Parameter, ParameterKind)
AMOUNT = slider("Amount", 0.5, 0.0, 1.0)


@func
def deep(x: float) -> float:
    """An expression that is deeper than Python's stack."""
    total = x
    for _ in range(3000):
        total = total * 0.999 + 0.5
    return total


@image
def small(frame: Frame) -> vec3:
    """Numbers whose form matters: -0.0, large integers, tiny floats."""
    return vec3(AMOUNT * -0.0, float(2147483647) * 1e-30, frame.time) + vec3(5e-324 + 1.0)


def module_of(obj):
    return executor().lowered(obj).module


def again(module):
    kept = {}
    data = encoded(
        module, lambda source: kept.setdefault(str(id(source)), source) and str(id(source)), CLASSES
    )
    return data, decoded(data, kept.__getitem__, CLASSES)


@pytest.mark.parametrize("obj", [small, deep], ids=["small", "deep"])
def test_functions(obj):
    data, module = again(module_of(obj))
    assert print_module(module) == print_module(module_of(obj))
    assert again(module)[0] == data


@pytest.mark.sample(8)
@pytest.mark.parametrize("name", sorted(distal.gallery()))
def test_examples(name):
    shown = viewable(distal.load(f"example:{name}"), {}, 0.0)
    program = shown.image("color")
    whole = sent(program)
    found = received(whole.program, whole.data)
    for mine, part in zip([found, found.display], executor().parts(program).parts, strict=False):
        assert print_identity(mine.lowered.module) == print_identity(part.module)
        assert print_module(mine.lowered.module) == print_module(part.module)
    assert sent(program).digest == whole.digest
    assert len(whole.program["parts"][0]["module"]) < 120_000


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"none",
        zlib.compress(b"[]"),
        zlib.compress(json.dumps([["Module"], [[1, 2]], 0]).encode()),
        zlib.compress(json.dumps([["os.system"], [[1, "true"]], 0]).encode()),
        zlib.compress(json.dumps([["Const"], [[1, 1.0, [5]]], 0]).encode()),
        zlib.compress(json.dumps([["Scalar", "Kind"], [[2, "float"], [1, [0]]], 1]).encode()),
    ],
)
def test_wrong_bytes_are_refused(data):
    with pytest.raises(EncodingError, match=r"^the bytes are of no module"):
        decoded(data, lambda name: None)


def test_cut_bytes_are_refused():
    data, _ = again(module_of(small))
    for end in range(0, len(data), 7):
        with pytest.raises(EncodingError):
            decoded(data[:end], lambda name: None, CLASSES)


def test_names_of_the_library_are_buffers_alone():
    whole = sent(small)
    module = dict(whole.program["parts"][0])
    for name in ("library:os:environ", "library:distal.loading:load", "library:distal.x:y"):
        with pytest.raises((EncodingError, ImportError)):
            from distal.cluster.programs import _resource  # noqa: PLC0415 (what is attacked)

            _resource(name, {})
    assert module["digest"] == executor().lowered(small).digest
