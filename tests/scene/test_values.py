"""Objects are readable: each shows its arguments, and ``replace`` makes one with others.

Every shape of the library is made with random numbers, every operator by its case of
``test_methods``, every light, camera, material and pattern by its case of ``test_constructors``.
"""

from __future__ import annotations

import copy
import inspect
import math
import pickle
import re
import subprocess
import sys

import numpy as np
import pytest

import distal
from distal import Bolt, Box, Circle, Cylinder, Gear, Nut, Scene, Shape, Sphere, Text, choose
from distal.diagnostics import CompileError
from distal.fields.library import PRIMITIVES
from distal.lang import choice, color, func, integer, length, point, slider, toggle, vec3
from distal.scene.objects import shapes
from distal.scene.objects.materials import Material
from distal.scene.tree import digests
from distal.scene.tree.digests import digest_of, digest_of_node
from distal.scene.tree.node import Node
from tests.fields.drawing import default_sample, random_sample
from tests.fields.seeds import seed_of
from tests.scene.constructor_cases import CASES
from tests.scene.test_constructors import made


def values_of(sample):
    return {**sample.numbers, **sample.choices}


def same(a, b):
    if isinstance(a, float | int | tuple | list) and isinstance(b, float | int | tuple | list):
        return np.shape(a) == np.shape(b) and np.allclose(a, b, rtol=1e-6, atol=1e-9)
    return a is b or bool(a == b)


def evaluated(value):
    """Return what the text of an object evaluates to; the object itself if it does not evaluate."""
    text = repr(value)
    return value if re.search("<[^|]", text) else eval(text, {"__builtins__": __builtins__}, NAMES)


NAMES = {**vars(distal.lang), **{n: getattr(distal, n) for n in (*distal.__all__, "time")}}


def field_of(shape):
    size = 2 if shape.flat else 3
    points = np.random.default_rng(5).uniform(-1.5, 1.5, (50, size))
    return np.asarray(shape(points))


# Shapes of the library


@pytest.mark.parametrize("name", sorted(PRIMITIVES))
def test_a_shape_of_the_library_shows_its_arguments(name):
    rule, kind = PRIMITIVES[name], shapes.CLASSES[name]
    sample = random_sample(rule, np.random.default_rng(seed_of(name))) or default_sample(rule)
    names = tuple(inspect.signature(kind).parameters)
    given = {n: v for n, v in values_of(sample).items() if n in names}
    shape = kind(**given)
    assert tuple(shape.arguments) == names
    for n in names:
        assert same(shape.arguments[n], given[n]), n
        assert hasattr(kind, n)
        if isinstance(inspect.getattr_static(kind, n), property):
            assert same(getattr(shape, n), given[n])
    again = kind(**shape.arguments)
    assert dict(again.arguments) == dict(shape.arguments)
    assert (field_of(again) == field_of(shape)).all()
    assert again == shape == evaluated(shape) and hash(again) == hash(shape)
    other = pickle.loads(pickle.dumps(shape))
    assert type(other) is kind and other == shape and (field_of(other) == field_of(shape)).all()


@pytest.mark.parametrize("name", sorted(PRIMITIVES))
def test_each_number_can_be_replaced(name):
    rule, kind = PRIMITIVES[name], shapes.CLASSES[name]
    first = values_of(default_sample(rule))
    other = random_sample(rule, np.random.default_rng(seed_of(name)))
    names = [n for n in inspect.signature(kind).parameters if n in first]
    shape = kind(**{n: first[n] for n in names}).paint("red").named("mine")
    if other is None:
        return
    wanted = {n: values_of(other)[n] for n in names}
    changed = shape.replace(**wanted)
    assert type(changed) is kind and changed.name == "mine"
    assert changed.material is shape.material
    assert (field_of(changed) == field_of(kind(**wanted))).all()
    assert changed.replace().arguments == changed.arguments


