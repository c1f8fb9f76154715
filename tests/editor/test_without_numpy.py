"""What a browser's compiler has: the standard library. It must give what NumPy's presence gives."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
from typing import Any

import numpy as np
import pytest

import distal
from distal.diagnostics import LoadError
from distal.export import resources
from distal.export.tables import plain_resource
from distal.ir.types import Buffer as BufferType
from distal.lang import Buffer, vec2, vec4

BLOCKED = """
import sys

class Blocker:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in ("numpy", "llvmlite", "PIL", "wgpu", "typer", "rich"):
            raise ModuleNotFoundError(f"No module named '{name}'", name=name)

sys.meta_path.insert(0, Blocker())
"""
FACTS = """
import hashlib, json, sys
import distal
from distal.export.page_options import PageOptions
from distal.export.payload import payload
from distal.scene.viewing.viewable import viewable

def digest(value):
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()

def facts(name):
    obj = distal.load("example:" + name)
    seen = viewable(obj)
    names = [p.name for p in seen.parameters]
    text = distal.compile(obj).text
    return [seen.animated, round(seen.elevation, 6), names, digest(text)]

def page(name):
    seen = viewable(distal.load("example:" + name))
    made = dict(payload(seen, PageOptions(views=["color"], poster=False)))
    if made["steering"]:  # an arc sine of NumPy can differ from that of Python in the last bit
        elevation = round(made["steering"]["elevation"], 12)
        made["steering"] = {**made["steering"], "elevation": elevation}
    return digest(made)
"""
NEEDS_NUMPY = "import numpy"
ALONE = [n for n, path in distal.gallery().items() if NEEDS_NUMPY not in path.read_text()]
# Of 16 parts and more, a page with NumPy has tables; of 256 and more, a text has.
PAGES = ("raymarcher_objects", "melting", "bunny")
TRACED = ("caustics", "cornell_box", "depth_of_field", "prism", "wine")


def blocked(code: str) -> Any:
    answer = subprocess.run(
        [sys.executable, "-c", BLOCKED + code],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "DISTAL_VERIFY": ""},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert answer.returncode == 0, answer.stderr
    return json.loads(answer.stdout)


def here() -> dict[str, Any]:
    made: dict[str, Any] = {}
    exec(FACTS, made)
    return made


def test_the_gallery_needs_numpy_where_it_works_with_arrays_alone() -> None:
    others = set(distal.gallery()) - set(ALONE)
    by_arrays = {"beach", "bricks", "forest", "lithophane", "molecule", "ripples", "sdfray_glass"}
    assert others == by_arrays


@pytest.mark.sample(3)
@pytest.mark.parametrize("names", [ALONE[i::6] for i in range(6)])
def test_texts_and_facts_of_the_gallery_are_those_with_numpy(names: list[str]) -> None:
    code = f"{FACTS}\nprint(json.dumps({{n: facts(n) for n in {names}}}))"
    found, facts = blocked(code), here()["facts"]
    assert found == {name: facts(name) for name in names}


def test_pages_are_those_with_numpy() -> None:
    names = PAGES + TRACED
    found = blocked(f"{FACTS}\nprint(json.dumps({{n: page(n) for n in {names}}}))")
    page = here()["page"]
    assert found == {name: page(name) for name in names}


@pytest.mark.parametrize(
    "data",
    [
        [1, 2, -3],
        [0.5, 1, 1e-9],
        [vec2(1.0, 2.0), vec2(3.0, 4.5)],
        [(1.0, 2.0, 3.0), (4.0, 5.0, 6.0)],
        [vec4(0.0)],
    ],
)
def test_a_list_of_numbers_is_stored_as_numpy_stores_it(data: list[Any]) -> None:
    source = Buffer(data)
    type = BufferType(source.element)
    assert plain_resource(source, type) == resources.resource(source, type)


@pytest.mark.parametrize("data", [[2**40], [np.float32(1.0)], np.ones(3), [[]]])
def test_what_is_no_list_of_plain_numbers_is_left_to_numpy(data: Any) -> None:
    try:
        source = Buffer(data)
    except (TypeError, ValueError):
        return
    made = plain_resource(source, BufferType(source.element))
    try:
        known = resources.resource(source, BufferType(source.element))
    except LoadError:
        known = None
    assert made in (None, known)


def test_a_lone_shape_has_its_stage_and_its_box() -> None:
    code = """
import json
from distal import Circle, Sphere, time
from distal.lang import slider
from distal.scene.viewing.viewable import viewable
radius = slider("Radius", 0.5, low=0.1, high=3.0)
flat = viewable(Circle(radius).translate(1.0, 0.0), {"Radius": 2.0})
low, high = Sphere(0.5 + 0.25 * time).bounds(time=2.0)
print(json.dumps([flat.elevation, list(flat.views[:1]), low, high, (2.0 * radius).value()]))
"""
    elevation, views, low, high, value = blocked(code)
    assert 0.0 <= elevation < 1.0 and views == ["color"]
    assert (low, high, value) == ([-1.0, -1.0, -1.0], [1.0, 1.0, 1.0], 1.0)


def test_every_public_name_can_be_imported_and_reports_its_package_when_used() -> None:
    code = """
import json
from distal import *
from distal.packages import PackageError
try:
    points_on(Sphere(1.0), 10)
except PackageError as error:
    print(json.dumps([Sphere(1.0).name, str(error)]))
"""
    assert blocked(code) == ["Sphere", "numpy is missing: pip install numpy"]


@pytest.mark.parametrize(
    "ask",
    ["Sphere(1.0)((1.0, 0.0, 0.0))", "points_in(Sphere(1.0), 10)", "Picture.of"],
)
def test_what_needs_arrays_says_so(ask: str) -> None:
    code = f"""
import json
from distal import *
try:
    {ask}
except ImportError as error:
    print(json.dumps(str(error)))
"""
    assert " is missing: pip install" in blocked(code)


def test_digests_differ_where_texts_do() -> None:
    made = here()
    assert made["digest"]("a") != made["digest"]("b")
    assert made["digest"]("a") == hashlib.sha256(b'"a"').hexdigest()
