"""Every method of a shape means what its case says, with each of its arguments.

A method without a case is red, as is an operator that no case reaches and a parameter that no case
changes: a method that names another operator, or passes arguments in another order, has another
field than its case's formula (``method_cases``).
"""

from __future__ import annotations

import inspect
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import distal
from distal import Shape, Shape2D
from distal.fields.combine.blends import BLENDS
from distal.fields.ease import EASES
from distal.fields.library import OPERATORS
from distal.lang import func, sin, vec3
from distal.lang.runtime_access import executor
from distal.scene.tree.errors import SceneTypeError
from tests.scene import method_fields as cases
from tests.scene.method_cases import SOLIDS
from tests.scene.method_cases_flat import FLATS
from tests.scene.method_fields import SMALL, Case, Child

# What makes no shape of another by an operator, and which test looks at it.
NO_OPERATOR = {
    "bounds": "fields/",
    "gradient": "gradients/",
    "compose": "asks",
    "functions": "asks",
    "named": "a label",
    "paint": "scene/test_surfaces",
    "cut_material": "scene/test_surfaces",
    "from_function": "below: all children here",
    "from_vm": "tape/test_vm_files",
    "from_mesh": "polygons/test_mesh_shapes",
    "from_volume": "polygons/test_volumes",
    "from_image": "polygons/test_pictures",
    "from_points": "polygons/test_points",
    "render": "scene/test_described",
    "imported": "asks",
    "fill": "tape/test_filled_shapes",
    "heights": "tape/test_shape_heights",
    "outline": "mesh/test_outlines",
    **dict.fromkeys(("on", "align", "extents"), "scene/test_anchors"),
    **dict.fromkeys(("fillet", "chamfer", "infill", "wrap_around"), "scene/test_shaped_edges"),
    "where": "scene/test_masked",
    "mesh": "mesh/test_mesh",
    "measure": "mesh/test_mesh",
    "parameters": "asks",
    "emitted": "shows",
    "paths": "scene/test_paths",
    "replace": "scene/test_values",
    "show": "shows",
    "export": "shows",
    "video": "shows",
}
ALL = [*((case, False) for case in SOLIDS), *((case, True) for case in FLATS)]
CASES = [replace(case, flat=flat) for case, flat in ALL]
COUNT = 60
# Numbers of a shape are floats of 32 bits.
TOLERANCE = 3e-6


def rows_of(child: Child, flat: bool) -> tuple[tuple[float, ...], tuple[float, ...]]:
    size = 2 if flat else 3
    return child.low[:size], child.high[:size]


def shape_of(child: Child, flat: bool, second: bool = False) -> Any:
    """The field of a child as a shape."""
    solid = cases.wave_b if second else cases.wave_a
    plane = cases.flat_wave_b if second else cases.flat_wave_a
    made = Shape2D if flat else Shape
    return made.from_function(
        plane if flat else solid,
        level=child.level,
        size=child.size,
        slope=2.0,
        bounds=rows_of(child, flat),
    )


def formula_of(child: Child, flat: bool, second: bool = False) -> Any:
    """The same in NumPy."""
    solid = cases.numpy_b if second else cases.numpy_a
    plane = cases.numpy_flat_b if second else cases.numpy_flat_a
    return lambda p: child.level + child.size * (plane if flat else solid)(p)


def called(case: Case, arguments: dict[str, Any], child: Child) -> Any:
    """The shape that a case's method makes of these arguments, by their names."""
    a, b = shape_of(child, case.flat), shape_of(child, case.flat, second=True)
    method = getattr(a, case.method)
    args: list[Any] = []
    kwargs: dict[str, Any] = {}
    for name, parameter in inspect.signature(method).parameters.items():
        several = parameter.kind is parameter.VAR_POSITIONAL
        if name == "others":
            args += [b] if several else []
            kwargs |= {"others": [b]} if case.joins else {}
        elif several:
            args += arguments.get(name, ())
        elif parameter.kind is parameter.VAR_KEYWORD:
            rest = {k: v for k, v in arguments.items() if k not in kwargs}
            kwargs |= rest if case.method == "apply" else arguments.get(name, {})
        elif name in ("other", "field"):
            kwargs[name] = b
        elif name in arguments:
            kwargs[name] = arguments[name]
    made = method(*args, **kwargs)
    return made if case.part is None else made[case.part]


def asked(shape: Any, points: Any) -> Any:
    """Its field by the reference, which compiles nothing; ``tests/fields`` compares the devices."""
    return executor().call(shape, (points,), {}, device="reference")