def test_numbers_that_are_sliders_and_expressions_come_back_as_they_are():
    radius = slider("Radius", 1.0, 0.5, 2.0)
    assert Sphere(radius).radius is radius
    twice = Sphere(2.0 * radius).radius
    assert [p.name for p in twice.parameters] == ["radius"]
    assert Sphere(twice)((4.0, 0.0, 0.0), params={"radius": 1.5}) == pytest.approx(1.0)
    assert Box(1.0).size == (1.0, 1.0, 1.0)
    assert Box(2.0, math.inf, 2.0).size == (2.0, math.inf, 2.0)
    by_cell = Sphere(0.1 + 0.02 * distal.cell.x)
    assert by_cell.paint("red").radius is by_cell.radius
    assert by_cell.replace(radius=0.5).radius == 0.5


# Operators


def test_results_of_operators_show_what_made_them():
    ball = Sphere(2.0).paint("red")
    moved = ball.translate(1, 2, 3)
    assert moved.operator == "translate" and dict(moved.arguments) == {"offset": (1.0, 2.0, 3.0)}
    (child,) = moved.children
    assert type(child) is Sphere and child.radius == 2.0 and child.material is ball.material
    several = Box(1.0) | ball | Cylinder(0.1, 3.0)
    assert several.operator == "union"
    assert [type(c).__name__ for c in several.children] == ["Box", "Sphere", "Cylinder"]
    assert Sphere().operator is None and Sphere().children == () and Sphere().material is None


def test_operators_are_applied_anew():
    moved = Sphere(0.5).translate(1, 2, 3).paint("blue").named("ball")
    changed = moved.replace(offset=(0, 0, 1), children=[Box(0.5)])
    assert changed((0.0, 0.0, 1.25)) == pytest.approx(0.0, abs=1e-7)
    assert changed.name == "ball" and changed.material is moved.material
    row = Sphere(0.2).repeat((1, 0, 0), count=(3, 1, 1))
    assert row.arguments["count_x"] == 3 and row.children[0].radius == 0.2
    longer = row.replace(count_x=5)
    assert longer((2.0, 0.0, 0.0)) == pytest.approx(-0.2)
    edge = (Box(2, 2, 2) & Box(3, 1, 3)).fillet(0.2)
    assert (field_of(edge.replace(children=edge.children)) == field_of(edge)).all()


def test_the_name_of_an_operator_is_what_apply_takes():
    for a in (Sphere(0.7), Circle(0.7)):
        b = a.translate(*([0.4] * (2 if a.flat else 3)))
        for shape in (a | b, a & b, a - b, a ^ b, a.union(b, smooth=0.1), a.round(0.1), b, ~a):
            first, *others = shape.children
            again = first.apply(shape.operator, others=others, **shape.arguments)
            assert (field_of(again) == field_of(shape)).all()


# Shapes that are made by a call


def test_composites_show_their_arguments_and_keep_their_class():
    bolt = Bolt("M6", 25.0).paint("gold")
    assert type(bolt) is Bolt and bolt.size == "M6" and bolt.length == 25.0
    assert list(bolt.arguments) == ["size", "length", "thread", "left"]
    longer = bolt.replace(length=30.0)
    assert longer.length == 30.0 and longer.material is bolt.material and longer.name == "Bolt"
    nut = Nut("M6").named("mine")
    assert type(nut) is Nut and nut.pitch == 1.0 and nut.screwed(2.0).operator == "rotate y"
    assert nut.replace(left=True).left and nut.replace(left=True).name == "mine"
    assert Gear(1.0, 12).replace(teeth=14).pitch_radius == 7.0
    (child,) = Gear(1.0, 12).translate(1, 0, 0).children
    assert type(child) is Gear and child.pitch_radius == 6.0 and child.teeth == 12
    assert Text("a").replace(size=2.0).arguments["size"] == 2.0


@func
def ball_of(p: vec3, r: float) -> float:
    return length(p) - r


