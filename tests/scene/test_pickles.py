"""Objects in other processes: pickles of shapes, scenes and what they are made of."""

from __future__ import annotations

import copy
import linecache
import os
import pickle
import subprocess
import sys
from pathlib import Path

import cloudpickle
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import distal
from distal import (
    Bolt,
    Box,
    Camera,
    Circle,
    Curve,
    Environment,
    Gear,
    PointLight,
    Scene,
    Shape,
    Sky,
    Sphere,
    Text,
    checker,
    choose,
    copies,
    glass,
    library_stamp,
    matte,
    metal,
    night,
    time,
)
from distal.diagnostics import CompileError
from distal.lang import Frame, func, image, integer, length, slider, struct, vec3, vec4
from distal.scene.tree.digests import digest_of, digest_of_node
from distal.scene.tree.node import Node
from tests.scene.test_values import evaluated


def travelled(value):
    """Return what another process gets of a value: nothing of it is the same object."""
    return pickle.loads(pickle.dumps(value))


RADIUS = slider("Radius", 0.5, 0.1, 1.0)
ROWS = np.random.default_rng(3).uniform(size=(4, 4, 3))
POINTS = np.arange(12.0).reshape(4, 3)
OBJECTS = [
    Sphere(),
    Sphere(RADIUS).paint("red").named("ball"),
    Sphere(0.5 + RADIUS * time),
    Bolt("M6", 25.0).paint(metal("gold")),
    Gear(1.0, 12).translate(1, 0, 0),
    Text("a"),
    choose(integer("Which", 0, 0, 1), [Box(), Sphere(RADIUS)]),
    copies(Sphere(), POINTS),
    Shape.from_vm("_0 var-x\n_1 const 1\n_2 sub _0 _1\n"),
    Box().paint(distal.image_pattern(ROWS)),
    Scene(Sphere(RADIUS), exposure=2.0, look="night"),
    Camera(),
    PointLight((1, 2, 3)),
    Sky(light=True),
    Environment(ROWS),
    glass(),
    checker(),
    matte("red").mix("blue").bump(0.1),
    night(exposure=0.4),
    RADIUS,
    0.5 * time,
    Curve.from_function(lambda t: (t, t * t, 0.0)),
]


@pytest.mark.parametrize("made", OBJECTS, ids=lambda made: type(made).__name__)
def test_copies_are_the_same_object(made):
    assert copy.copy(made) is made
    assert copy.deepcopy([made])[0] is made


@pytest.mark.parametrize("made", OBJECTS, ids=lambda made: type(made).__name__)
def test_pickles_are_equal_objects(made):
    for module in (pickle, cloudpickle):
        other = module.loads(module.dumps(made))
        assert type(other) is type(made) and other == made and hash(other) == hash(made)
        assert repr(other) == repr(made)
    if isinstance(made, Shape):
        assert [type(c) for c in other.children] == [type(c) for c in made.children]
        assert other.operator == made.operator and list(other.arguments) == list(made.arguments)
        assert other.named("other") == made.named("other")
        assert other((0.3, 0.2, 0.1)) == made((0.3, 0.2, 0.1))


def test_what_belongs_to_a_shape_travels():
    gear = travelled(Gear(1.0, 12).translate(1, 0, 0)).children[0]
    assert type(gear) is Gear and gear.pitch_radius == 6.0 and gear.replace(teeth=14).teeth == 14
    ball = Sphere().paint("red")
    first, second = travelled([ball | ball.translate(1, 0, 0), ball])
    below = first.node.children
    assert below[0] is below[1].children[0] and below[0].material is below[1].children[0].material
    assert second == ball
    scene = Scene(ball | Sphere(RADIUS), exposure=1.5)
    other = travelled(scene)
    assert other.replace(exposure=2.0, floor=False) == scene.replace(exposure=2.0, floor=False)
    assert distal.compile(other, "wgsl").text == distal.compile(scene, "wgsl").text


def test_pictures_and_heights_travel():
    picture = Scene(Sphere()).render((8, 6), layers=("depth",))
    other = travelled(picture)
    assert other == picture and other.provenance == picture.provenance
    assert not other.array.flags.writeable and (other.linear == picture.linear).all()
    heights = Sphere().heights((4, 4))
    assert travelled(heights) == heights and travelled(heights).picture() == heights.picture()


def test_what_belongs_to_a_compilation_stays_in_its_process():
    with pytest.raises(TypeError, match="cannot be pickled"):
        pickle.dumps(Scene(Sphere()).view("normal"))


# Functions


@struct
class Ring:
    radius: float
    thin: float = 0.25

    @func
    def at(self, p: vec3) -> float:
        across = length(vec3(p.x, 0.0, p.z)) - self.radius
        return length(vec3(across, p.y, 0.0)) - self.thin


@func
def of_the_module(p: vec3) -> float:
    return Ring(1.0).at(p)


