"""Scenes that other tools show in their documentation, written anew for this library.

The first six follow fogleman/sdf's README, the next two Curv's gallery; a robot, an enclosure and a
castle are what people model first. Input: nothing. Output: shapes. Only public names are used, as
an author would, and no setting of the picture.
"""

from __future__ import annotations

import math
from typing import Final

from distal import (
    Box,
    CappedCone,
    Capsule,
    CapsuleBetween,
    Cone,
    Cylinder,
    Polygon,
    Prism,
    RoundBox,
    RoundCone,
    RoundedCylinder,
    RoundedRectangle,
    Shape,
    Slab,
    Sphere,
    Torus,
    aluminum,
    brass,
    concrete,
    copper,
    gold,
    porcelain,
    rubber,
    steel,
    wood,
)

QUARTER: Final = math.pi / 2.0


def solid_geometry() -> Shape:
    """A ball and a box share a body, pierced along all three axes."""
    bar = Cylinder(0.5, 3.0)
    body = Sphere(1.0) & Box(1.5)
    return body - bar - bar.rotate(x=QUARTER) - bar.rotate(z=QUARTER)


def knurling() -> Shape:
    """A grip with crossed grooves, chamfered ends and a hole."""
    rod = RoundedCylinder(1.0, 4.0, 0.1)
    groove = Box(0.14, 6.0, 0.14).rotate(y=math.pi / 4.0).translate(1.0, 0.0, 0.0).repeat_polar(24)
    band = Slab(2.6)
    rod = rod - (groove.twist(0.75) & band) - (groove.twist(-0.75) & band)
    return rod.translate(y=2.0) - Cylinder(0.5, 1.2).translate(y=4.0)


def gear() -> Shape:
    """A slice of a ball with round notches, and a hub."""
    disc = Sphere(2.0) & Slab(1.0)
    notch = Cylinder(0.25, 3.0).translate(2.0, 0.0, 0.0).repeat_polar(16)
    return disc - Cylinder(1.0, 3.0) - notch


def blobs() -> Shape:
    """Balls of several sizes that melt into each other and into a plate."""
    balls = [
        Sphere(radius).translate(x, y, z)
        for radius, x, y, z in (
            (0.75, 0.0, 0.6, 0.0),
            (0.5, 0.9, 0.4, 0.3),
            (0.45, -0.8, 0.5, 0.4),
            (0.4, 0.1, 1.4, -0.2),
            (0.3, -0.3, 0.5, 0.9),
        )
    ]
    blob = balls[0].union(balls[1:], smooth=0.12)
    return blob.union(RoundBox((3.0, 0.3, 2.4), 0.1), smooth=0.1)


def weave() -> Shape:
    """Nine bands: each goes over and under those that cross it."""
    half = RoundBox((0.7, 0.12, 0.5), 0.05)

    def band(first: float) -> Shape:
        raised = [
            half.translate(0.7 * i, first * (0.12 if i % 2 else -0.12), 0.0) for i in range(-2, 3)
        ]
        return raised[0].union(raised[1:], smooth=0.05)

    along = [band(1.0 if i % 2 else -1.0).translate(z=0.7 * i) for i in range(-2, 3)]
    across = [
        band(-1.0 if i % 2 else 1.0).rotate(y=QUARTER).translate(x=0.7 * i) for i in range(-2, 3)
    ]
    return along[0].union(along[1:]).paint(wood()) | across[0].union(across[1:]).paint("#7a3b1e")


def pawn() -> Shape:
    """A chess piece: a foot of rings, a waist, a collar and a ball."""
    foot = RoundedCylinder(0.8, 0.3, 0.12).translate(y=0.15)
    ring = Torus(0.6, 0.1).translate(y=0.36)
    waist = CappedCone(0.55, 0.22, 1.2).translate(y=0.95)
    collar = RoundedCylinder(0.42, 0.14, 0.06).translate(y=1.6)
    head = Sphere(0.42).translate(y=1.98)
    return foot.union(ring, waist, smooth=0.06).union(collar, smooth=0.04).union(head, smooth=0.03)