def is_flat(case: Case) -> bool:
    return case.flat if case.lands is None else case.lands


def places_and_values(case: Case, arguments: dict[str, Any]) -> tuple[Any, Any]:
    """Points and what the case says that the field is there."""
    rng = np.random.default_rng(7)
    child = case.child
    a, b = formula_of(child, case.flat), formula_of(child, case.flat, second=True)
    if case.formula is not None:
        p = rng.uniform(-case.reach, case.reach, (COUNT, 2 if is_flat(case) else 3))
        return p, np.asarray(case.formula(a, b, p, **arguments))
    assert case.copies is not None
    low, high = np.array(rows_of(SMALL, case.flat))
    local = rng.uniform(0.9 * low, 0.9 * high, (10, len(low)))
    # Copies around an axis stand away from it.
    own = local + 0.5 * (np.array(rows_of(child, case.flat)).sum(0) - low - high)
    made = [c if isinstance(c, tuple) else (c, 1.0) for c in case.copies(local, **arguments)]
    return np.concatenate([p for p, _ in made]), np.concatenate([f * a(own) for _, f in made])


def other_values(case: Case, name: str) -> list[Any]:
    """Other values of an argument: each of its numbers half as much again, in turn."""
    value = case.arguments[name]
    if name in case.changed:
        return case.changed[name]
    if name in case.unit:
        return [cases.OTHER_AXIS[: len(value)] if len(value) == 3 else (0.6, 0.8)]
    if isinstance(value, bool):
        return [not value]
    if isinstance(value, int):
        return [value + 1]
    if isinstance(value, float):
        return [1.5 * value]
    if isinstance(value, dict):
        return [value | {k: 1.3 * v} for k, v in value.items()]
    rows = np.asarray(value, float)
    found = []
    for index in np.ndindex(rows.shape):
        changed = rows.copy()
        changed[index] = 1.5 * changed[index] if changed[index] else 0.2
        found.append(tuple(changed.tolist()) if changed.ndim == 1 else changed.tolist())
    return found


def matters_far_away(case: Case, arguments: dict[str, Any], flat: bool) -> bool:
    """Whether other arguments give another field of a child that is far from 0."""
    far = replace(case.child, level=4.0)
    around = np.random.default_rng(3).uniform(-2.0, 2.0, (200, 2 if flat else 3))
    before, after = (asked(called(case, k, far), around) for k in (case.arguments, arguments))
    return bool(np.abs(before - after).max() > 0.01)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_method_has_the_field_of_its_formula(case):
    tolerance = TOLERANCE * case.child.size
    arguments = dict(case.arguments)
    points, expected = places_and_values(case, arguments)
    before = asked(called(case, arguments, case.child), points)
    np.testing.assert_allclose(before, expected, atol=tolerance)
    for name in arguments:
        for value in () if name in case.fixed else other_values(case, name):
            changed = arguments | {name: value}
            there, wanted = places_and_values(case, changed)
            shape = called(case, changed, case.child)
            # At the points of before too: to see a change.
            both = asked(shape, np.concatenate([there, points]))
            found, after = both[: len(there)], both[len(there) :]
            np.testing.assert_allclose(found, wanted, atol=tolerance, err_msg=f"{name}={value}")
            if not np.abs(after - before).max() > 1000.0 * tolerance:
                assert matters_far_away(case, changed, is_flat(case)), f"{name}={value}: no change"


def methods_of(kind: type) -> set[str]:
    found = {name for name in dir(kind) if not name.startswith("_")}
    return {name for name in found if callable(getattr(kind, name)) and name not in NO_OPERATOR}


@pytest.mark.parametrize("kind", [Shape, Shape2D])
def test_every_method_has_a_case_that_changes_each_of_its_arguments(kind):
    known = [case for case in CASES if case.flat is (kind is Shape2D)]
    assert methods_of(kind) == {case.method for case in known}
    for name in sorted(methods_of(kind)):
        parameters = list(inspect.signature(getattr(kind, name)).parameters)[1:]
        own = [case for case in known if case.method == name]
        changed = {n for case in own for n in case.arguments if n not in case.fixed}
        assert set(parameters) - changed <= EXEMPT.get(name, set()), name
        for case in own if name != "apply" else []:
            order = [n for n in parameters if n in case.arguments]
            assert list(case.arguments) == order, f"{name}: the order of its parameters"