def test_functions_that_an_import_finds_are_pickled_by_name():
    assert travelled(of_the_module) is of_the_module
    assert travelled(distal.lang.sin) is distal.lang.sin
    assert copy.deepcopy(of_the_module) is of_the_module
    ruby = distal.ruby().call.func
    assert travelled(ruby) is ruby


def test_functions_of_functions_travel_with_what_they_read():
    factor = 0.5
    bent = matte("red")

    @func
    def inner(p: vec3) -> float:
        return Ring(1.0, 0.125).at(p) * factor

    @func
    def outer(p: vec3, more: float = 0.25) -> float:
        return inner(p) + RADIUS - more

    shape = Shape.from_function(outer, more=0.1).paint(bent)
    other = travelled(shape)
    twin = other.arguments["function"]
    assert twin is not outer and other == shape
    places = np.random.default_rng(2).uniform(-1.0, 1.0, (20, 3))
    assert (other(places) == shape(places)).all()
    assert (other(places, params={"radius": 0.9}) == shape(places, params={"radius": 0.9})).all()
    # One that comes twice is one object.
    assert travelled(shape).arguments["function"] is twin


def test_structs_of_functions_travel():
    @struct
    class Slab:
        height: float = 0.5

        @func
        def at(self, p: vec3) -> float:
            return abs(p.y) - self.height

    thin = Slab(0.25)

    @func
    def slabs(p: vec3) -> float:
        return min(Slab().at(p), thin.at(p))

    other = travelled(slabs)
    assert other is not slabs and digest_of(other) == digest_of(slabs)
    assert other(vec3(0.0, 1.0, 0.0)) == slabs(vec3(0.0, 1.0, 0.0)) == 0.5


def test_functions_that_call_each_other_travel():
    @func
    def even(p: vec3) -> float:
        return odd(p)

    @func
    def odd(p: vec3) -> float:
        return even(p)

    other = travelled(even)
    cells = other.overloads[0].python.__globals__
    assert cells["odd"].overloads[0].python.__globals__["even"] is other
    with pytest.raises(CompileError, match="even calls odd calls even"):
        other(vec3(0.0))


def test_images_travel_with_what_they_are():
    @image
    def grey(frame: Frame) -> vec4:
        return vec4(0.25)

    other = travelled(grey)
    assert type(other) is type(grey) and other.render((4, 3)) == grey.render((4, 3))


def test_errors_of_travelled_functions_show_the_authors_line():
    text = "from distal.lang import *\n\n@func\ndef wrong(p: vec3) -> float:\n    return p\n"
    module = {"__name__": "__main__"}
    linecache.cache["<cell 1>"] = (len(text), None, text.splitlines(True), "<cell 1>")
    exec(compile(text, "<cell 1>", "exec"), module)
    data = pickle.dumps(module["wrong"])
    del linecache.cache["<cell 1>"]
    with pytest.raises(CompileError) as caught:
        pickle.loads(data)(vec3(0.0))
    span = caught.value.diagnostics[0].span
    assert (span.file, span.line, span.text) == ("<cell 1>", 5, "    return p")
    assert linecache.getline("<cell 1>", 5) == "    return p\n"


def _missing_file():
    distal.load("no_such_file.py")


@pytest.mark.parametrize(
    "mistake",
    [
        lambda: Sphere(-1.0),
        lambda: Sphere(radious=1.0),
        lambda: bool(slider("Size", 0.5) == 2.0),
        _missing_file,
    ],
)
def test_errors_travel_with_their_text(mistake):
    with pytest.raises(Exception) as caught:
        mistake()
    travelled = pickle.loads(pickle.dumps(caught.value))
    assert type(travelled) is caught.type and str(travelled) == str(caught.value)
    assert getattr(travelled, "hint", None) == getattr(caught.value, "hint", None)


def test_a_value_that_changes_later_does_not_change_what_was_pickled():
    module = {"__name__": "__main__"}
    text = "from distal.lang import *\nK = 1.0\n\n@func\ndef away(x: float) -> float:\n"
    text += "    return x - K\n"
    linecache.cache["<cell 2>"] = (len(text), None, text.splitlines(True), "<cell 2>")
    exec(compile(text, "<cell 2>", "exec"), module)
    data = pickle.dumps(module["away"])
    module["K"] = 3.0
    assert (pickle.loads(data)(5.0), module["away"](5.0)) == (4.0, 2.0)


def test_another_version_of_the_library_refuses(monkeypatch):
    data = [pickle.dumps(value) for value in (Sphere(), glass(), Scene(Sphere()))]
    monkeypatch.setattr(library_stamp, "library_stamp", lambda: "9.9 (other)")
    for each in data:
        with pytest.raises(pickle.UnpicklingError, match="use the same version of distal"):
            pickle.loads(each)


