"""What a driver compiles of many parts: drivers write every call out, so copies of functions count.

The distance of a part holds all kinds. Each place where it stands costs the first picture of a page
seconds where a scene has many kinds.
"""

from __future__ import annotations

from collections import Counter

import distal
from distal import Box, Camera, DistantLight, Plane, Scene, Sphere, Torus, union
from distal.backends import get_target
from distal.compiler.driver import run_passes
from distal.frontend import lower
from distal.ir.contents import contents
from distal.ir.nodes import Module
from distal.ir.walk import roots_in


def copies_in(module: Module) -> Counter[str]:
    """How often each function stands in the code of a pixel once all calls are written out."""
    copies = Counter({module.entry: 1})
    for function in reversed(module.functions):
        for root in roots_in(function.body):
            for name in contents(root).called:
                copies[name] += copies[function.name]
    return copies


def page_of(scene: Scene) -> Module:
    image = scene.view("color", steered=True, encoded=True, sampled=True)
    return run_passes(lower(image.emitted()), get_target("glsl-es300"))


def test_the_distance_of_a_part_stands_at_few_places() -> None:
    shapes = (Sphere(0.1), Box(0.1, 0.1, 0.1), Torus(0.1, 0.04))
    parts = [shapes[i % 3].translate(0.3 * i, 0.0, 0.0) for i in range(300)]
    light = DistantLight((1.0, 2.0, 1.5), angle=0.05)
    scene = Scene(union(parts) | Plane(y=-0.4), camera=Camera((3.0, 2.0, 4.0)), lights=light)
    copies = copies_in(page_of(scene))
    # Beginning of a ray, way out of a solid, march, list along a shadow ray, edge of the shadow
    # and its slope, occlusion; normals of the hit and of the outline.
    assert copies["part_distance"] <= 7
    assert copies["part_distance_dual"] <= 2


def test_the_distance_of_a_part_stands_at_few_places_where_values_are_steep() -> None:
    copies = copies_in(page_of(distal.load("example:catalogue")))
    assert copies["part_distance"] <= 11
    assert copies["part_distance_dual"] <= 3