def test_functions_that_make_shapes_are_recorded():
    made_of = Shape.from_function(ball_of, r=2.0)
    assert made_of.arguments["function"] is ball_of and made_of.arguments["r"] == 2.0
    assert made_of.replace(r=3.0)((0, 0, 0)) == -3.0
    which = integer("Which", 0, 0, 1)
    one = choose(which, [Box(1.0), Sphere(1.0)])
    assert one.arguments["which"] is which
    assert type(one.replace(which=1)) is Sphere
    # An argument that comes back as it is was not made by the call.
    ball = Sphere(1.0)
    assert choose(0, [ball, Box(1.0)]) is ball and dict(ball.arguments) == {"radius": 1.0}


def test_an_authors_subclass_stays_its_class():
    class Washer(Gear):
        def __init__(self, wide):
            super().__init__(wide, 12)

    washer = Washer(2.0).paint("red")
    assert type(washer) is Washer and washer.module == 2.0
    assert type(washer.replace(teeth=13)) is Gear


# Lights, cameras, materials, patterns, backgrounds, looks


@pytest.mark.parametrize("case", CASES, ids=lambda c: f"{c.name} {c.emits} {','.join(c.arguments)}")
def test_called_objects_show_their_arguments(case):
    value = made(case, case.arguments)
    if not hasattr(value, "arguments"):
        pytest.skip("a function of a place, which no class holds")
    for name in value.arguments:
        assert hasattr(value, name)
    again = value.replace()
    assert list(again.arguments) == list(value.arguments)
    assert again == value and hash(again) == hash(value)
    other = pickle.loads(pickle.dumps(value))
    assert other == value and list(other.arguments) == list(value.arguments)
    # A sky may be a light and a background.
    assert repr(value).startswith("<") or evaluated(value) == value
    for name, given in value.arguments.items():
        changed = value.replace(**{name: given}) if given is not None else value
        assert same(changed.arguments[name], given), name


def test_lights_and_cameras_are_replaced():
    light = distal.PointLight((1, 2, 3), color="red", intensity=2.0)
    assert light.position == (1.0, 2.0, 3.0) and light.color == (1.0, 0.0, 0.0)
    assert light.replace(intensity=5.0).intensity == 5.0
    assert light.replace(intensity=5.0).color == light.color
    camera = distal.Camera((0, 1, 5), fov_deg=40.0)
    assert camera.fov_deg == 40.0 and camera.fov is None
    assert camera.replace(fov=0.5).fov == 0.5 and camera.replace(fov=0.5).fov_deg is None
    assert camera.replace(target=(0, 1, 0)).fov_deg == 40.0
    assert "roughness" in dir(distal.metal("red")) and not hasattr(distal.matte("red"), "ior")


def test_materials_keep_their_priority():
    glass = Sphere().paint(distal.glass(1.33), priority=2).material
    assert isinstance(glass, Material) and glass.priority == 2 and glass.ior == 1.33
    assert glass.replace(ior=1.5).priority == 2 and glass.replace(priority=0).priority == 0
    assert distal.matte("red").bump(0.1).replace(height=0.2).height == 0.2
    assert distal.matte("red").mix("blue", 0.25).t == 0.25


def test_unknown_names_are_refused_at_the_authors_line():
    light = distal.PointLight((1, 2, 3))
    with pytest.raises(AttributeError, match="a light has no 'intensty'"):
        _ = light.intensty
    for value, name in ((light, "intensty"), (Sphere(), "radus"), (distal.metal(), "rough")):
        with pytest.raises(CompileError) as caught:
            value.replace(**{name: 1.0})
        assert caught.value.diagnostics[0].span.file == __file__
    bumped = distal.matte("red").bump(0.1)
    with pytest.raises(CompileError) as caught:
        bumped.replace(color="blue")
    found = caught.value.diagnostics[0]
    assert found.message == "bump has no 'color'"
    assert found.hint == 'replace(**{"surface.color": …})'
    assert bumped.replace(**{"surface.color": "blue"}) == distal.matte("blue").bump(0.1)
    with pytest.raises(CompileError, match="bump has no 'hight'"):
        bumped.replace(hight=1.0)
    with pytest.raises(CompileError, match="Sphere was made by no operator: it has no children"):
        Sphere().replace(children=[Box()])
    with pytest.raises(CompileError, match="'translate' takes one child, not 2"):
        Sphere().translate(1, 0, 0).replace(children=[Box(), Box()])
    with pytest.raises(CompileError, match="the children of 'union' are solids"):
        (Sphere() | Box()).replace(children=[Circle(), Circle()])