BLENDED = {"others", "smooth", "blend", "blend_numbers"}  # below, for every blend
EXEMPT = {
    **{name: BLENDED for name in ("union", "intersection", "difference")},
    **{name: {"other"} for name in ("transition_linear", "transition_radial", "clearance")},
    **{name: {"other"} for name in ("carve", "emboss", "morph", "engrave", "pipe", "groove")},
    **{name: {"other"} for name in ("tongue", "loft")},
    "xor": {"others"},
    "array": {"colors"},  # scene/test_columns
    "displace": {"field"},
    "apply": {"operator", "args", "others", "kwargs"},  # cases name what the operators take
    "relief": {"numbers"},  # there are none, and any are refused
}


DEFAULTS = {
    "wrap_cylinder": {"count": None},
    "where": {"blend": 0.0},
    **{k: {"axes": None, "offset": 0.0, "across": None} for k in ("mirror", "symmetry")},
    "split": {"offset": 0.0},
    "shell": {"where": "inner"},
    "orient": {"target": None},
    "repeat": {"count": None, "neighbors": 0, "mirrored": False},
    "repeat_polar": {"neighbors": 0},
    "shear": {"xy": 0.0, "xz": 0.0, "yz": 0.0},
    "array": {
        **dict.fromkeys(("positions", "start", "end", "count")),
        **dict.fromkeys(("colors", "scale", "rotation", "align")),
        "axis": (0.0, 1.0, 0.0),
    },
    "bend_linear": {"ease": "linear"},
    "bend_radial": {"ease": "linear"},
    "transition_linear": {"ease": "linear"},
    "transition_radial": {"ease": "linear"},
    "warp": {"frequency": 1.0, "seed": 0},
    "displace": {"height": 1.0},
    "slice": {"origin": (0.0, 0.0, 0.0), "normal": (0.0, 0.0, 1.0)},
    "project": {"count": 32},
    "extrude": {"height": 1.0, "along": "z", "rounding": None, "chamfer": None},
    "revolve": {"offset": 0.0, "angle": None},
    "loft": {"height": 1.0, "ease": "linear"},
    "sweep": {"up": (0.0, 1.0, 0.0)},
    "sweep_bezier": {"up": (0.0, 1.0, 0.0), "pieces": 16},
    **{k: {"smooth": 0.0, "blend": "quadratic"} for k in ("union", "intersection", "difference")},
    "apply": {"others": ()},
}
ROTATE = dict.fromkeys(("angle", "axis", "x", "y", "z", "quaternion", "matrix"))


@pytest.mark.parametrize("kind", [Shape, Shape2D])
def test_what_is_not_said_is_what_is_documented(kind):
    for name in sorted(methods_of(kind)):
        parameters = inspect.signature(getattr(kind, name)).parameters.values()
        found = {p.name: p.default for p in parameters if p.default is not p.empty}
        turned = ROTATE if name == "rotate" and kind is Shape else {}
        assert found == DEFAULTS.get(name, turned), name


@pytest.mark.parametrize("blend", BLENDS)
@pytest.mark.parametrize("kind", ["union", "intersection", "difference", "xor"])
def test_every_blend_joins_as_its_union_says(kind, blend):
    """The other ways are the union of the outsides: what is joined is told by its name."""
    counts = {"count": 3} if BLENDS[blend].counted else {}
    a, b = shape_of(cases.MIXED, False), shape_of(cases.MIXED, False, second=True)
    p = np.random.default_rng(1).uniform(-0.9, 0.9, (COUNT, 3))
    at_a, at_b = formula_of(cases.MIXED, False)(p), formula_of(cases.MIXED, False, True)(p)
    if kind == "xor":  # no method takes a blend of it
        made = a.apply(f"xor {blend}", others=[b], smooth=0.3, **counts)
        first, second = np.minimum(at_a, at_b), -np.maximum(at_a, at_b)
    else:
        made = getattr(a, kind)(b, smooth=0.3, blend=blend, **counts)
        first, second = at_a, -at_b if kind == "difference" else at_b
    if kind == "union":
        expected = BLENDS[blend].union(first, second, 0.3, **counts)
    elif BLENDS[blend].intersection is not None:
        expected = BLENDS[blend].intersection(first, second, 0.3, **counts)
    else:
        expected = -np.asarray(BLENDS[blend].union(-first, -second, 0.3, **counts))
    np.testing.assert_allclose(asked(made, p), expected, atol=2e-6)
    assert made.node.rule is (OPERATORS[f"{kind} {blend}"])
    plain = OPERATORS[kind].combine(at_a, at_b)
    assert np.abs(asked(made, p) - plain).max() > 1e-3