def twisted_morph() -> Shape:
    """Half of the way from a cube to a ball, twisted, with a melted ring around it."""
    core = Box(1.6).morph(Sphere(1.0), 0.35).twist(0.9)
    return core.union(Torus(1.25, 0.16).rotate(x=0.35), smooth=0.08)


def shreddered_torus() -> Shape:
    """A ring cut into slices, every other slice moved outwards."""
    ring = Torus(1.2, 0.45)
    slices = Box(0.14, 1.4, 4.0).repeat(0.4, 1.0, 1.0, count=(11, 1, 1))
    rest = Box(0.14, 1.4, 4.0).repeat(0.4, 1.0, 1.0, count=(10, 1, 1)).translate(0.2, 0.0, 0.0)
    return (ring & slices).paint(copper()) | (ring & rest).translate(y=0.18).paint(steel())


def robot() -> Shape:
    """A robot of 33 parts."""
    shell, joint, dark = porcelain(), aluminum(), rubber()
    body = RoundBox((1.0, 1.1, 0.7), 0.15).translate(y=1.75).paint(shell)
    belt = RoundBox((0.8, 0.25, 0.55), 0.1).translate(y=1.1).paint(dark)
    plate = RoundBox((0.55, 0.4, 0.08), 0.03).translate(0.0, 1.9, 0.35).paint(joint)
    lamp = Sphere(0.07).translate(0.15, 1.95, 0.4).paint("tomato")
    neck = Cylinder(0.14, 0.3).translate(y=2.4).paint(joint)
    head = RoundBox((0.75, 0.55, 0.6), 0.15).translate(y=2.75).paint(shell)
    visor = RoundBox((0.6, 0.22, 0.12), 0.05).translate(0.0, 2.8, 0.28).paint(dark)
    eye = Sphere(0.07).translate(0.15, 2.8, 0.33).paint("gold").symmetry("x")
    antenna = CapsuleBetween((0.2, 3.0, 0.0), (0.3, 3.35, 0.0), 0.02).paint(joint)
    tip = Sphere(0.06).translate(0.3, 3.37, 0.0).paint("tomato")
    ear = Cylinder(0.12, 0.1).rotate(z=QUARTER).translate(0.41, 2.75, 0.0).paint(joint)
    shoulder = Sphere(0.22).translate(0.68, 2.1, 0.0).paint(joint)
    upper_arm = CapsuleBetween((0.75, 2.05, 0.0), (0.9, 1.55, 0.05), 0.12).paint(shell)
    elbow = Sphere(0.14).translate(0.9, 1.5, 0.05).paint(joint)
    lower_arm = CapsuleBetween((0.9, 1.45, 0.05), (0.85, 1.0, 0.3), 0.1).paint(shell)
    hand = Sphere(0.14).translate(0.84, 0.92, 0.34).paint(dark)
    hip = Sphere(0.17).translate(0.25, 0.98, 0.0).paint(joint)
    thigh = RoundCone(0.13, 0.16, 0.35).translate(0.25, 0.72, 0.0).paint(shell)
    knee = Cylinder(0.13, 0.28).rotate(z=QUARTER).translate(0.25, 0.5, 0.0).paint(joint)
    shin = Capsule(0.12, 0.3).translate(0.25, 0.28, 0.0).paint(shell)
    foot = RoundBox((0.3, 0.16, 0.5), 0.06).translate(0.25, 0.08, 0.08).paint(dark)
    side = [ear, shoulder, upper_arm, elbow, lower_arm, hand, hip, thigh, knee, shin, foot]
    middle = [belt, plate, lamp, neck, head, visor, eye, antenna, tip]
    return body.union([*middle, side[0].union(side[1:]).symmetry("x")]).named("robot")


