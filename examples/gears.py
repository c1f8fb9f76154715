"""A gear train that turns: two helical gears, and a pinion that drives a ring and a rack.

The teeth are involutes, so the gears roll on each other at a constant ratio, and touch without
overlapping at every angle. Try: the speed, and the play between the teeth.
"""

import math

from distal import (
    Camera,
    Cylinder,
    Gear,
    HalfSpace,
    Rack,
    RingGear,
    Scene,
    Sky,
    brass,
    glossy,
    mesh_gears,
    time,
)
from distal.lang import slider

speed = slider("Speed", 0.4, low=0.0, high=2.0, help="Radians of the first gear in a second.")
play = slider(
    "Play", 0.1, low=0.0, high=0.3, help="How much thinner the teeth are, in millimetres."
)

turn = speed * time + 0.12
BRASS, STEEL = brass(roughness=0.3), glossy("#5d676f", 0.8, 0.15, 0.3)

# Two helical gears of 20 and 32 teeth; their angles are opposite.
small = Gear(2.0, 20, 12.0, backlash=play, helix=0.35, bore_diameter=14.0)
large = Gear(2.0, 32, 12.0, backlash=play, helix=-0.35, bore_diameter=14.0)
small, large = mesh_gears(small, large, turn)

# A ring around a pinion that is driven from behind, and a rack that slides below a third gear.
ring = mesh_gears(Gear(1.5, 24, 8.0, bore_diameter=8.0), RingGear(1.5, 60, 8.0, rim=5.0), -turn)
rack = mesh_gears(Gear(2.0, 24, 8.0, bore_diameter=10.0), Rack(2.0, 16, 8.0), 0.5 * turn)

shaft = Cylinder(6.9, 26.0).rotate(x=0.5 * math.pi)
train = small.paint(BRASS) | large.paint("#35536e") | shaft.paint(STEEL)
train = train | shaft.translate(52.0, 0.0, 0.0).paint(STEEL)

scene = Scene(
    train.translate(-112.0, 18.0, 0.0).named("train")
    | (ring[0].paint(BRASS) | ring[1].paint("#b4472f")).translate(64.0, 14.0, 0.0)
    | (rack[0].paint(STEEL) | rack[1].paint("#35536e")).translate(-66.0, -60.0, 0.0)
    | HalfSpace((0.0, 0.0, 1.0), -12.0).paint("#d9d2c5"),
    camera=Camera((10.0, -120.0, 250.0), target=(-22.0, -12.0, 0.0), fov_deg=38.0),
    background=Sky(),
    ambient_occlusion=0.3,
    bounces=1,
)