@pytest.mark.parametrize("kind", ["union", "intersection", "difference"])
def test_several_are_joined_one_after_the_other(kind):
    a, b = shape_of(cases.MIXED, False), shape_of(cases.MIXED, False, second=True)
    c = a.translate(0.5, -0.3, 0.2)
    p = np.random.default_rng(1).uniform(-0.9, 0.9, (COUNT, 3))
    one_by_one = getattr(getattr(a, kind)(b, smooth=0.3), kind)(c, smooth=0.3)
    together = getattr(a, kind)([b, c], smooth=0.3)
    np.testing.assert_allclose(asked(together, p), asked(one_by_one, p), atol=1e-12)
    assert np.abs(asked(getattr(a, kind)([c, b], smooth=0.3), p) - asked(together, p)).max() > 1e-4


def test_every_operator_is_reached():
    """By a case above: what has no method is given by its name."""
    reached = {
        called(case, dict(case.arguments), case.child).node.rule.name
        for case in CASES
        if case.method != "shown"
    }
    reached |= {f"{kind} {blend}" for kind in ("union", "intersection") for blend in BLENDS}
    reached |= {f"{kind} {blend}" for kind in ("difference", "xor") for blend in BLENDS}
    assert reached == set(OPERATORS)


def test_signs_of_operators_are_their_methods():
    a, b = shape_of(cases.MIXED, False), shape_of(cases.MIXED, False, second=True)
    for sign, name in (("|", "union"), ("&", "intersection"), ("-", "difference"), ("^", "xor")):
        made = eval(f"a {sign} b", {"a": a, "b": b})
        assert made.node.rule is OPERATORS[name]
        assert made.node.children == (a.node, b.node), sign
    assert (~a).node.rule is OPERATORS["complement"]


def test_functions_of_several_shapes_are_methods_and_signs():
    a, b = shape_of(cases.MIXED, False), shape_of(cases.MIXED, False, second=True)
    c = a.translate(0.5, -0.3, 0.2)
    p = np.random.default_rng(1).uniform(-0.9, 0.9, (COUNT, 3))
    at_a, at_b, at_c = (asked(shape, p) for shape in (a, b, c))
    signs = {"union": a | b | c, "intersection": a & b & c, "difference": a - b - c}
    signs["xor"] = a ^ b ^ c
    for name, by_signs in signs.items():
        function = getattr(distal, name)
        expected = asked(by_signs, p)
        for made in (function(a, b, c), function([a, b, c]), function(s for s in (a, b, c))):
            np.testing.assert_array_equal(asked(made, p), expected, err_msg=name)
        np.testing.assert_array_equal(asked(getattr(a, name)(b, c), p), expected, err_msg=name)
        assert function(a) is a
        with pytest.raises(SceneTypeError, match=f"{name} needs at least one shape"):
            function([])
        with pytest.raises(SceneTypeError, match=f"{name} joins shapes, not 3"):
            function(3, a)
    np.testing.assert_allclose(asked(signs["difference"], p), np.max([at_a, -at_b, -at_c], axis=0))
    inside = (at_a < 0).astype(int) + (at_b < 0) + (at_c < 0)
    np.testing.assert_array_equal(asked(signs["xor"], p) < 0, inside % 2 == 1)
    for name in ("union", "intersection", "difference"):
        smooth = getattr(distal, name)(a, b, c, smooth=0.3, blend="stairs", count=3)
        by_method = getattr(a, name)(b, c, smooth=0.3, blend="stairs", count=3)
        np.testing.assert_array_equal(asked(smooth, p), asked(by_method, p))


@func
def ripple(p: vec3) -> float:
    return sin(3.0 * p.x) * p.y


def test_a_function_displaces_as_its_shape_does():
    a = shape_of(cases.MIXED, False)
    p = np.random.default_rng(1).uniform(-0.9, 0.9, (COUNT, 3))
    expected = formula_of(cases.MIXED, False)(p) - 0.3 * np.sin(3.0 * p[:, 0]) * p[:, 1]
    np.testing.assert_allclose(asked(a.displace(ripple, 0.3), p), expected, atol=2e-6)


def test_every_ease_is_its_number():
    a = shape_of(cases.HIGH, False)
    for number, ease in enumerate(EASES):
        bent = a.bend_linear((0, 0, 0), (1, 0, 0), (0, 1, 0), ease)
        assert bent.node.constants["ease"] == number