# Scenes


def test_scenes_are_replaced():
    ball = Sphere(0.5).paint("red")
    scene = Scene(ball, exposure=1.5, name="mine")
    assert scene.exposure == 1.5 and scene.arguments["shape"] is ball
    assert scene.arguments["lights"] is None and len(scene.lights) > 0
    assert list(scene.arguments) == list(inspect.signature(Scene).parameters)
    changed = scene.replace(exposure=2.0, floor=False)
    assert (changed.exposure, changed.floor, changed.name) == (2.0, False, "mine")
    assert scene.floor and changed.replace(look="night").look.name == "night"
    with pytest.raises(CompileError, match="a scene has no 'exposur'"):
        scene.replace(exposur=1.0)
    night = distal.night(exposure=2.0)
    assert night.exposure == 2.0 and night.replace(haze=0.0).arguments["exposure"] == 2.0


@pytest.mark.skipif(sys.version_info < (3, 13), reason="copy.replace is new in 3.13")
def test_copy_replace():
    assert copy.replace(Sphere(1.0), radius=2.0).radius == 2.0  # type: ignore[attr-defined]
    assert copy.replace(Scene(Sphere()), glow=0.5).glow == 0.5  # type: ignore[attr-defined]


# Equality by value


def test_shapes_are_equal_by_value():
    assert Sphere(1) == Sphere(1.0) and hash(Sphere(1)) == hash(Sphere(1.0))
    assert Sphere(1.0) != Sphere(2.0) and Sphere(1.0) != Circle(1.0) and Sphere() != 1.0
    assert Sphere().named("a") != Sphere().named("b")
    assert Sphere().paint("red") == Sphere().paint("#ff0000") != Sphere().paint("blue")
    assert {Sphere(1.0) | Box(): "here"}[Sphere(1.0) | Box()] == "here"
    assert Box() | Sphere() != Sphere() | Box()
    # What it was made by does not count, its class neither.
    bolt = Bolt("M6", 25.0)
    assert bolt == Bolt("M6", length=25.0) != Bolt("M6", 24.0)
    assert Shape._of(bolt.node) == bolt
    radius, same_radius = (slider("Radius", 1.0, 0.5, 2.0) for _ in range(2))
    assert Sphere(2.0 * radius) == Sphere(2.0 * same_radius) != Sphere(3.0 * radius)
    assert Sphere(radius) != Sphere(slider("Radius", 1.0, 0.5, 3.0))


def test_textures_are_equal_by_content():
    rows = np.random.default_rng(1).uniform(size=(8, 8, 3))
    first, second = (distal.matte(distal.image_pattern(rows.copy())) for _ in range(2))
    assert first == second and hash(first) == hash(second)
    assert first != distal.matte(distal.image_pattern(rows + 0.1))
    pictures = [distal.lang.Texture2D(rows.copy()) for _ in range(2)]
    assert digest_of(pictures[0]) == digest_of(pictures[1])
    files = [distal.lang.Texture2D(name) for name in ("a.png", "a.png", "b.png")]
    assert digest_of(files[0]) == digest_of(files[1]) != digest_of(files[2])
    opaque = [object(), object()]
    assert digest_of(opaque[0]) == digest_of(opaque[0]) != digest_of(opaque[1])


NEAR = 1.0