def enclosure() -> Shape:
    """A box for electronics: a rounded shell with posts for screws and vents; its lid beside it."""
    size, wall = (2.4, 0.9, 1.6), 0.08
    outside = RoundBox(size, 0.18)
    shell = outside - RoundBox(tuple(s - 2.0 * wall for s in size), 0.12)
    post = Cylinder(0.14, 0.76) - Cylinder(0.06, 1.0)
    posts = post.translate(0.93, 0.0, 0.53).symmetry("xz")
    lower = Box(3.0, 1.0, 3.0).translate(y=-0.2)
    vent = Box(0.05, 0.3, 0.4).repeat(0.14, 1.0, 1.0, count=(7, 1, 1)).translate(0.0, -0.05, 0.8)
    plug = RoundedRectangle((0.5, 0.26), 0.08).extrude(0.6).rotate(y=QUARTER)
    base = ((shell & lower) | (posts & outside & lower)) - vent - plug.translate(-1.2, -0.1, 0.0)
    lid = outside & Box(3.0, 0.12, 3.0).translate(y=0.39)
    holes = Cylinder(0.07, 1.0).translate(0.93, 0.4, 0.53).symmetry("xz")
    lid = (lid | (lid.scale(0.9).translate(y=-0.04))) - holes
    lid = lid.rotate(z=-1.2).translate(2.0, 0.5, 0.0)
    screw = (RoundedCylinder(0.12, 0.08, 0.03) | Cylinder(0.05, 0.4).translate(y=-0.2)) - Box(
        (0.2, 0.06, 0.03)
    ).translate(y=0.04)
    screws = screw.translate(0.93, 0.75, 0.53).symmetry("xz").paint(brass())
    return (base.paint("#31465c") | lid.paint("#e8e2d4") | screws).named("enclosure")


def castle() -> Shape:
    """Four towers with battlements and roofs, walls between them, a gate and a keep."""
    stone, roof = concrete(color="#b9a98c"), concrete(color="#8c3b2a")
    merlon = Box(0.12, 0.16, 0.1)
    tower = Cylinder(0.42, 1.8).translate(y=0.9) | Cylinder(0.5, 0.24).translate(y=1.75)
    tower = tower - Cylinder(0.4, 0.3).translate(y=1.9)
    tower = tower | merlon.translate(0.45, 1.93, 0.0).repeat_polar(9)
    slit = Box(0.05, 0.3, 0.4).translate(0.0, 1.1, 0.4)
    hat = Cone(0.46, 0.7).translate(y=2.3).paint(roof)
    tower = (tower - slit - slit.rotate(y=QUARTER)).paint(stone) | hat
    towers = tower.translate(1.6, 0.0, 1.6).symmetry("xz")
    teeth = merlon.repeat(0.26, 1.0, 1.0, count=(10, 1, 1)).translate(0.0, 1.28, 0.0)
    wall = Box(3.2, 1.2, 0.22).translate(y=0.6) | teeth
    sides = wall.rotate(y=QUARTER).translate(1.6, 0.0, 0.0).symmetry("x")
    back = wall.translate(0.0, 0.0, -1.6)
    arch = Box(0.6, 0.5, 1.2).translate(y=0.25) | Cylinder(0.3, 1.2).rotate(x=QUARTER).translate(
        y=0.5
    )
    gatehouse = Box(1.1, 1.5, 0.5).translate(y=0.75)
    front = ((wall | gatehouse) - arch).translate(0.0, 0.0, 1.6)
    bars = Cylinder(0.02, 0.9).repeat(0.12, 1.0, 1.0, count=(5, 1, 1)).translate(0.0, 0.45, 1.6)
    keep = Prism(0.6, 2.4, count=6).translate(y=1.2) | Cone(0.75, 0.9).translate(y=2.85).paint(roof)
    flag = Polygon([(0.0, 0.0), (0.5, 0.14), (0.0, 0.28)]).extrude(0.03).translate(0.0, 3.5, 0.0)
    pole = Cylinder(0.02, 0.7).translate(y=3.45)
    walls = sides.union(back, front).paint(stone)
    ground = Box(4.6, 0.1, 4.6).translate(y=-0.05).paint("olivedrab")
    decor = bars.paint(steel()) | pole.paint(gold()) | flag.paint("crimson")
    return towers.union(walls, keep.paint(stone), decor, ground).named("castle")


SCENES: Final = {
    made.__name__: made
    for made in (
        solid_geometry,
        knurling,
        gear,
        blobs,
        weave,
        pawn,
        twisted_morph,
        shreddered_torus,
        robot,
        enclosure,
        castle,
    )
}
