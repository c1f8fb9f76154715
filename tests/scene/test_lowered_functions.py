"""The functions that a scene is lowered to: none twice, and exact choices between materials."""

import numpy as np
import pytest

from distal import Box, Plane, Scene, Sphere, Torus
from distal.frontend import lower
from distal.ir.nodes import Function
from distal.ir.walk import names_read


def functions(scene: Scene) -> tuple[Function, ...]:
    return lower(scene.emitted()).functions


@pytest.mark.parametrize(
    "shape",
    [
        Sphere(1.0) | Box(1.0).translate(2, 0, 0),
        Sphere(1.0) | Plane(-0.5) | Torus(1.0, 0.2),
        Sphere(1.0).union(Box(1.0), smooth=0.2) | Plane(-0.5),
    ],
)
def test_no_distance_is_defined_twice(shape) -> None:
    found = [f for f in functions(Scene(shape)) if f.source_name.endswith("distance")]
    assert found
    assert len({(f.source_name, f.params, f.result, f.body) for f in found}) == len(found)


def test_a_part_is_united_with_those_before_it_at_once() -> None:
    """So only one distance is alive at a time, however many parts there are."""
    parts = [Sphere(1.0), Box(1.0), Torus(1.0, 0.2), Sphere(0.5).rotate(x=1.0)]
    shape = parts[0] | parts[1] | parts[2] | parts[3]
    (union,) = (f for f in functions(Scene(shape, floor=False)) if f.name == "union_distance")
    waiting: set[str] = set()
    most = 0
    for stmt in union.body[:-1]:
        waiting -= names_read((stmt,))
        waiting.add(stmt.name)
        most = max(most, len(waiting))
    assert most <= 3


def test_a_hard_union_shows_the_materials_of_its_parts_exactly() -> None:
    red, blue = (0.9, 0.7, 0.8), (0.001, 1 / 300, 1 / 30)
    shape = Sphere(1.0).paint(red).translate(-0.8, 0, 0) | Sphere(1.0).paint(blue).translate(
        0.8, 0, 0
    )
    picture = Scene(shape, floor=False).render((32, 24), samples=1, layers=("albedo",))
    colors = {tuple(c) for c in picture.layers["albedo"].reshape(-1, 3)}
    assert {tuple(np.float32(red)), tuple(np.float32(blue))} <= colors