def test_functions_are_equal_by_their_text_and_what_they_read():
    def scaled(factor):
        @func
        def scaled_ball(p: vec3) -> float:
            return (length(p) - NEAR) * factor

        return Shape.from_function(scaled_ball)

    assert scaled(0.5) == scaled(0.5) != scaled(0.25)
    before = scaled(0.5)
    assert before == scaled(0.5)
    globals()["NEAR"] = 2.0
    try:
        assert before != scaled(0.5)
    finally:
        globals()["NEAR"] = 1.0
    assert before == scaled(0.5)


def test_lights_materials_scenes_and_curves_are_equal_by_value():
    pairs = [
        (lambda **k: distal.PointLight((1, 2, 3), **k), {"intensity": 2.0}),
        (lambda **k: distal.Camera((0, 1, 4), **k), {"fov": 0.4}),
        (lambda **k: distal.Sky(**k), {"light": True}),
        (lambda **k: distal.glass(**k), {"ior": 1.4}),
        (lambda **k: distal.checker("red", "blue", **k), {"size": 0.3}),
        (lambda **k: distal.night(**k), {"exposure": 0.4}),
        (lambda **k: Scene(Sphere(), **k), {"exposure": 0.4}),
        (lambda **k: Scene(Sphere(), **k), {"shadows": False}),
        (lambda **k: distal.Background((1, 0, 0)), {}),
    ]
    for make, other in pairs:
        assert make() == make() and hash(make()) == hash(make())
        assert not other or make() != make(**other)
    assert distal.glass() != distal.PointLight((1, 2, 3))
    assert distal.matte("red").replace(priority=2) != distal.matte("red")
    circle = distal.Curve.from_function(lambda t: (math.cos(t), 0.0, math.sin(t)), 0, 3)
    assert circle == circle.replace() != circle.replace(end=2.0)


def test_parameters_are_no_numbers():
    radius = slider("Radius", 1.0, 0.5, 2.0)
    assert radius == slider("Radius", 1.0, 0.5, 2.0) != slider("Radius", 1.5, 0.5, 2.0)
    assert 2.0 * radius == 2.0 * slider("Radius", 1.0, 0.5, 2.0)
    with pytest.raises(TypeError, match="no value yet"):
        _ = radius == 1.0


def test_pictures_are_equal_by_their_pixels():
    first, second = (Sphere().render((8, 6)) for _ in range(2))
    assert first == second and hash(first) == hash(second)
    assert first != Sphere().render((8, 6), view="normal") and first != first.array.tolist()


def test_a_deep_tree_is_compared_without_recursion():
    rule, first = Sphere().translate(1, 0, 0).node, Sphere().node
    trees = [first, first]
    for _ in range(5000):
        trees = [distal_node(rule, tree) for tree in trees]
    assert digest_of_node(trees[0]) == digest_of_node(trees[1]) != digest_of_node(first)


def distal_node(like, child):
    return Node(like.rule, like.flat, (child,), like.numbers, like.constants)


def test_nothing_is_digested_unless_it_is_compared(monkeypatch):
    """Compiled functions are kept by identity: a digest of a large tree takes a second."""

    def refused(*_):
        raise AssertionError("it was hashed or compared")

    monkeypatch.setattr(digests, "digest_of_node", refused)
    monkeypatch.setattr(digests, "digest_of", refused)
    shape = (Sphere(0.7).paint("red") | Box(slider("Side", 0.5, 0.1, 1.0))).translate(1, 0, 0)
    assert shape((1.0, 0.0, 0.0)) == pytest.approx(-0.7)
    assert shape.gradient((3.0, 0.0, 0.0))[0] == pytest.approx(1.0)
    assert shape.heights((3, 3)).heights.shape == (3, 3)
    assert distal.compile(Scene(shape, lights=[distal.PointLight((1, 2, 3))]), "wgsl").text


def test_equal_objects_do_not_share_what_belongs_to_one():
    first, second = Sphere(0.7), Sphere(0.7)
    assert first == second
    assert first((0.0, 0.0, 0.0)) == second((0.0, 0.0, 0.0)) == pytest.approx(-0.7)
    sky = distal.Sky(light=True)
    scene = Scene(Sphere(), lights=[distal.Sky(light=True)], background=sky)
    assert len(scene.lights) == 2  # two equal skies are two lights


