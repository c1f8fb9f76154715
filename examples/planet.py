"""A planet cut open, with a ring, and a moon that melts into it.

A first scene: drag a slider, or a number in the code, and watch. Try: look="night", another color,
a second moon.
"""

from distal import Box, Scene, Sphere, Torus, gold, plastic
from distal.lang import slider

melt = slider("Melt", 0.12, low=0.01, high=0.4, help="How far the moon melts.")
turn = slider("Turn", 0.25, low=-3.0, high=3.0, help="Where the planet is cut.")

# A shell and what is in it: "-" cuts away, "|" puts together.
crust = Sphere(1.0) - Sphere(0.84)
moon = Sphere(0.3).translate(-1.0, 0.9, 0.3)
planet = crust.union(moon, smooth=melt).paint(plastic("#2f7f9f"))
mantle = Sphere(0.8) - Sphere(0.52)
core = Sphere(0.48).paint(gold())

wedge = Box(2.0).translate(1.0, 1.0, 1.0).rotate(y=turn)
flat = Torus(1.5, 0.09).scale(1.0, 0.4, 1.0)
ring = flat.rotate(x=0.2, z=-0.35).paint(plastic("#f0d9a8"))

scene = Scene((planet - wedge) | (mantle.paint("#e2683c") - wedge) | core | ring)
