"""Lights, cameras, materials, patterns and backgrounds give what their arguments say.

Every argument of a case is changed in turn, is followed by its formula (``constructor_cases``), and
must matter; an object or an argument without a case is red.
"""

from __future__ import annotations

import inspect
from typing import Any

import numpy as np
import pytest

import distal
from distal.ir.types import FLOAT, VEC3
from distal.lang.runtime_access import executor
from distal.render.material import Surface
from distal.scene.objects.cameras import TurnedCamera
from tests.scene.constructor_cases import (
    ALL_NUMBERS,
    CAMERAS,
    CASES,
    COLOR,
    ELSEWHERE,
    ELSEWHERE_ARGUMENTS,
    MAKERS,
    OTHER,
    PLACES,
    PLAIN,
    SITES,
    TURN,
    Case,
    surface,
)
from tests.scene.probing import Probe


def made(case: Case, arguments: dict[str, Any]) -> Any:
    maker = MAKERS[case.name]
    args: list[Any] = []
    kwargs: dict[str, Any] = {}
    for name, parameter in inspect.signature(maker).parameters.items():
        if name not in arguments:
            continue
        if parameter.kind is parameter.VAR_POSITIONAL:
            args += arguments[name]
        elif parameter.kind is parameter.VAR_KEYWORD:
            kwargs |= arguments[name]
        elif "args" in arguments:
            args.append(arguments[name])
        else:
            kwargs[name] = arguments[name]
    return maker(*args, **kwargs)


def given_by(case: Case, arguments: dict[str, Any], part: str, rank: int) -> Any:
    whole = made(case, arguments)
    emitting = getattr(whole, case.emits) if case.emits else whole
    probe = Probe(emitting, (case.site,), part, VEC3 if rank == 2 else FLOAT)
    return executor().call(probe, (SITES[case.site],), {}, device="reference")


def other_values(case: Case, name: str) -> list[Any]:
    value = case.arguments[name]
    if name in case.changed:
        return case.changed[name]
    if isinstance(value, bool):
        return [not value]
    if isinstance(value, int):
        return [value + 1]
    if isinstance(value, float):
        return [1.3 * value]
    if isinstance(value, dict):
        return [value | {k: 1.3 * v} for k, v in value.items()]
    # Colors stay within 0 to 1.
    return [tuple(0.9 * v if i == k else v for i, v in enumerate(value)) for k in range(len(value))]


@pytest.mark.parametrize("case", CASES, ids=lambda c: f"{c.name} {c.emits} {','.join(c.arguments)}")
def test_an_object_gives_what_its_arguments_say(case):
    expected = case.formula(**case.arguments)
    for part, values in expected.items():
        found = given_by(case, case.arguments, part, np.ndim(values))
        np.testing.assert_allclose(found, values, rtol=3e-6, atol=2e-6, err_msg=part)
    for name in case.arguments:
        for value in () if name in case.fixed else other_values(case, name):
            arguments = case.arguments | {name: value}
            wanted = case.formula(**arguments)
            moved = {p: v for p, v in wanted.items() if np.abs(v - expected[p]).max() > 1e-4}
            assert moved, f"{name}={value} changes nothing"
            for part, values in moved.items():
                found = given_by(case, arguments, part, np.ndim(values))
                message = f"{part} by {name}={value}"
                np.testing.assert_allclose(found, values, rtol=3e-6, atol=2e-6, err_msg=message)


MODULES = ("lights", "cameras", "materials", "patterns", "backgrounds")


def test_every_object_has_a_case_that_changes_each_argument():
    named_in = {f"distal.scene.objects.{module}" for module in MODULES}
    names = {n for n, maker in MAKERS.items() if getattr(maker, "__module__", "") in named_in}
    assert names - ELSEWHERE == {case.name for case in CASES}
    for name in {case.name for case in CASES}:
        maker = MAKERS[name]
        parameters = list(inspect.signature(maker).parameters)
        own = [case for case in CASES if case.name == name]
        changed = {n for case in own for n in case.arguments if n not in case.fixed}
        assert set(parameters) - changed <= ELSEWHERE_ARGUMENTS.get(name, set()), name
        for case in own:
            assert list(case.arguments) == [n for n in parameters if n in case.arguments], name


def test_a_material_has_the_defaults_of_a_surface():
    parameters = inspect.signature(distal.Material).parameters
    defaults = {name: parameter.default for name, parameter in parameters.items()}
    set_later = {"height", "tilt", "bsdf_share", "bsdf"}  # Material.bump, .bsdf and the renderers
    for name, parameter in inspect.signature(Surface).parameters.items():
        if name in set_later:
            assert not np.any(tuple_of(parameter.default))
            continue
        np.testing.assert_array_equal(defaults.pop(name), tuple_of(parameter.default), name)
    assert not defaults


def tuple_of(value: Any) -> Any:
    return tuple(value) if hasattr(value, "__iter__") else value


def test_a_camera_by_yaw_pitch_and_roll_is_a_turned_one():
    case = next(c for c in CAMERAS if c.name == "TurnedCamera")
    for more in ({"fov": 0.9}, {"fov_deg": 50.0}, {"screen_distance": 0.8}):
        arguments = TURN | {"screen_height": 1.4, **more, "mirrored": True}
        other = distal.Camera.yaw_pitch_roll(**arguments)
        whole = made(case, arguments)
        for name, value in whole.call.values.items():
            found = other.call.values[name]
            assert getattr(found, "value", found) == getattr(value, "value", value), name
        assert other.call.func is whole.call.func
    signatures = [
        list(inspect.signature(f).parameters.values())
        for f in (distal.Camera.yaw_pitch_roll, TurnedCamera)
    ]
    assert signatures[0] == signatures[1]


def test_materials_mix_from_the_first_to_the_second():
    first, second = distal.Material(**ALL_NUMBERS), distal.plastic(OTHER, 0.9, 2.1)
    whole = surface(**ALL_NUMBERS), surface(color=OTHER, roughness=0.9, ior=2.1, fresnel=1.0)
    case = Case("matte", {"color": COLOR}, surface)
    for t in (0.3, 0.8):
        mixed = first.mix(second, t)
        for part in PLAIN:
            probe = Probe(mixed, ("p",), part, VEC3 if np.ndim(whole[0][part]) == 2 else FLOAT)
            found = executor().call(probe, (PLACES,), {}, device="reference")
            expected = (1.0 - t) * whole[0][part] + t * whole[1][part]
            np.testing.assert_allclose(found, expected, atol=2e-6, err_msg=f"{case.name} {part}")
    assert mixed.reflects
    assert mixed.refracts