RULES = """
import gc
import importlib
import pkgutil

import distal.fields
from distal import Scene, Sphere
from distal.fields.guarantees import Operator, Primitive
from distal.scene.lowering.parts.table import PARTS
from distal.scene.lowering.pieces.brick_table import JOINED
from distal.scene.tree.rules import name_of

for module in pkgutil.walk_packages(distal.fields.__path__, "distal.fields."):
    importlib.import_module(module.name)
rules = [each for each in gc.get_objects() if isinstance(each, Operator | Primitive)]
# Those of tables exist in compiled programs alone.
nameless = [each for each in rules if not name_of(each) and each not in (JOINED, PARTS)]
print(len(rules), [each.name for each in nameless])
"""


def test_every_rule_of_the_library_has_a_name():
    """In a process of its own: tests make rules."""
    done = subprocess.run([sys.executable, "-c", RULES], capture_output=True, text=True, check=True)
    count, _, nameless = done.stdout.partition(" ")
    assert int(count) > 300 and nameless.strip() == "[]"


def test_points_come_back_as_a_list():
    corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]
    triangle = distal.Polygon(corners)
    assert triangle.points == corners
    assert repr(triangle) == f"Polygon(points={corners})"
    other = triangle.replace(**{"points.1": (2, 0)})
    assert other == distal.Polygon([(0, 0), (2, 0), (0, 1)])
    array = distal.Polygon(np.array(corners))
    assert array == triangle


def test_numbers_far_away_stay_numbers_and_zero_has_no_sign():
    assert distal.Sphere(1e15).radius == 1e15
    assert distal.Box(math.inf, 1, 1).size == (math.inf, 1.0, 1.0)
    moved = distal.Sphere(1.0).translate
    assert moved(0.0, 0.0, 0.0) == moved(-0.0, 0.0, 0.0) != moved(-1e-9, 0.0, 0.0)


@pytest.mark.parametrize(
    "parameter",
    [
        slider("Radius", 1.0, low=0.1, high=3.0, group="Size"),
        integer("Count", 3, low=1, high=9),
        toggle("On", True),
        choice("Kind", ["one", "two"], "two"),
        color("Paint", "#ff0000"),
        point("Place", (1, 2)),
        slider("Größe", 0.5, name="size"),
    ],
)
def test_parameters_show_their_arguments_and_make_others(parameter):
    assert parameter.replace() == parameter
    other = parameter.replace(group="Other", label="Else")
    assert (other.group, other.label, other.default) == ("Other", "Else", parameter.default)
    assert other.replace(group=parameter.group, label=parameter.label) == parameter
    with pytest.raises(TypeError, match=f"a {parameter.kind.value} has no 'hi'; it takes label, "):
        parameter.replace(hi=3)


def test_a_plan_that_is_extruded_shows_how():
    plan = Circle(1.0).extrude(0.5, along="y", chamfer=0.1)
    assert repr(plan) == "Circle(radius=1.0).extrude(height=0.5, along='y', chamfer=0.1)"
    assert evaluated(plan) == plan == pickle.loads(pickle.dumps(plan))
    assert plan.replace(along="z") == Circle(1.0).extrude(0.5, chamfer=0.1)
    assert plan.replace(**{"outline.radius": 2}) == Circle(2).extrude(0.5, along="y", chamfer=0.1)


@pytest.mark.parametrize(
    "kind",
    ["Bolt", "Nut", "MetricThread", "MetricHole", "Gear", "Rack", "RingGear", "Text", "SvgPath"],
)
def test_editors_know_the_attributes_of_what_is_written_by_hand(kind):
    made = getattr(distal, kind)
    arguments = [*inspect.signature(made.__init__).parameters][1:]
    assert set(arguments) <= set(made.__annotations__)