SCRIPT = """
import multiprocessing
from concurrent.futures import ProcessPoolExecutor

import distal
from distal import Shape, Sphere
from distal.lang import func, length, slider, vec3

K = 0.25


def bent(factor):
    @func
    def inner(p: vec3) -> float:
        return (length(p) - K) * factor

    return inner


@func
def outer(p: vec3) -> float:
    return HALF(p) - 0.25


HALF = bent(0.5)


PLACES = [(0.1 * i, 0.2, -0.05 * i) for i in range(20)]


def work(shape):
    return hash(shape), shape(PLACES).tobytes(), shape


if __name__ == "__main__":
    K = 0.125  # another process that runs the file again has another number
    shape = Shape.from_function(outer, bounds=((-2, -2, -2), (2, 2, 2))).paint("red")
    shape = shape | Sphere(slider("Radius", 0.5, 0.1, 1.0)).translate(1, 0, 0)
    loaded = distal.load("model.py", "scene")
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        number, values, back = pool.submit(work, shape).result()
        other = pool.submit(loaded.subject, PLACES).result()
    assert number == hash(shape) and back == shape
    assert values == shape(PLACES).tobytes()
    assert other.tobytes() == loaded.subject(PLACES).tobytes() != values
    print("same")
"""


def test_a_spawned_process_computes_the_same(tmp_path):
    (tmp_path / "script.py").write_text(SCRIPT, encoding="utf-8")
    (tmp_path / "neighbor.py").write_text(
        "from distal.lang import *\nSIZE = 0.75\n\n@func\ndef far(p: vec3) -> float:\n"
        "    return length(p) - SIZE\n",
        encoding="utf-8",
    )
    (tmp_path / "model.py").write_text(
        "import neighbor\nfrom distal import *\nfrom distal.lang import *\n\n"
        "@func\ndef near(p: vec3) -> float:\n    return neighbor.far(p) * 0.5\n\n"
        "scene = Scene(Shape.from_function(near, bounds=((-1, -1, -1), (1, 1, 1))))\n",
        encoding="utf-8",
    )
    source = str(Path(distal.__file__).parents[1])
    paths = os.pathsep.join(filter(None, (source, os.environ.get("PYTHONPATH", ""))))
    done = subprocess.run(
        [sys.executable, "script.py"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": paths},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.stdout.strip() == "same", done.stderr


# Large and random trees


def test_deep_and_large_trees_travel():
    rule = Sphere().translate(1, 0, 0).node
    node = Sphere().node
    for _ in range(5000):
        node = Node(rule.rule, rule.flat, (node,), rule.numbers, rule.constants)
    deep = Shape._of_tree(node, {})
    assert digest_of_node(travelled(deep).node) == digest_of_node(node)
    many = distal.union([Sphere(0.1).translate(i, 0, 0).paint("red") for i in range(300)])
    assert travelled(many) == many and len(pickle.dumps(many)) < 300 * 800


LENGTHS = st.floats(0.1, 3.0, allow_nan=False).map(lambda x: round(x, 3))
COLORS = st.sampled_from(["red", "#123456", (0.1, 0.2, 0.3)])
LEAVES = st.one_of(
    st.builds(Sphere, LENGTHS),
    st.builds(Box, LENGTHS, LENGTHS, LENGTHS),
    st.builds(lambda r: Sphere(slider("Größe", r, 0.05, 4.0)), LENGTHS),
    st.builds(lambda r: Sphere(0.5 * slider("Größe", r, 0.05, 4.0) + time), LENGTHS),
    st.builds(lambda r, h: Circle(r).extrude(h), LENGTHS, LENGTHS),
    st.builds(lambda h: Bolt("M3", 5.0 + h), LENGTHS),
)


def grown(shapes):
    pairs = st.tuples(shapes, shapes)
    return st.one_of(
        pairs.map(lambda p: p[0] | p[1]),
        pairs.map(lambda p: p[0] - p[1]),
        pairs.map(lambda p: p[0] & p[1]),
        pairs.map(lambda p: p[0].union(p[1], smooth=0.1)),
        st.builds(lambda s, x: s.translate(x, 0.5, -x), shapes, LENGTHS),
        st.builds(lambda s, a: s.rotate(y=a), shapes, LENGTHS),
        st.builds(lambda s, c: s.paint(c), shapes, COLORS),
        st.builds(lambda s, i: s.paint(glass(1.0 + i), priority=2), shapes, LENGTHS),
        st.builds(lambda s: s.named("part"), shapes),
        st.builds(lambda s: s.round(0.01), shapes),
    )


@settings(max_examples=40)
@given(st.recursive(LEAVES, grown, max_leaves=6))
def test_random_trees_come_back_from_text_pickle_and_replace(shape):
    assert travelled(shape) == shape == shape.replace()
    assert travelled(shape).replace(name="other") == shape.replace(name="other")
    if "<" not in repr(shape):
        again = evaluated(shape)
        assert again == shape and hash(again) == hash(shape) and repr(again) == repr(shape)
    if shape.children:
        assert shape.replace(children=shape.children) == shape
    moved = shape.translate(1, 0, 0)
    assert moved != shape and moved.children[0] == shape
